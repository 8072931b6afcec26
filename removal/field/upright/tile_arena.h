#pragma once
// Working copies of all tiles that a stretch of stamps reaches. Rows overlap, so most tiles of a stretch
// are those of the one before: they stay.
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/field/blank_edges.h"
#include "removal/field/slot_map.h"
#include "removal/field/tile.h"
#include "removal/field/upright/column_cover.h"
#include "removal/simd/upright_block_kernels.h"
#include "removal/stock.h"
#include "removal/tool_path.h"

namespace camber::removal::upright {

/// Heights over the tiles of a SlotMap, in voxels from its first. Material goes only, so what was read some stamps ago
/// still bounds what is there.
class TopMap {
 public:
  static constexpr int kCellBits = 2, kCell = 1 << kCellBits;  ///< voxels a side of a square
  static constexpr int kOfTile = Tile::kCore / kCell;          ///< squares a side of a tile

  /// Starts anew, as if everything were material.
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

class TileArena {
 public:
  /// Called with the numbers of tiles before they are given up.
  using Leave = std::function<void(std::span<const std::size_t> tiles)>;

  /// Loads what is not air and not there yet, and gives up what these stamps do not reach. Tile 0 is air all over and
  /// stands for all others. `blank`: the stock before the first stamp; null where no
  /// chips are read. deflection_mm: how far cutters may lean.
  void load(const Stock& stock, const Stock* blank, const CutterShape& shape, std::span<const Stamp> stamps,
            const Leave& leave, double deflection_mm = 0);
  /// Gives up all tiles.
  void clear(const Leave& leave);

  std::size_t size() const { return used_.size(); }              ///< numbers are below it; 0 is the air
  std::span<const std::size_t> fresh() const { return fresh_; }  ///< tiles that the last load() loaded
  const Index3& index(std::size_t tile) const { return index_[tile]; }
  Tile& operator[](std::size_t tile) { return tiles_[tile]; }
  /// Distances of the blank there; null where the blank is solid.
  const float* blank(std::size_t tile) const {
    return in_solid_[tile] != 0 ? nullptr : blanks_.get() + tile * Tile::kVolume;
  }
  bool has_edge(std::int32_t cell) const {
    return !edges_[static_cast<std::size_t>(cell / (2 * Tile::kVolume))].faces(cell % (2 * Tile::kVolume)).empty();
  }
  /// The blank at a point of a cell of that tile, which is not solid.
  BlankCell blank_at(std::int32_t cell, const CellShare& share) const {
    const auto tile = static_cast<std::size_t>(cell / (2 * Tile::kVolume));
    const int in_tile = cell % (2 * Tile::kVolume);
    return {blanks_.get() + tile * Tile::kVolume + in_tile, edges_[tile].faces(in_tile), share, voxel_};
  }
  /// Blanks of all tiles, Tile::kVolume each; only what blank() points to counts.
  const float* blanks() const { return blanks_.get(); }
  /// The number of the tile at an index, 0 (or less) where it is air or out of reach.
  std::int32_t find(int i, int j, int k) const { return slots_.find(i, j, k); }
  /// The tiles of stamps[k] that are not air.
  std::span<const std::int32_t> reached_by(std::size_t k) const { return reached_[k]; }

  /// Reads how high the stock is: `cover_of` a tile's number. `reach_voxels`: see TopMap.
  void read_tops(int reach_voxels, const std::function<const ColumnCover&(std::size_t tile)>& cover_of);

  ArenaView view() const;
  /// Returns the place of a stamp that moves at most by its feed; see StampPlace::min_forward_mm.
  StampPlace place_of(const Stamp& stamp, double min_forward_mm) const;

 protected:
  std::size_t take_number(const Index3& index);
  void make_room(std::size_t tiles);
  /// Reads the tile and its blank from the stocks, with the blank's edges.
  void read_tile(std::size_t tile, const Stock& stock, const Stock* blank);
  /// As read_tile(), without edges: find_edges() has to follow. Returns false where the blank has none.
  bool read_fields(std::size_t tile, const Stock& stock, const Stock* blank);
  /// Finds the blank's edges in one layer of the tile's cells; layers must be given in order.
  void find_edges(std::size_t tile, int layer, const Stock& blank);
  /// Copies the tile's upper layer from the neighbours in the arena, except those that `is_read` names as unchanged.
  template <class IsRead>
  void share_upper_layer(std::size_t tile, IsRead is_read);

  double voxel_ = 0;
  SlotMap slots_, before_;  ///< maps of this stretch and of the last one
  TopMap tops_;
  std::vector<std::vector<std::int32_t>> reached_;
  std::size_t room_ = 0;
  // By number:
  std::vector<char> used_, in_solid_;
  std::vector<Index3> index_;
  std::unique_ptr<Tile[]> tiles_;    ///< not cleared
  std::unique_ptr<float[]> blanks_;  ///< not cleared
  std::vector<BlankEdges> edges_;    ///< edges of the blanks
  std::vector<std::size_t> fresh_, free_;

 private:
  void list_tiles(const Stock& stock, const CutterShape& shape, std::span<const Stamp> stamps, const Leave& leave,
                  double deflection_mm);
  void reset_slots(const Stock& stock, const CutterShape& shape, std::span<const Stamp> stamps, double reach_mm);
  void load_fresh(const Stock& stock, const Stock* blank);
  static void copy_shared(const Tile& from, const std::array<int, 3>& up, Tile& to);
};

template <class IsRead>
void TileArena::share_upper_layer(std::size_t tile, IsRead is_read) {
  const Index3& at = index_[tile];
  for (int c = 1; c < 8; ++c) {
    const std::array<int, 3> up{c & 1, c >> 1 & 1, c >> 2};
    const std::int32_t other = slots_.find(at[0] + up[0], at[1] + up[1], at[2] + up[2]);
    if (other > 0 && !is_read(static_cast<std::size_t>(other)))
      copy_shared(tiles_[static_cast<std::size_t>(other)], up, tiles_[tile]);
  }
}

}  // namespace camber::removal::upright
