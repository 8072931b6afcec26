#include "removal/engage/tilted/deflected_path.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "base/cancel.h"
#include "base/stage.h"
#include "removal/engage/patch_reading.h"
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

/// What go_back() brings back.
struct Kept {
  bool keeps = false;             ///< since keep(), in this stretch
  std::vector<KeptTile> tiles{};  ///< the first `count` are in use
  std::size_t count = 0;
  std::vector<char> is_kept{};  ///< by tile of the arena
};

}  // namespace

struct Engager::Impl {
  EnvelopeGrid envelope;
  EngagedRun run;  ///< with that envelope
  ProfileRows profile;
  ReadingRule rule;
  std::size_t from = 0;             ///< its first stamp
  std::span<const Stamp> stamps{};  ///< stamps of the stretch
  std::vector<Way> way{};           ///< one per stamp
  const DeflectionTable* deflections = nullptr;
  std::optional<upright::PatchLanes> lanes{};
  std::optional<ChipReader> reader{};
  std::optional<PatchReading<ChipReader>> reading{};
  TileArena arena{};
  std::vector<std::optional<CutTile>> tiles{};  ///< by the arena's numbers
  upright::BendMemory memory{};
  std::size_t cut_end = 0;  ///< stamps of the stretch that were cut
  double removed_mm3 = 0;   ///< volume removed from tiles that were given back since the last commit
  std::optional<tbb::enumerable_thread_specific<DeflectedCarver>> carvers{};
  Kept kept{};

  Impl(const EngagedRun& run_, const ReadingRule& rule_)
      : envelope(with_patches(run_.envelope, run_.stock.band_mm())),
        run{run_.stock, run_.blank, envelope, run_.stamps, run_.first_id},
        profile(envelope.shape.profile),
        rule(rule_) {}
  void cut(std::size_t k);
  /// The tiles that the stamp may change, as they are before.
  void keep_tiles(std::span<const std::int32_t> reached, const Carving& stamp, const StampDeflection& deflection) {
    for (const std::int32_t number : reached) {
      const auto t = static_cast<std::size_t>(number);
      if (kept.is_kept[t] || !is_due(tiles[t]->rows, stamp, deflection)) continue;
      kept.is_kept[t] = 1;
      if (kept.count == kept.tiles.size())
        kept.tiles.push_back({t, arena[t], *tiles[t]});
      else
        kept.tiles[kept.count] = {t, arena[t], *tiles[t]};
      ++kept.count;
    }
  }
  void leave(std::span<const std::size_t> numbers) {
    removed_mm3 += upright::store_cut(run.stock, arena, numbers, tiles);
  }
};

Engager::Engager(const EngagedRun& run, const ReadingRule& rule) : impl_(std::make_unique<Impl>(run, rule)) {}
Engager::~Engager() = default;

void Engager::remember(std::size_t from, std::span<const float> rows, std::size_t row_size, double) {
  impl_->memory.add_before(from, rows, row_size);
}

void Engager::start(std::size_t from, std::size_t count, const DeflectionTable& deflections) {
  Impl& m = *impl_;
  m.from = from, m.cut_end = 0;
  m.stamps = m.run.stamps.subspan(from, count);
  m.deflections = &deflections;
  m.kept.keeps = false;
  if (count == 0) return;
  if (!m.lanes) {
    m.lanes.emplace(m.envelope, deflections.node_height_mm, m.run.stock.voxel_mm(), m.run.stock.band_mm());
    m.reading.emplace(m.envelope, *m.lanes);
  }
  m.way = ways(m.stamps, m.run.stock.min_mm(), m.run.stock.max_mm());
  m.arena.load(
      m.run.stock, &m.run.blank, m.envelope.shape, m.stamps, [&](auto left) { m.leave(left); },
      m.rule.rigid ? 0 : DeflectedEngager::kMaxDeflection_mm);
  load_cut(m.run.stock, m.arena, m.tiles);
  m.memory.begin(deflections.row_size(), from);
  m.carvers.emplace(DeflectedCarver(m.envelope, deflections));
  m.reader.emplace(m.run, *m.lanes, m.stamps, deflections, m.memory, m.rule);
}

std::span<const DeflectedChipSample> Engager::read(std::size_t k) {
  return impl_->reading->read(*impl_->reader, impl_->arena, k);
}

std::span<const double> Engager::glance(std::size_t k, std::size_t count) {
  return impl_->reading->glance(*impl_->reader, impl_->arena, k, count, impl_->cut_end);
}

double Engager::glance_of(std::span<const DeflectedChipSample> chips) const { return impl_->reading->glance_of(chips); }

void Engager::Impl::cut(std::size_t k) {
  const auto row = static_cast<std::ptrdiff_t>(k);
  const StampDeflection deflection =
      rule.rigid ? StampDeflection{deflections->row(row), 0, {}} : StampDeflections(envelope, *deflections).of(row);
  const StampFrame frame(stamps[k].pose);
  const Carving stamp{envelope.shape,
                      profile,
                      frame,
                      run.stock.voxel_mm(),
                      run.stock.band_mm(),
                      run.first_id + static_cast<std::int32_t>(from + k),
                      way[k]};
  const auto reached = arena.reached_by(k);
  if (kept.keeps) keep_tiles(reached, stamp, deflection);
  tbb::parallel_for(std::size_t{0}, reached.size(), [&](std::size_t i) {
    const auto t = static_cast<std::size_t>(reached[i]);
    CutTile& tile = *tiles[t];
    tile.changed |= carvers->local().carve(arena[t], tile.rows, arena.index(t), stamp, deflection);
  });
}

void Engager::cut(std::size_t k, std::size_t count) {
  Impl& m = *impl_;
  for (std::size_t i = k; i < k + count; ++i)
    if (!m.memory.knows(static_cast<std::int32_t>(m.from + i)))
      m.memory.add(m.deflections->row(static_cast<std::ptrdiff_t>(i)));
  for (std::size_t i = 0; i < count; ++i) m.cut(k + i);
  m.cut_end = k + count;
}

void Engager::keep() {
  Impl& m = *impl_;
  m.kept.keeps = true;
  m.kept.count = 0;
  m.kept.is_kept.assign(m.arena.size(), 0);
}

void Engager::go_back() {
  Impl& m = *impl_;
  for (const KeptTile& tile : std::span(m.kept.tiles).first(m.kept.count)) {
    m.arena[tile.number] = tile.tile;
    *m.tiles[tile.number] = tile.cut;
  }
  keep();
}

double Engager::commit() {
  Impl& m = *impl_;
  m.arena.clear([&](auto left) { m.leave(left); });
  return std::exchange(m.removed_mm3, 0.0);
}

std::unique_ptr<DeflectedPath> deflected_path(const EngagedRun& run) {
  return std::make_unique<Engager>(run, ReadingRule{});
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
        const StampFrame frame(part[k].pose);
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
