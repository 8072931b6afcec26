#include "removal/engagement.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "removal/engage/glance.h"
#include "removal/engage/tilted/engager.h"
#include "removal/engage/upright/bend_memory.h"
#include "removal/engage/upright/chip_reader.h"
#include "removal/engage/upright/patch_lanes.h"
#include "removal/field/upright/carve.h"
#include "removal/field/upright/cut_tiles.h"
#include "removal/field/upright/tile_arena.h"
#include "removal/known_run.h"

namespace camber::removal {

using namespace upright;

namespace {

/// A tile that is being cut.
struct CutTile {
  ColumnCover cover;
  double material;  ///< volume of material when it was loaded, voxels
  bool changed = false;
  std::vector<std::int32_t> group{};  ///< stamps that are cut together and reach the tile
  bool cut = false;                   ///< whether a stamp has cut it; tip and bend are those of the last one
  Vec3 last_tip_mm = Vec3::Zero();
  double last_deflection_mm = 0;
};

}  // namespace

struct DeflectedEngager::Impl {
  Stock& stock;
  const Stock& blank;
  const EnvelopeGrid& envelope;
  std::span<const Stamp> all;
  std::int32_t first_id;
  std::size_t from = 0;             ///< its first stamp
  std::span<const Stamp> stamps{};  ///< stamps of the stretch
  const DeflectionTable* deflections = nullptr;
  std::optional<PatchLanes> lanes{};
  std::optional<ChipReader> reader{};
  TileArena arena{};
  std::vector<std::optional<CutTile>> tiles{};  ///< by the arena's numbers
  BendMemory memory{};
  double removed_mm3 = 0;               ///< volume removed from tiles given back since the last commit
  double max_deflection_mm = 0;         ///< largest deflection of all stamps that were cut
  double max_axial_mm = 0;              ///< the same along the axis
  std::vector<std::int32_t> patches{};  ///< patches that may take a chip
  std::vector<char> glanced_point{};    ///< by envelope point: its patch belongs to the glance
  std::vector<std::vector<DeflectedChipSample>> chips_of_group{};
  tbb::enumerable_thread_specific<ChipReader::Buffers> buffers{};
  std::vector<DeflectedChipSample> chips{};
  struct GlanceBuffers {
    std::vector<std::int32_t> patches;
    std::vector<DeflectedChipSample> chips;
  };
  tbb::enumerable_thread_specific<GlanceBuffers> glance_buffers{};
  std::vector<double> glances{};
  std::optional<StampDeflections> bends{};
  std::vector<StampDeflection> group{};     ///< stamps that are cut together
  std::vector<std::size_t> reached{};       ///< tiles
  std::optional<tilted::Engager> tilted{};  ///< does all the work where the path is not upright

  void begin(const DeflectionTable& table);
  double glance(std::size_t k);
  void list_group(std::size_t k, std::size_t count);
  void cut(std::size_t tile, std::size_t k, const StampDeflection& deflection);
};

void DeflectedEngager::Impl::begin(const DeflectionTable& table) {
  lanes.emplace(envelope, table.node_height_mm, stock.voxel_mm(), stock.band_mm());
  glanced_point.assign(envelope.x.size(), 0);
  for (std::uint32_t patch = 0; patch < envelope.patches.size(); ++patch) {
    if (!glanced_at(patch)) continue;
    const PatchLanes::Range range = lanes->range(patch);
    for (int l = 0; l < range.count; ++l) glanced_point[lanes->point(range.from + l)] = 1;
  }
}

void DeflectedEngager::Impl::cut(std::size_t t, std::size_t k, const StampDeflection& deflection) {
  CutTile& tile = *tiles[t];
  const Stamp& stamp = stamps[k];
  const double voxel = stock.voxel_mm(), band = stock.band_mm();
  if (tile.cover.all_air()) return;
  tile.cover.allow_axial(max_axial_mm);
  if (tile_distance_mm(arena.index(t), voxel, envelope.shape, stamp.pose.tip_mm) > band + deflection.largest_mm) return;
  const bool ends = std::isfinite(deflections->edges_end_mm);
  if (tile.cut && !ends &&
      !tile.cover.changeable_after(tile.last_tip_mm, tile.last_deflection_mm, stamp.pose.tip_mm, deflection.largest_mm))
    return;
  const CarveStamp at{stamp.pose.tip_mm, first_id + static_cast<std::int32_t>(from + k)};
  tile.changed |=
      deflection.largest_mm > 0 || ends
          ? carve_deflected(arena[t], tile.cover, arena.index(t), voxel, band, envelope, at, *deflections, deflection)
          : carve(arena[t], tile.cover, arena.index(t), voxel, band, envelope.shape, at);
  tile.cut = true;
  tile.last_tip_mm = stamp.pose.tip_mm;
  tile.last_deflection_mm = deflection.largest_mm;
}

DeflectedEngager::DeflectedEngager(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope,
                                   std::span<const Stamp> stamps, std::int32_t first_id, const KnownRun* known)
    : impl_(new Impl{stock, blank, envelope, stamps, first_id}) {
  assert(!envelope.patches.empty());
  if (!upright_run(stamps, known))
    impl_->tilted.emplace(stock, blank, envelope, stamps, first_id, tilted::ReadingRule{});
}
DeflectedEngager::~DeflectedEngager() = default;

void DeflectedEngager::remember(std::size_t from, std::span<const float> rows, std::size_t row_size,
                                double largest_mm) {
  Impl& m = *impl_;
  if (m.tilted) return m.tilted->remember(from, rows, row_size);
  m.max_deflection_mm = std::max(m.max_deflection_mm, largest_mm);
  m.memory.add_before(from, rows, row_size);
}

void DeflectedEngager::start(std::size_t from, std::size_t count, const DeflectionTable& deflections) {
  Impl& m = *impl_;
  if (m.tilted) return m.tilted->start(from, count, deflections);
  assert(from >= m.from + m.stamps.size());
  m.from = from;
  m.stamps = m.all.subspan(from, count);
  m.deflections = &deflections;
  if (count == 0) return;
  if (!m.lanes) m.begin(deflections);
  m.arena.load(
      m.stock, &m.blank, m.envelope.shape, m.stamps,
      [&](auto left) { m.removed_mm3 += store_cut(m.stock, m.arena, left, m.tiles); }, kMaxDeflection_mm);
  load_cut(m.stock, m.arena, m.envelope.shape, tips_by_id(m.all, m.first_id, m.max_deflection_mm), m.tiles);
  m.arena.read_tops(static_cast<int>(std::ceil((m.lanes->widest_mm() + kMaxDeflection_mm) / m.stock.voxel_mm())),
                    [&](std::size_t t) -> const ColumnCover& { return m.tiles[t]->cover; });
  m.memory.begin(deflections.row_size(), from);
  m.bends.emplace(m.envelope, deflections);
  m.reader.emplace(m.envelope, *m.lanes, m.all, m.stamps, m.first_id, m.stock.voxel_mm(), deflections, m.memory);
}

double DeflectedEngager::Impl::glance(std::size_t k) {
  GlanceBuffers& b = glance_buffers.local();
  reader->find_patches(arena, k, b.patches);
  std::erase_if(b.patches, [](std::int32_t patch) { return !glanced_at(static_cast<std::uint32_t>(patch)); });
  b.chips.clear();
  reader->read(arena, k, b.patches, buffers.local(), b.chips);
  return sum_of_glanced(b.chips, glanced_point);
}

std::span<const double> DeflectedEngager::glance(std::size_t k, std::size_t count) {
  Impl& m = *impl_;
  m.glances.resize(count);
  if (m.tilted) {
    for (std::size_t i = 0; i < count; ++i) m.glances[i] = m.tilted->glance(k + i);
    return m.glances;
  }
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { m.glances[i] = m.glance(k + i); });
  return m.glances;
}

