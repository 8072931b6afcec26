#include "removal/engagement.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "removal/engage/upright/bend_memory.h"
#include "removal/engage/upright/chip_reader.h"
#include "removal/engage/upright/patch_lanes.h"
#include "removal/field/upright/carve.h"
#include "removal/field/upright/cut_tiles.h"
#include "removal/field/upright/tile_arena.h"

namespace camber::removal {

using namespace upright;

namespace {

/// A tile that is being cut.
struct CutTile {
  ColumnCover cover;
  double material;  ///< as it was loaded, voxels
  bool changed = false;
  bool cut = false;  ///< by a stamp with this tip and bend last
  Vec3 last_tip_mm = Vec3::Zero();
  double last_deflection_mm = 0;
};

/// A patch of the envelope that may have points in a tile.
struct Touch {
  std::int32_t tile;
  std::uint32_t patch;
};

}  // namespace

struct DeflectedEngager::Impl {
  Stock& stock;
  const Stock& blank;
  const EnvelopeGrid& envelope;
  std::span<const Stamp> all;
  std::int32_t first_id;
  std::size_t from = 0;             ///< its first stamp
  std::span<const Stamp> stamps{};  ///< of the stretch
  const DeflectionTable* deflections = nullptr;
  std::optional<PatchLanes> lanes{};
  std::optional<ChipReader> reader{};
  std::optional<Stock::Probe> probe{};
  TileArena arena{};
  std::vector<std::optional<CutTile>> tiles{};  ///< as in the arena
  BendMemory memory{};
  double removed_mm3 = 0;        ///< from tiles that were given back since the last commit
  double max_deflection_mm = 0;  ///< of all stamps that were cut
  std::vector<float> into{};     ///< of the patches
  std::vector<Touch> touches{};
  std::vector<std::size_t> first_touch{};  ///< of each tile that is touched
  std::vector<std::vector<DeflectedChipSample>> chips_of_tile{};
  std::vector<DeflectedChipSample> chips{};

