#pragma once
// Above which height there is nothing but air, in squares of a few voxels.
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "removal/field/slot_map.h"
#include "removal/field/upright/column_cover.h"

namespace camber::removal::upright {

/// Heights over the tiles of a SlotMap, in voxels from its first. Material goes only, so what was read some stamps ago
/// still bounds what is there.
class TopMap {
 public:
  static constexpr int kCellBits = 2, kCell = 1 << kCellBits;  ///< voxels a side of a square
  static constexpr int kOfTile = Tile::kCore / kCell;          ///< squares a side of a tile

  /// As if everything were material.
  void reset(const SlotMap& slots);
  /// `cover_of`: of a tile by its place in the map, null where there is none. A square knows the heights `reach_voxels`
  /// around it as well.
  void read(const SlotMap& slots, int reach_voxels,
            const std::function<const ColumnCover*(std::size_t place)>& cover_of);

  /// Reads the tiles of one column, i and j counted from the map's first. `covers`: of those from the top down, null
  /// for air; those below the last one are not known, and count as material.
  void read_column(const SlotMap& slots, int reach_voxels, int i, int j, std::span<const ColumnCover* const> covers);

  /// [squares along x][squares along y]: the first voxel from which on all above and around is air; 0 or less: all.
  /// Empty over no tiles.
  const std::vector<std::int32_t>& heights() const { return around_; }

 private:
  std::vector<std::int32_t> own_, across_, around_;
};

}  // namespace camber::removal::upright
