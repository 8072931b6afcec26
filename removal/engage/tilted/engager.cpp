#include "removal/engage/tilted/engager.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "base/cancel.h"
#include "base/stage.h"
#include "removal/engage/glance.h"
#include "removal/field/tilted/carve.h"
#include "removal/field/upright/cut_tiles.h"
#include "removal/field/upright/tile_arena.h"

namespace camber::removal::tilted {

using upright::TileArena;

namespace {

/// A tile that is being cut.
struct CutTile {
  double material;  ///< volume of material when it was loaded, voxels
  bool changed = false;
  RowsDue rows{};
};

/// A tile as it was at Engager::keep().
struct KeptTile {
  std::size_t number;
  Tile tile;
  CutTile cut;
};

/// Starts a new stretch: takes over the tiles that the arena has loaded last, and the ways of the stamps.
void load_cut(const Stock& stock, TileArena& arena, std::vector<std::optional<CutTile>>& tiles) {
  if (tiles.size() < arena.size()) tiles.resize(arena.size());
  for (auto& tile : tiles)
    if (tile) tile->rows.forget();
  const auto fresh = arena.fresh();
  tbb::parallel_for(std::size_t{0}, fresh.size(), [&](std::size_t i) {
    cancellation_point();
    tiles[fresh[i]].emplace(CutTile{upright::material_voxels(arena[fresh[i]], stock.voxel_mm())});
  });
}

EnvelopeGrid with_patches(const EnvelopeGrid& envelope, double band_mm) {
  EnvelopeGrid out = envelope;
  if (out.patches.empty()) make_patches(out, 0.6 * band_mm);
  return out;
}

}  // namespace

struct Engager::Impl {
  Stock& stock;
  const Stock& blank;
  EnvelopeGrid envelope;
  ProfileRows profile;
  std::span<const Stamp> all;
  std::int32_t first_id;
  ReadingRule rule;
  std::size_t from = 0;             ///< its first stamp
  std::span<const Stamp> stamps{};  ///< stamps of the stretch
  std::vector<Way> way{};           ///< one per stamp
  const DeflectionTable* deflections = nullptr;
  std::optional<upright::PatchLanes> lanes{};
  std::optional<ChipReader> reader{};
  TileArena arena{};
  std::vector<std::optional<CutTile>> tiles{};  ///< by the arena's numbers
  upright::BendMemory memory{};
  double removed_mm3 = 0;  ///< volume removed from tiles that were given back since the last commit
  std::vector<std::int32_t> patches{};
  std::vector<char> glanced_point{};
  std::vector<std::vector<DeflectedChipSample>> chips_of_group{};
  std::vector<DeflectedChipSample> chips{};
  tbb::enumerable_thread_specific<ChipReader::Buffers> buffers{};
  std::optional<tbb::enumerable_thread_specific<DeflectedCarver>> carvers{};
  bool keeps = false;            ///< since keep(), in this stretch
  std::vector<KeptTile> kept{};  ///< the first kept_count are in use
  std::size_t kept_count = 0;
  std::vector<char> is_kept{};  ///< by tile of the arena

