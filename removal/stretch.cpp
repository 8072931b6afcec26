#include "removal/stretch.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "removal/batch_cut.h"
#include "removal/carve.h"
#include "removal/chip_reader.h"
#include "removal/engager.h"
#include "removal/patch_lanes.h"
#include "removal/slot_map.h"
#include "removal/stamp_order.h"
#include "removal/tiles_reached.h"

namespace camber::removal {
namespace {

/// A patch of the envelope that may have points in a tile that cut.
struct Touch {
  std::int32_t stamp;
  std::uint32_t patch;
};

struct WorkTile {
  Index3 index{};
  std::vector<std::int32_t> stamps;
  std::vector<Touch> touches;
  std::vector<StampChip> chips;
  std::unique_ptr<Tile> result;  ///< null: nothing changed
  double removed_mm3 = 0;
};

/// What one thread holds of a tile.
struct WorkBuffers {
  std::unique_ptr<Tile> stock = std::make_unique<Tile>();
  Tile blank;
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
  StampOrder order;                    ///< batches and who covers whom
  std::vector<CarveBend> bends;        ///< per stamp of the stretch; empty: straight
  std::optional<PatchLanes> lanes;     ///< made by the first carve
  std::unique_ptr<Engager> engager{};  ///< of undeflected stamps

