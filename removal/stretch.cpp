#include "removal/stretch.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "removal/batch_cut.h"
#include "removal/carve.h"
#include "removal/engager.h"
#include "removal/slot_map.h"
#include "removal/stamp_order.h"
#include "removal/tiles_reached.h"

namespace camber::removal {
namespace {

struct WorkTile {
  Index3 index{};
  std::vector<std::int32_t> stamps;
  std::unique_ptr<Tile> result;  ///< null: nothing changed
  double removed_mm3 = 0;
};

}  // namespace

struct Stretch::Impl {
  Stock& stock;
  const Stock* blank;
  const EnvelopeGrid& envelope;
  std::span<const Stamp> all_stamps;
  std::span<const Stamp> stamps;  ///< of this stretch
  std::int32_t first_id;          ///< of stamps[0]
  StretchOptions options;
  double tile_mm;
  std::vector<WorkTile> tiles;
  SlotMap slots;
  std::unique_ptr<Engager> engager{};  ///< of undeflected stamps

  void find_tiles();
  void list_stamps();
  void work(WorkTile& tile) const;
  Engagement engage();
};

void Stretch::Impl::find_tiles() {
  if (stamps.empty()) return;
  const double reach = stock.band_mm() + envelope.shape.radius_mm;
  Vec3 lo = stamps.front().tip_mm, hi = lo;
  for (const auto& s : stamps) {
    lo = lo.cwiseMin(s.tip_mm);
    hi = hi.cwiseMax(s.tip_mm);
  }
  lo.head<2>().array() -= reach;
  hi.head<2>().array() += reach;
  lo.z() -= stock.band_mm() + 1e-6;
  hi.z() = stock.max_mm().z() + stock.band_mm();
  const Vec3 band = Vec3::Constant(stock.band_mm());
  lo = lo.cwiseMax(stock.min_mm() - band);
  hi = hi.cwiseMin(stock.max_mm() + band);
  slots.reset(tile_of(lo, tile_mm), tile_of(hi, tile_mm));
}

void Stretch::Impl::list_stamps() {
  tiles.clear();
  find_tiles();
  constexpr std::int32_t kAir = -2;
  std::vector<std::vector<std::size_t>> reached(stamps.size());  // places of tiles
  tbb::parallel_for(std::size_t{0}, stamps.size(), [&](std::size_t k) {
    for_each_tile_reached(slots, stock.voxel_mm(), envelope.shape, stamps[k].tip_mm, stock.band_mm(),
                          [&](std::size_t place) { reached[k].push_back(place); });
  });
  for (std::size_t k = 0; k < stamps.size(); ++k)
    for (const std::size_t place : reached[k]) {
      std::int32_t& slot = slots.all()[place];
      if (slot == SlotMap::kNone) {
        const Index3 tile = slots.tile_at(place);
        slot = stock.is_air(tile) ? kAir : static_cast<std::int32_t>(tiles.size());
        if (slot != kAir) tiles.emplace_back().index = tile;
      }
      if (slot != kAir) tiles[static_cast<std::size_t>(slot)].stamps.push_back(static_cast<std::int32_t>(k));
    }
}

void Stretch::Impl::work(WorkTile& w) const {
  auto tile_copy = std::make_unique<Tile>();
  Tile& tile = *tile_copy;
  stock.load(w.index, tile);
  const double material = material_voxels(tile, stock.voxel_mm());
  bool changed = false;
  ColumnCover cover(tile, w.index, stock.voxel_mm(), stock.band_mm(), envelope.shape,
                    [&](std::int32_t id, Vec3& tip_mm, double& bend_mm) {
                      if (id < options.first_id) return false;
                      tip_mm = all_stamps[static_cast<std::size_t>(id - options.first_id)].tip_mm;
                      bend_mm = 0;
                      return true;
                    });
  if (cover.all_air()) return;
  if (!envelope.shape.general) {
    BatchCut batch_cut(envelope.shape, stock.voxel_mm(), stock.band_mm(), options.shrink_mm);
    changed = batch_cut.cut(tile, cover, stamps, w.stamps, first_id);
  } else {
    const auto tip = [&](std::int32_t i) -> const Vec3& {
      return stamps[static_cast<std::size_t>(w.stamps[static_cast<std::size_t>(i)])].tip_mm;
    };
    const auto covers = [&](std::int32_t last, std::int32_t i) {
      return last >= 0 && !cover.changeable_after(tip(last), 0, tip(i), 0);
    };
    for_each_coarse_to_fine(
        static_cast<std::int32_t>(w.stamps.size()), [&](std::int32_t i, std::int32_t left, std::int32_t right) {
          if (covers(left, i) || covers(right, i)) return;
          const CarveStamp stamp{tip(i), first_id + w.stamps[static_cast<std::size_t>(i)], options.shrink_mm};
          changed |= removal::carve(tile, cover, w.index, stock.voxel_mm(), stock.band_mm(), envelope.shape, stamp);
        });
  }
  if (!changed) return;
  w.removed_mm3 = (material - material_voxels(tile, stock.voxel_mm())) * std::pow(stock.voxel_mm(), 3);
  w.result = std::move(tile_copy);
}

/// Undeflected, and all chips kept.
Engagement Stretch::Impl::engage() {
  engager = std::make_unique<Engager>(stock, *blank, envelope, all_stamps, options.first_id);
  std::vector<std::vector<Chip>> by_stamp(stamps.size());
  engager->engage(
      static_cast<std::size_t>(stamps.data() - all_stamps.data()), stamps.size(),
      [&](std::size_t k, std::span<const ChipBlock> chips) { by_stamp[k] = chips_of(engager->blocks(), chips); });
  Engagement out;
  out.first.push_back(0);
  for (const auto& chips : by_stamp) {
    out.chips.insert(out.chips.end(), chips.begin(), chips.end());
    out.first.push_back(out.chips.size());
  }
  return out;
}

Stretch::Stretch(Stock& stock, const Stock* blank, const EnvelopeGrid& envelope, std::span<const Stamp> stamps,
                 std::size_t from, std::size_t count, const StretchOptions& options)
    : impl_(std::make_unique<Impl>(Impl{stock,
                                        blank,
                                        envelope,
                                        stamps,
                                        stamps.subspan(from, count),
                                        options.first_id + static_cast<std::int32_t>(from),
                                        options,
                                        Tile::kCore * stock.voxel_mm(),
                                        {},
                                        {}})) {}
Stretch::~Stretch() = default;

Engagement Stretch::carve() {
  impl_->engager.reset();
  if (impl_->options.engage) return impl_->engage();
  impl_->list_stamps();
  auto& tiles = impl_->tiles;
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) { impl_->work(tiles[i]); });
  return {};
}

double Stretch::commit() {
  Impl& m = *impl_;
  if (m.engager) return m.engager->commit();
  double removed = 0;
  std::vector<Stock::StoredTile> changed;
  for (const auto& w : m.tiles) {
    if (w.result) changed.push_back({w.index, w.result.get()});
    removed += w.removed_mm3;
  }
  m.stock.store(changed);
  m.tiles.clear();
  return removed;
}

}  // namespace camber::removal