  void find_touches(std::size_t k);
  void cut(std::size_t tile, std::size_t k, const StampDeflection& deflection);
};

/// Patches that may be in material, by the stock as it was stored last: it only becomes less.
void DeflectedEngager::Impl::find_touches(std::size_t k) {
  touches.clear();
  const Stamp& stamp = stamps[k];
  const auto row = static_cast<std::ptrdiff_t>(k);
  const double moved = deflections->largest_mm(row);
  const double slewed = moved + (stamp.first ? moved : deflections->largest_mm(row - 1));
  const double feed = stamp.feed_per_tooth_mm.norm();
  // What curvature, a change of deflection and the deflected envelope's tilt add to the chip at most.
  const double bulge = feed * feed / (2 * std::max(envelope.shape.corner_radius_mm, 0.1)) + slewed + kMaxTilt * feed;
  lanes->motion_into(stamp.feed_per_tooth_mm, into);
  const auto least = static_cast<float>(-bulge - 1e-6);
  const double tile_mm = Tile::kCore * stock.voxel_mm();
  for (std::size_t i = 0; i < envelope.patches.size(); ++i) {
    if (into[i] <= least) continue;
    const auto& patch = envelope.patches[i];
    const double extent = patch.radius_mm + moved;
    const double reach = extent + 0.87 * stock.voxel_mm();
    const Vec3 centre = stamp.pose.tip_mm + patch.centre_from_tip;
    if (centre.z() - reach > stock.max_mm().z()) continue;
    // A value at the edge of the band tells no more.
    if (reach < stock.band_mm() && static_cast<double>(probe->nearest(centre)) > reach) continue;
    const Vec3 margin = Vec3::Constant(extent + 1e-3 * stock.voxel_mm());
    const Index3 lo = tile_of(centre - margin, tile_mm), hi = tile_of(centre + margin, tile_mm);
    for (int a = lo[0]; a <= hi[0]; ++a)
      for (int b = lo[1]; b <= hi[1]; ++b)
        for (int c = lo[2]; c <= hi[2]; ++c)
          if (const std::int32_t tile = arena.find(a, b, c); tile > 0)
            touches.push_back({tile, static_cast<std::uint32_t>(i)});
  }
  std::ranges::sort(
      touches, [](const Touch& a, const Touch& b) { return a.tile != b.tile ? a.tile < b.tile : a.patch < b.patch; });
  first_touch.clear();
  for (std::size_t i = 0; i < touches.size(); ++i)
    if (i == 0 || touches[i].tile != touches[i - 1].tile) first_touch.push_back(i);
  first_touch.push_back(touches.size());
}

void DeflectedEngager::Impl::cut(std::size_t t, std::size_t k, const StampDeflection& deflection) {
  CutTile& tile = *tiles[t];
  const Stamp& stamp = stamps[k];
  const double voxel = stock.voxel_mm(), band = stock.band_mm();
  if (tile.cover.all_air()) return;
  if (tile_distance_mm(arena.index(t), voxel, envelope.shape, stamp.pose.tip_mm) > band + deflection.largest_mm) return;
  if (tile.cut &&
      !tile.cover.changeable_after(tile.last_tip_mm, tile.last_deflection_mm, stamp.pose.tip_mm, deflection.largest_mm))
    return;
  const CarveStamp at{stamp.pose.tip_mm, first_id + static_cast<std::int32_t>(from + k)};
  tile.changed |=
      deflection.largest_mm > 0
          ? carve_deflected(arena[t], tile.cover, arena.index(t), voxel, band, envelope, at, *deflections, deflection)
          : carve(arena[t], tile.cover, arena.index(t), voxel, band, envelope.shape, at);
  tile.cut = true;
  tile.last_tip_mm = stamp.pose.tip_mm;
  tile.last_deflection_mm = deflection.largest_mm;
}

DeflectedEngager::DeflectedEngager(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope,
                                   std::span<const Stamp> stamps, std::int32_t first_id)
    : impl_(new Impl{stock, blank, envelope, stamps, first_id}) {
  assert(all_upright(stamps));
  assert(!envelope.patches.empty());
}
DeflectedEngager::~DeflectedEngager() = default;

void DeflectedEngager::start(std::size_t from, std::size_t count, const DeflectionTable& deflections) {
  Impl& m = *impl_;
  assert(from >= m.from + m.stamps.size());
  m.from = from;
  m.stamps = m.all.subspan(from, count);
  m.deflections = &deflections;
  if (count == 0) return;
  if (!m.lanes) m.lanes.emplace(m.envelope, deflections.node_height_mm);
  m.into.resize(m.envelope.patches.size());
  m.arena.load(
      m.stock, m.blank, m.envelope.shape, m.stamps,
      [&](auto left) { m.removed_mm3 += store_cut(m.stock, m.arena, left, m.tiles); }, kMaxDeflection_mm);
  load_cut(m.stock, m.arena, m.envelope.shape, tips_by_id(m.all, m.first_id, m.max_deflection_mm), m.tiles);
  m.memory.begin(deflections);
  m.reader.emplace(m.envelope, *m.lanes, m.all, m.stamps, m.first_id, m.stock.voxel_mm(), deflections, m.memory);
  m.probe.emplace(m.stock);
}

std::span<const DeflectedChipSample> DeflectedEngager::read(std::size_t k) {
  Impl& m = *impl_;
  m.find_touches(k);
  const std::size_t tiles = m.first_touch.size() - 1;
  if (m.chips_of_tile.size() < tiles) m.chips_of_tile.resize(tiles);
  const float reach_mm = m.reader->reach_mm(k);
  tbb::parallel_for(std::size_t{0}, tiles, [&](std::size_t i) {
    auto& out = m.chips_of_tile[i];
    out.clear();
    const auto t = static_cast<std::size_t>(m.touches[m.first_touch[i]].tile);
    const TileStocks stocks{&m.arena[t], m.arena.blank(t)};
    for (std::size_t j = m.first_touch[i]; j < m.first_touch[i + 1]; ++j)
      m.reader->read(stocks, m.arena.index(t), static_cast<std::int32_t>(k), reach_mm, m.touches[j].patch, out);
  });
  m.chips.clear();
  for (std::size_t i = 0; i < tiles; ++i)
    m.chips.insert(m.chips.end(), m.chips_of_tile[i].begin(), m.chips_of_tile[i].end());
  return m.chips;
}

void DeflectedEngager::cut(std::size_t k) {
  Impl& m = *impl_;
  const StampDeflection deflection = StampDeflections(m.envelope, *m.deflections).of(static_cast<std::ptrdiff_t>(k));
  m.memory.add(m.deflections->row(static_cast<std::ptrdiff_t>(k)));
  m.max_deflection_mm = std::max(m.max_deflection_mm, deflection.largest_mm);
  const auto reached = m.arena.reached_by(k);
  tbb::parallel_for(std::size_t{0}, reached.size(),
                    [&](std::size_t i) { m.cut(static_cast<std::size_t>(reached[i]), k, deflection); });
}

double DeflectedEngager::commit() {
  Impl& m = *impl_;
  m.probe.reset();
  m.arena.clear([&](auto left) { m.removed_mm3 += store_cut(m.stock, m.arena, left, m.tiles); });
  return std::exchange(m.removed_mm3, 0.0);
}

}  // namespace camber::removal