  void find_tiles(const ShiftTable* shifts);
  void list_stamps(const ShiftTable* shifts);
  void touches_of_stamp(std::int32_t k, const ShiftTable* shifts,
                        std::vector<std::pair<std::int32_t, std::uint32_t>>& out);
  void cut_tiles(const ShiftTable* shifts);
  void work(WorkTile& tile, const ShiftTable* shifts, const ChipReader* reader) const;
  Engagement gather();
  Engagement engage();
};

void Stretch::Impl::find_tiles(const ShiftTable* shifts) {
  if (stamps.empty()) return;
  const double reach = stock.band_mm() + (shifts ? 0.5 : 0.0) + envelope.shape.radius_mm;
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

void Stretch::Impl::list_stamps(const ShiftTable* shifts) {
  tiles.clear();
  order = !options.engage ? StampOrder::one_batch(stamps.size()) : StampOrder::one_by_one(stamps.size());
  find_tiles(shifts);
  bends.assign(shifts ? stamps.size() : 0, {});
  if (shifts) {
    const Bends all(envelope, *shifts);
    tbb::parallel_for(std::size_t{0}, bends.size(),
                      [&](std::size_t k) { bends[k] = all.of(static_cast<std::ptrdiff_t>(k)); });
  }
  constexpr std::int32_t kAir = -2;
  std::vector<std::vector<std::size_t>> reached(stamps.size());  // places of tiles
  tbb::parallel_for(std::size_t{0}, stamps.size(), [&](std::size_t k) {
    const double reach = stock.band_mm() + (shifts ? bends[k].largest_mm : 0.0);
    for_each_tile_reached(slots, stock.voxel_mm(), envelope.shape, stamps[k].tip_mm, reach,
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

void Stretch::Impl::touches_of_stamp(std::int32_t k, const ShiftTable* shifts,
                                     std::vector<std::pair<std::int32_t, std::uint32_t>>& out) {
  const Stamp& stamp = stamps[static_cast<std::size_t>(k)];
  const Stock::Probe probe(stock);
  const double moved = shifts ? bends[static_cast<std::size_t>(k)].largest_mm : 0.0;
  const double before = !shifts ? 0.0
                        : k > 0 ? bends[static_cast<std::size_t>(k) - 1].largest_mm
                                : shifts->largest_mm(-1);
  const double slewed = moved + before;
  const double feed = stamp.feed_per_tooth_mm.norm();
  // What curvature, a change of shift and the bent envelope's tilt add to the chip at most.
  const double bulge =
      feed * feed / (2 * std::max(envelope.shape.corner_radius_mm, 0.1)) + slewed + (shifts ? kMostTilt * feed : 0.0);
  std::vector<float> into(envelope.patches.size());
  lanes->motion_into(stamp.feed_per_tooth_mm, into);
  const auto least = static_cast<float>(-bulge - 1e-6);
  for (std::size_t i = 0; i < envelope.patches.size(); ++i) {
    if (into[i] <= least) continue;
    const auto& patch = envelope.patches[i];
    const double extent = patch.radius_mm + moved;
    const double reach = std::min(extent + 0.87 * stock.voxel_mm(), 0.999 * stock.band_mm());
    const Vec3 centre = stamp.tip_mm + patch.centre_from_tip;
    if (centre.z() - reach > stock.max_mm().z() || probe.nearest(centre) > reach) continue;
    const Vec3 margin = Vec3::Constant(extent + 1e-3 * stock.voxel_mm());
    const Index3 lo = tile_of(centre - margin, tile_mm), hi = tile_of(centre + margin, tile_mm);
    for (int a = lo[0]; a <= hi[0]; ++a)
      for (int b = lo[1]; b <= hi[1]; ++b)
        for (int c = lo[2]; c <= hi[2]; ++c)
          if (const std::int32_t slot = slots.find(a, b, c); slot >= 0)
            out.emplace_back(slot, static_cast<std::uint32_t>(i));
  }
}

void Stretch::Impl::cut_tiles(const ShiftTable* shifts) {
  if (options.engage && !lanes) lanes.emplace(envelope, shifts ? shifts->node_height_mm : std::vector<double>{});
  std::vector<std::vector<std::pair<std::int32_t, std::uint32_t>>> by_stamp(options.engage ? stamps.size() : 0);
  tbb::parallel_for(std::size_t{0}, by_stamp.size(),
                    [&](std::size_t k) { touches_of_stamp(static_cast<std::int32_t>(k), shifts, by_stamp[k]); });
  for (std::size_t k = 0; k < by_stamp.size(); ++k)
    for (const auto& [slot, patch] : by_stamp[k])
      tiles[static_cast<std::size_t>(slot)].touches.push_back({static_cast<std::int32_t>(k), patch});
  by_stamp.clear();
  std::optional<ChipReader> reader;
  if (options.engage) reader.emplace(envelope, *lanes, all_stamps, stamps, options.first_id, stock.voxel_mm(), shifts);
  tbb::parallel_for(std::size_t{0}, tiles.size(),
                    [&](std::size_t i) { work(tiles[i], shifts, reader ? &*reader : nullptr); });
}

void Stretch::Impl::work(WorkTile& w, const ShiftTable* shifts, const ChipReader* reader) const {
  const auto buffers = std::make_unique<WorkBuffers>();
  Tile& tile = *buffers->stock;
  stock.load(w.index, tile);
  const double material = material_voxels(tile, stock.voxel_mm());
  bool changed = false;
  TileStocks stocks{&tile, nullptr};
  if (!w.touches.empty()) {
    blank->load(w.index, buffers->blank);
    const auto band = static_cast<float>(stock.band_mm());
    if (std::any_of(buffers->blank.distance.begin(), buffers->blank.distance.end(), [&](float d) { return d > -band; }))
      stocks.blank = &buffers->blank;
  }
  auto touch = w.touches.begin();
  ColumnCover cover(tile, w.index, stock.voxel_mm(), stock.band_mm(), envelope.shape,
                    [&](std::int32_t id, Vec3& tip_mm, double& bend_mm) {
                      if (id < options.first_id) return false;
                      tip_mm = all_stamps[static_cast<std::size_t>(id - options.first_id)].tip_mm;
                      bend_mm = options.bent_before_mm;
                      return true;
                    });
  BatchCut batch_cut(envelope.shape, stock.voxel_mm(), stock.band_mm(), options.shrink_mm);
  const auto bend_of = [&](std::int32_t k) { return shifts ? bends[static_cast<std::size_t>(k)].largest_mm : 0.0; };
  const auto covers = [&](std::int32_t last, std::int32_t k) {
    return last >= 0 && !cover.changeable_after(stamps[static_cast<std::size_t>(last)].tip_mm, bend_of(last),
                                                stamps[static_cast<std::size_t>(k)].tip_mm, bend_of(k));
  };
  for (std::size_t from = 0; from < w.stamps.size() && !cover.all_air();) {
    std::size_t end = from + 1;
    while (end < w.stamps.size() && order.batch(w.stamps[end]) == order.batch(w.stamps[from])) ++end;
    for (; touch != w.touches.end() && touch->stamp <= w.stamps[end - 1]; ++touch)
      reader->read(stocks, w.index, touch->stamp, touch->patch, w.chips);
    const std::int32_t* batch = w.stamps.data() + from;
    if (!shifts && !envelope.shape.general) {
      changed |= batch_cut.cut(tile, cover, stamps, {batch, end - from}, first_id);
      from = end;
      continue;
    }
    for_each_coarse_to_fine(
        static_cast<std::int32_t>(end - from), [&](std::int32_t i, std::int32_t left, std::int32_t right) {
          const std::int32_t k = batch[i];
          // The neighbours of the batch are in the tile already; in the first of a batch the one before it.
          const std::int32_t before = left >= 0 ? batch[left] : from > 0 ? w.stamps[from - 1] : -1;
          if (covers(before, k) || (right >= 0 && covers(batch[right], k))) return;
          const Stamp& s = stamps[static_cast<std::size_t>(k)];
          const CarveStamp stamp{s.tip_mm, first_id + k, options.shrink_mm};
          if (bend_of(k) > 0)
            changed |= carve_bent(tile, cover, w.index, stock.voxel_mm(), stock.band_mm(), envelope, stamp, *shifts,
                                  bends[static_cast<std::size_t>(k)]);
          else
            changed |= removal::carve(tile, cover, w.index, stock.voxel_mm(), stock.band_mm(), envelope.shape, stamp);
        });
    from = end;
  }
  if (!changed) return;
  w.removed_mm3 = (material - material_voxels(tile, stock.voxel_mm())) * std::pow(stock.voxel_mm(), 3);
  w.result = std::move(buffers->stock);
}

/// Hands the chips over: the tiles have none then.
Engagement Stretch::Impl::gather() {
  Engagement out;
  out.first.assign(stamps.size() + 1, 0);
  for (const auto& tile : tiles)
    for (const auto& c : tile.chips) ++out.first[static_cast<std::size_t>(c.stamp) + 1];
  for (std::size_t k = 0; k < stamps.size(); ++k) out.first[k + 1] += out.first[k];
  out.chips.resize(out.first.back());
  std::vector<std::size_t> at(out.first.begin(), out.first.end() - 1);
  for (auto& tile : tiles) {
    for (const auto& c : tile.chips) out.chips[at[static_cast<std::size_t>(c.stamp)]++] = c.chip;
    std::vector<StampChip>().swap(tile.chips);
  }
  return out;
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
                                        {},
                                        {},
                                        {},
                                        {}})) {}
Stretch::~Stretch() = default;

Engagement Stretch::carve(const ShiftTable* shifts) {
  impl_->engager.reset();
  if (!shifts && impl_->options.engage && impl_->options.shrink_mm == 0) return impl_->engage();
  impl_->list_stamps(shifts);
  impl_->cut_tiles(shifts);
  return impl_->gather();
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