double DeflectedEngager::glance_of(std::span<const DeflectedChipSample> chips) const {
  if (impl_->tilted) return impl_->tilted->glance_of(chips);
  return sum_of_glanced(chips, impl_->glanced_point);
}

std::span<const DeflectedChipSample> DeflectedEngager::read(std::size_t k) {
  constexpr std::size_t kGroup = 32;  // patches that a thread reads at once
  Impl& m = *impl_;
  if (m.tilted) return m.tilted->read(k);
  m.reader->find_patches(m.arena, k, m.patches);
  const std::size_t groups = (m.patches.size() + kGroup - 1) / kGroup;
  if (m.chips_of_group.size() < groups) m.chips_of_group.resize(groups);
  tbb::parallel_for(std::size_t{0}, groups, [&](std::size_t g) {
    const std::size_t from = g * kGroup, count = std::min(kGroup, m.patches.size() - from);
    m.chips_of_group[g].clear();
    m.reader->read(m.arena, k, std::span(m.patches).subspan(from, count), m.buffers.local(), m.chips_of_group[g]);
  });
  m.chips.clear();
  for (std::size_t g = 0; g < groups; ++g)
    m.chips.insert(m.chips.end(), m.chips_of_group[g].begin(), m.chips_of_group[g].end());
  return m.chips;
}

void DeflectedEngager::Impl::list_group(std::size_t k, std::size_t count) {
  group.clear();
  reached.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<std::ptrdiff_t>(k + i);
    group.push_back(bends->of(row));
    memory.add(deflections->row(row));
    max_deflection_mm = std::max(max_deflection_mm, group.back().largest_mm);
    max_axial_mm = std::max(max_axial_mm, group.back().axial_mm);
    for (const std::int32_t t : arena.reached_by(k + i)) {
      CutTile& tile = *tiles[static_cast<std::size_t>(t)];
      if (tile.cover.all_air()) continue;
      if (tile.group.empty()) reached.push_back(static_cast<std::size_t>(t));
      tile.group.push_back(static_cast<std::int32_t>(i));
    }
  }
}

/// The last stamp of a tile first: where the tool moves ahead, it leaves nothing to those before it.
void DeflectedEngager::cut(std::size_t k, std::size_t count) {
  Impl& m = *impl_;
  if (m.tilted) {
    for (std::size_t i = 0; i < count; ++i) m.tilted->cut(k + i);
    return;
  }
  m.list_group(k, count);
  tbb::parallel_for(std::size_t{0}, m.reached.size(), [&](std::size_t i) {
    auto& group = m.tiles[m.reached[i]]->group;
    for (; !group.empty(); group.pop_back()) {
      const auto of_group = static_cast<std::size_t>(group.back());
      m.cut(m.reached[i], k + of_group, m.group[of_group]);
    }
  });
}

double DeflectedEngager::commit() {
  Impl& m = *impl_;
  if (m.tilted) return m.tilted->commit();
  m.arena.clear([&](auto left) { m.removed_mm3 += store_cut(m.stock, m.arena, left, m.tiles); });
  return std::exchange(m.removed_mm3, 0.0);
}

}  // namespace camber::removal
