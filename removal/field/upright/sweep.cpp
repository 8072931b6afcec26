// Carving with the undeflected cutter, without engagement.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/cancel.h"
#include "base/stage.h"
#include "removal/engage/tilted/deflected_path.h"
#include "removal/engagement.h"
#include "removal/field/slot_map.h"
#include "removal/field/tile.h"
#include "removal/field/upright/batch_cut.h"
#include "removal/field/upright/carve.h"
#include "removal/field/upright/stamp_order.h"
#include "removal/field/upright/tiles_reached.h"

namespace camber::removal {

using namespace upright;

namespace {

struct WorkTile {
  Index3 index{};
  std::vector<std::int32_t> stamps;
  std::unique_ptr<Tile> result;  ///< null: nothing changed
  double removed_mm3 = 0;
};

/// Stamps from ... from + stamps.size() - 1 of a path.
class Sweep {
 public:
  Sweep(Stock& stock, const CutterShape& shape, std::span<const Stamp> all, std::size_t from, std::size_t count,
        const SweepOptions& options)
      : stock_(stock),
        shape_(shape),
        all_(all),
        stamps_(all.subspan(from, count)),
        first_id_(options.first_id + static_cast<std::int32_t>(from)),
        options_(options) {}

  /// Returns the volume that the stamps took, mm^3.
  double cut();

 private:
  void find_tiles();
  void list_stamps();
  void work(WorkTile& tile) const;
  bool cut_general(Tile& tile, ColumnCover& cover, const WorkTile& w) const;

  Stock& stock_;
  const CutterShape& shape_;
  std::span<const Stamp> all_, stamps_;
  std::int32_t first_id_;  ///< id of stamps_[0]
  const SweepOptions& options_;
  std::vector<WorkTile> tiles_;
  SlotMap slots_;
};

void Sweep::find_tiles() {
  const double tile_mm = Tile::kCore * stock_.voxel_mm();
  const double reach = stock_.band_mm() + shape_.radius_mm;
  Vec3 lo = stamps_.front().pose.tip_mm, hi = lo;
  for (const auto& s : stamps_) {
    lo = lo.cwiseMin(s.pose.tip_mm);
    hi = hi.cwiseMax(s.pose.tip_mm);
  }
  lo.head<2>().array() -= reach;
  hi.head<2>().array() += reach;
  lo.z() -= stock_.band_mm() + 1e-6;
  hi.z() = stock_.max_mm().z() + stock_.band_mm();
  const Vec3 band = Vec3::Constant(stock_.band_mm());
  lo = lo.cwiseMax(stock_.min_mm() - band);
  hi = hi.cwiseMin(stock_.max_mm() + band);
  slots_.reset(tile_of(lo, tile_mm), tile_of(hi, tile_mm));
}

void Sweep::list_stamps() {
  find_tiles();
  constexpr std::int32_t kAir = -2;
  std::vector<std::vector<std::size_t>> reached(stamps_.size());  // places of tiles
  tbb::parallel_for(std::size_t{0}, stamps_.size(), [&](std::size_t k) {
    for_each_tile_reached(slots_, stock_.voxel_mm(), shape_, stamps_[k].pose.tip_mm, stock_.band_mm(),
                          [&](std::size_t place) { reached[k].push_back(place); });
  });
  for (std::size_t k = 0; k < stamps_.size(); ++k)
    for (const std::size_t place : reached[k]) {
      std::int32_t& slot = slots_.all()[place];
      if (slot == SlotMap::kNone) {
        const Index3 tile = slots_.tile_at(place);
        slot = stock_.is_air(tile) ? kAir : static_cast<std::int32_t>(tiles_.size());
        if (slot != kAir) tiles_.emplace_back().index = tile;
      }
      if (slot != kAir) tiles_[static_cast<std::size_t>(slot)].stamps.push_back(static_cast<std::int32_t>(k));
    }
}

void Sweep::work(WorkTile& w) const {
  cancellation_point();
  auto tile_copy = std::make_unique<Tile>();
  Tile& tile = *tile_copy;
  stock_.load(w.index, tile);
  const double material = material_voxels(tile, stock_.voxel_mm());
  ColumnCover cover(tile, w.index, stock_.voxel_mm(), stock_.band_mm(), shape_, tips_by_id(all_, options_.first_id, 0),
                    options_.shrink_mm);
  if (cover.all_air()) return;
  const bool changed = shape_.general ? cut_general(tile, cover, w)
                                      : BatchCut(shape_, stock_.voxel_mm(), stock_.band_mm(), options_.shrink_mm)
                                            .cut(tile, cover, stamps_, w.stamps, first_id_);
  if (!changed) return;
  w.removed_mm3 = (material - material_voxels(tile, stock_.voxel_mm())) * std::pow(stock_.voxel_mm(), 3);
  w.result = std::move(tile_copy);
}

bool Sweep::cut_general(Tile& tile, ColumnCover& cover, const WorkTile& w) const {
  const auto tip = [&](std::int32_t i) -> const Vec3& {
    return stamps_[static_cast<std::size_t>(w.stamps[static_cast<std::size_t>(i)])].pose.tip_mm;
  };
  const auto covers = [&](std::int32_t last, std::int32_t i) {
    return last >= 0 && !cover.changeable_after(tip(last), 0, tip(i), 0);
  };
  bool changed = false;
  for_each_coarse_to_fine(
      static_cast<std::int32_t>(w.stamps.size()), [&](std::int32_t i, std::int32_t left, std::int32_t right) {
        if (covers(left, i) || covers(right, i)) return;
        const CarveStamp stamp{tip(i), first_id_ + w.stamps[static_cast<std::size_t>(i)], options_.shrink_mm};
        changed |= carve(tile, cover, w.index, stock_.voxel_mm(), stock_.band_mm(), shape_, stamp);
      });
  return changed;
}

double Sweep::cut() {
  if (stamps_.empty()) return 0;
  list_stamps();
  tbb::parallel_for(std::size_t{0}, tiles_.size(), [&](std::size_t i) { work(tiles_[i]); });
  double removed = 0;
  std::vector<Stock::StoredTile> changed;
  for (const auto& w : tiles_) {
    if (w.result) changed.push_back({w.index, w.result.get()});
    removed += w.removed_mm3;
  }
  stock_.store(changed);
  return removed;
}

}  // namespace

double sweep(Stock& stock, const CutterShape& shape, std::span<const Stamp> stamps, const SweepOptions& options) {
  if (!all_upright(stamps)) return tilted::sweep(stock, shape, stamps, options);
  constexpr std::size_t kAtOnce = 10000;  // bounds the memory
  double removed = 0;
  for (std::size_t from = 0; from < stamps.size(); from += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, stamps.size() - from);
    removed += Sweep(stock, shape, stamps, from, count, options).cut();
    if (options.stage) options.stage->advance(count);
  }
  return removed;
}

}  // namespace camber::removal
