#pragma once
// Working copies of the tiles around a cutter that goes on stamp by stamp, where the stamps to come are not known.
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "removal/cutter.h"
#include "removal/field/upright/tile_arena.h"
#include "removal/stock.h"

namespace camber::removal::upright {

/// Tiles of a box that is known beforehand. They come when the first stamp is near them, and stay until the room is
/// needed: a tile that a stamp leaves is soon met again by the next row.
class StepArena : public TileArena {
 public:
  /// For tips within a box. Room for all tiles is set aside at once, so that none moves later; memory is used as they
  /// come.
  StepArena(const Stock& stock, const CutterShape& shape, const Vec3& min_tip_mm, const Vec3& max_tip_mm);

  /// Lists the tiles that a stamp comes near and that are not air. Those of fresh() were loaded for it. Valid until the
  /// next call.
  std::span<const std::int32_t> reach(const Stock& stock, const Stock& blank, const CutterShape& shape,
                                      const Vec3& tip_mm);
  /// The tile that no stamp has come near for longest, where more are there than this.
  enum class Keep {
    some,  ///< as many as are worth keeping
    more,  ///< so many that no time need be lost on giving up tiles
    most   ///< as many as there is room for
  };
  std::optional<std::size_t> to_give_up(Keep keep) const;
  /// `is_air`: nothing will ever be there again.
  void give_up(std::size_t tile, bool is_air);
  /// Loads tiles around a place where the cutter may soon be, in `most` steps of about a tenth of a millisecond: a
  /// tile, or some of its blank's edges. Those of fresh() were loaded.
  void approach(const Stock& stock, const Stock& blank, const CutterShape& shape, const Vec3& tip_mm, int most);
  /// Reads how high the stock is in one column of tiles, the one that was cut and not read for longest. `reach_voxels`:
  /// see TopMap; `cover_of`: of a tile that is there.
  void read_a_top(int reach_voxels, const std::function<const ColumnCover&(std::size_t tile)>& cover_of);
  /// A tile was cut: its column is to be read.
  void lowered(std::size_t tile);
  /// Tiles that are there; numbers are below size().
  bool has(std::size_t tile) const { return tile > 0 && used_[tile] != 0; }

 private:
  void load(std::size_t place, const Stock& stock, const Stock& blank);
  bool find_some_edges(const Stock& blank);
  void find_all_edges(std::size_t tile, const Stock& blank);
  std::size_t column_of(std::size_t place) const { return place / static_cast<std::size_t>(slots_.extent()[2]); }

  std::vector<char> air_;  ///< by place
  std::vector<std::int32_t> tiles_of_stamp_;
  std::vector<std::uint64_t> last_near_;  ///< number of the stamp, by tile
  std::deque<std::size_t> lowered_;       ///< columns of places, to be read
  std::vector<char> is_lowered_;          ///< by column
  std::vector<const ColumnCover*> covers_;
  std::vector<int> layers_found_;       ///< layers of the blank's edges, by tile
  std::deque<std::size_t> unfinished_;  ///< tiles, in the order in which they came
  std::uint64_t stamps_ = 0;
  std::size_t there_ = 0, most_near_ = 0, near_bound_ = 0;  ///< tiles; near one stamp, until now and at most
};

}  // namespace camber::removal::upright