  Impl(Stock& stock_, const Stock& blank_, EnvelopeGrid envelope_, std::span<const Stamp> stamps_,
       std::int32_t first_id_, const ReadingRule& rule_)
      : stock(stock_),
        blank(blank_),
        envelope(std::move(envelope_)),
        profile(envelope.shape.profile),
        all(stamps_),
        first_id(first_id_),
        rule(rule_) {}
  void begin(const DeflectionTable& table) {
    lanes.emplace(envelope, table.node_height_mm, stock.voxel_mm(), stock.band_mm());
    glanced_point.assign(envelope.size(), 0);
    for (std::uint32_t patch = 0; patch < envelope.patches.size(); ++patch) {
      const upright::PatchLanes::Range range = lanes->range(patch);
      for (int l = 0; glanced_at(patch) && l < range.count; ++l) glanced_point[lanes->point(range.from + l)] = 1;
    }
  }
  /// The tiles that the stamp may change, as they are before.
  void keep_tiles(std::span<const std::int32_t> reached, const Carving& stamp, const StampDeflection& deflection) {
    for (const std::int32_t number : reached) {
      const auto t = static_cast<std::size_t>(number);
      if (is_kept[t] || !is_due(tiles[t]->rows, stamp, deflection)) continue;
      is_kept[t] = 1;
      if (kept_count == kept.size())
        kept.push_back({t, arena[t], *tiles[t]});
      else
        kept[kept_count] = {t, arena[t], *tiles[t]};
      ++kept_count;
    }
  }
  void leave(std::span<const std::size_t> numbers) { removed_mm3 += upright::store_cut(stock, arena, numbers, tiles); }
};

Engager::Engager(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope, std::span<const Stamp> stamps,
                 std::int32_t first_id, const ReadingRule& rule)
    : impl_(std::make_unique<Impl>(stock, blank, with_patches(envelope, stock.band_mm()), stamps, first_id, rule)) {}
Engager::~Engager() = default;

void Engager::remember(std::size_t from, std::span<const float> rows, std::size_t row_size) {
  impl_->memory.add_before(from, rows, row_size);
}

void Engager::start(std::size_t from, std::size_t count, const DeflectionTable& deflections) {
  Impl& m = *impl_;
  m.from = from;
  m.stamps = m.all.subspan(from, count);
  m.deflections = &deflections;
  m.keeps = false;
  if (count == 0) return;
  if (!m.lanes) m.begin(deflections);
  m.way = ways(m.stamps, m.stock.min_mm(), m.stock.max_mm());
  m.arena.load(
      m.stock, &m.blank, m.envelope.shape, m.stamps, [&](auto left) { m.leave(left); },
      m.rule.rigid ? 0 : DeflectedEngager::kMaxDeflection_mm);
  load_cut(m.stock, m.arena, m.tiles);
  m.memory.begin(deflections.row_size(), from);
  m.carvers.emplace(DeflectedCarver(m.envelope, deflections));
  m.reader.emplace(m.envelope, *m.lanes, m.all, m.stamps, m.first_id, m.stock.voxel_mm(), deflections, m.memory,
                   m.rule);
}

double Engager::glance(std::size_t k) {
  Impl& m = *impl_;
  const ChipReader::Reading stamp = m.reader->reading_of(k);
  m.reader->find_patches(m.arena, stamp, m.patches);
  std::erase_if(m.patches, [](std::int32_t patch) { return !glanced_at(static_cast<std::uint32_t>(patch)); });
  m.chips.clear();
  m.reader->read(m.arena, stamp, m.patches, m.buffers.local(), m.chips);
  return glance_of(m.chips);
}

double Engager::glance_of(std::span<const DeflectedChipSample> chips) const {
  return sum_of_glanced(chips, impl_->glanced_point);
}

std::span<const DeflectedChipSample> Engager::read(std::size_t k) {
  constexpr std::size_t kGroup = 32;  // patches that a thread reads at once
  Impl& m = *impl_;
  const ChipReader::Reading stamp = m.reader->reading_of(k);
  m.reader->find_patches(m.arena, stamp, m.patches);
  const std::size_t groups = (m.patches.size() + kGroup - 1) / kGroup;
  if (m.chips_of_group.size() < groups) m.chips_of_group.resize(groups);
  tbb::parallel_for(std::size_t{0}, groups, [&](std::size_t g) {
    const std::size_t from = g * kGroup, count = std::min(kGroup, m.patches.size() - from);
    m.chips_of_group[g].clear();
    m.reader->read(m.arena, stamp, std::span(m.patches).subspan(from, count), m.buffers.local(), m.chips_of_group[g]);
  });
  m.chips.clear();
  for (std::size_t g = 0; g < groups; ++g)
    m.chips.insert(m.chips.end(), m.chips_of_group[g].begin(), m.chips_of_group[g].end());
  return m.chips;
}

void Engager::cut(std::size_t k) {
  Impl& m = *impl_;
  const auto row = static_cast<std::ptrdiff_t>(k);
  const StampDeflection deflection = m.rule.rigid ? StampDeflection{m.deflections->row(row), 0, {}}
                                                  : StampDeflections(m.envelope, *m.deflections).of(row);
  if (!m.memory.knows(static_cast<std::int32_t>(m.from + k))) m.memory.add(m.deflections->row(row));
  const Frame frame(m.stamps[k].pose);
  const Carving stamp{m.envelope.shape,
                      m.profile,
                      frame,
                      m.stock.voxel_mm(),
                      m.stock.band_mm(),
                      m.first_id + static_cast<std::int32_t>(m.from + k),
                      m.way[k]};
  const auto reached = m.arena.reached_by(k);
  if (m.keeps) m.keep_tiles(reached, stamp, deflection);
  tbb::parallel_for(std::size_t{0}, reached.size(), [&](std::size_t i) {
    const auto t = static_cast<std::size_t>(reached[i]);
    CutTile& tile = *m.tiles[t];
    tile.changed |= m.carvers->local().carve(m.arena[t], tile.rows, m.arena.index(t), stamp, deflection);
  });
}

void Engager::keep() {
  Impl& m = *impl_;
  m.keeps = true;
  m.kept_count = 0;
  m.is_kept.assign(m.arena.size(), 0);
}

void Engager::go_back() {
  Impl& m = *impl_;
  for (const KeptTile& kept : std::span(m.kept).first(m.kept_count)) {
    m.arena[kept.number] = kept.tile;
    *m.tiles[kept.number] = kept.cut;
  }
  keep();
}

double Engager::commit() {
  Impl& m = *impl_;
  m.arena.clear([&](auto left) { m.leave(left); });
  return std::exchange(m.removed_mm3, 0.0);
}

double sweep(Stock& stock, const CutterShape& shape, std::span<const Stamp> stamps, const SweepOptions& options) {
  constexpr std::size_t kAtOnce = 400;  // bounds the memory
  const ProfileRows profile(shape.profile);
  TileArena arena;
  std::vector<std::optional<CutTile>> tiles;
  double removed = 0;
  const auto leave = [&](std::span<const std::size_t> left) {
    removed += upright::store_cut(stock, arena, left, tiles);
  };
  for (std::size_t from = 0; from < stamps.size(); from += kAtOnce) {
    const auto part = stamps.subspan(from, std::min(kAtOnce, stamps.size() - from));
    const std::vector<Way> way = ways(part, stock.min_mm(), stock.max_mm());
    arena.load(stock, nullptr, shape, part, leave);
    load_cut(stock, arena, tiles);
    std::vector<std::vector<std::size_t>> by_tile(arena.size());
    for (std::size_t k = 0; k < part.size(); ++k)
      for (const std::int32_t t : arena.reached_by(k)) by_tile[static_cast<std::size_t>(t)].push_back(k);
    tbb::parallel_for(std::size_t{0}, by_tile.size(), [&](std::size_t t) {
      cancellation_point();
      for (const std::size_t k : by_tile[t]) {
        const Frame frame(part[k].pose);
        const Carving stamp{shape,           profile,
                            frame,           stock.voxel_mm(),
                            stock.band_mm(), options.first_id + static_cast<std::int32_t>(from + k),
                            way[k],          options.shrink_mm};
        tiles[t]->changed |= carve(arena[t], tiles[t]->rows, arena.index(t), stamp);
      }
    });
    if (options.stage) options.stage->advance(part.size());
  }
  arena.clear(leave);
  return removed;
}

}  // namespace camber::removal::tilted
