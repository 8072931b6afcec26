#include "removal/engagement.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "removal/engage/tilted/engager.h"
#include "removal/engage/upright/block_reader.h"
#include "removal/field/upright/batch_cut.h"
#include "removal/field/upright/carve.h"
#include "removal/field/upright/cut_tiles.h"
#include "removal/field/upright/stamp_order.h"
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
  std::int32_t last = -1;  ///< last stamp of the stretch that cut it
  std::vector<std::int32_t> batch{};
};

/// True where the glance at k lies on the line between those at a and b.
bool on_line_of_glances(std::span<const double> glances, std::size_t a, std::size_t k, std::size_t b) {
  constexpr double kMaterialChange = 0.06;
  const double way = static_cast<double>(k - a) / static_cast<double>(b - a);
  const double expected = (1 - way) * glances[a] + way * glances[b];
  return expected > 0 && std::abs(glances[k] - expected) <= kMaterialChange * expected;
}

/// Engages a path that is not upright, stamp by stamp, and sorts its chips into blocks.
class TiltedPath {
 public:
  TiltedPath(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope, std::span<const Stamp> stamps,
             std::int32_t first_id, int pitches, const EnvelopeBlocks& blocks)
      : engager_(stock, blank, envelope, stamps, first_id, {true, pitches}),
        blocks_(blocks),
        steps_(envelope.steps_per_pitch),
        place_(envelope.size()) {
    constexpr auto lanes = static_cast<std::uint32_t>(EnvelopeBlocks::kLanes);
    for (std::uint32_t i = 0; i < blocks.size() * lanes; ++i)
      if (const std::uint32_t p = blocks.point(i / lanes, static_cast<int>(i % lanes)); p != EnvelopeBlocks::kNoPoint)
        place_[p] = i;
  }

  void engage(std::size_t from, std::size_t count, const ChipSink& sink) {
    start(from, count);
    for (std::size_t k = 0; k < count; ++k) {
      sink(k, in_blocks(engager_.read(k)));
      engager_.cut(k);
    }
  }

  /// Each stamp is cut before the next is read. Between two readings the middle one is read, too: where it or a glance
  /// at another one is not on the line between them, the tiles go back to the first, and all are read.
  void engage(std::size_t from, std::size_t count, const SparseChipSink& sink) {
    start(from, count);
    glances_.assign(count, kUnknown);
    loads_known_.assign(count, 0);
    if (count > 0) read(0, sink);
    for (std::size_t last = 0, gap = 1; last + 1 < count;) {
      const std::size_t end = end_of_gap(last, gap, count, sink);
      gap = pass(last, end, sink) ? std::min(2 * (end - last), kWidestGap) : std::max<std::size_t>(1, (end - last) / 4);
      last = end;
    }
    if (count > 0) engager_.cut(count - 1);
  }
  double commit() { return engager_.commit(); }

 private:
  static constexpr std::size_t kWidestGap = 16;
  static constexpr double kUnknown = -1;

  void read(std::size_t k, const SparseChipSink& sink) {
    if (loads_known_[k] != 0) return;
    const std::span<const DeflectedChipSample> chips = engager_.read(k);
    glances_[k] = engager_.glance_of(chips);
    sink.read(k, in_blocks(chips));
    loads_known_[k] = 1;
  }

  static std::size_t end_of_gap(std::size_t last, std::size_t gap, std::size_t count, const SparseChipSink& sink) {
    std::size_t end = last + 1;
    while (end < last + gap && end + 1 < count && !sink.must_read(end)) ++end;
    return end;
  }

  /// From a, which is read and not cut, to b, which then is the same. False where the stamps between were all read.
  bool pass(std::size_t a, std::size_t b, const SparseChipSink& sink) {
    const std::size_t middle = a + (b - a) / 2;
    const bool leaves_out = b - a > 2;
    if (leaves_out) engager_.keep();
    engager_.cut(a);
    for (std::size_t k = a + 1; k < b; ++k) {
      if (leaves_out && k != middle)
        glances_[k] = engager_.glance(k);
      else
        read(k, sink);
      engager_.cut(k);
    }
    read(b, sink);
    if (b == a + 1) return true;
    bool even = sink.on_line(a, middle, b);
    for (std::size_t k = a + 1; k < b; ++k) even = even && as_glanced(a, k, b);
    if (!leaves_out) return even;
    if (even)
      for (std::size_t k = a + 1; k < b; ++k) {
        if (k != middle) sink.between(k < middle ? a : middle, k, k < middle ? middle : b);
      }
    else
      read_all(a, b, sink);
    return even;
  }

  void read_all(std::size_t a, std::size_t b, const SparseChipSink& sink) {
    engager_.go_back();
    engager_.cut(a);
    for (std::size_t k = a + 1; k < b; ++k) {
      read(k, sink);
      engager_.cut(k);
    }
  }

  bool as_glanced(std::size_t a, std::size_t k, std::size_t b) const { return on_line_of_glances(glances_, a, k, b); }

  void start(std::size_t from, std::size_t count) {
    if (straight_.stamps != count) straight_ = DeflectionTable(count, steps_, {0.0});
    engager_.start(from, count, straight_);
  }

  std::span<const ChipBlock> in_blocks(std::span<const DeflectedChipSample> chips) {
    sorted_.clear();
    for (const DeflectedChipSample& c : chips) sorted_.emplace_back(place_[c.chip.point], &c.chip);
    std::ranges::sort(sorted_, {}, [](const auto& c) { return c.first; });
    blocks_of_stamp_.clear();
    for (const auto& [place, chip] : sorted_) {
      const std::uint32_t block = place / EnvelopeBlocks::kLanes, lane = place % EnvelopeBlocks::kLanes;
      if (blocks_of_stamp_.empty() || blocks_of_stamp_.back().block != block) {
        blocks_of_stamp_.push_back({block, 0, 0, {}, {}});
        blocks_of_stamp_.back().cut_255.fill(255);
      }
      ChipBlock& b = blocks_of_stamp_.back();
      b.after_tooth |= static_cast<std::uint16_t>(chip->after_tooth << lane);
      b.own_surface |= static_cast<std::uint16_t>(chip->own_surface << lane);
      b.thickness_mm[lane] = chip->thickness_mm;
      b.cut_255[lane] = chip->cut_255;
    }
    return blocks_of_stamp_;
  }

  tilted::Engager engager_;
  const EnvelopeBlocks& blocks_;
  int steps_;
  std::vector<std::uint32_t> place_;  ///< place of each envelope point in the blocks, lane by lane
  DeflectionTable straight_;
  std::vector<std::pair<std::uint32_t, const ChipSample*>> sorted_;
  std::vector<ChipBlock> blocks_of_stamp_;
  std::vector<double> glances_;    ///< one per stamp of the stretch, where some stamps are not read
  std::vector<char> loads_known_;  ///< stamps that were read
};

}  // namespace

struct RigidEngager::Impl {
  Stock& stock;
  const Stock& blank;
  const EnvelopeGrid& envelope;
  std::span<const Stamp> all;
  std::int32_t first_id;
  EnvelopeBlocks blocks;
  BlockReader reader;
  double removed_mm3 = 0;           ///< volume removed from tiles given back since the last commit
  std::size_t from = 0;             ///< its first stamp
  std::span<const Stamp> stamps{};  ///< stamps of the stretch
  StampOrder order{};
  TileArena arena{};
  std::vector<std::optional<CutTile>> tiles{};  ///< by the arena's numbers
  tbb::enumerable_thread_specific<BlockReader::Buffers> buffers{};
  std::vector<double> glances{};       ///< one per stamp of the stretch, where some stamps are not read
  std::optional<TiltedPath> tilted{};  ///< does all the work where the path is not upright

  Impl(Stock& stock_, const Stock& blank_, const EnvelopeGrid& envelope_, std::span<const Stamp> stamps_,
       std::int32_t first_id_, int pitches, const KnownRun* known)
      : stock(stock_),
        blank(blank_),
        envelope(envelope_),
        all(stamps_),
        first_id(first_id_),
        blocks(envelope_, stock_.voxel_mm(), stock_.band_mm()),
        reader(envelope_, blocks, StampTips(stamps_, known), first_id_, stock_.voxel_mm(),
               stock_.max_mm().z() + stock_.band_mm(), pitches) {}

  void start_tiles();
  std::span<const ChipBlock> read(std::size_t k);
  std::vector<std::int32_t> earlier(std::size_t k) const;
  void read_batch(std::size_t begin, std::size_t end, const ChipSink& sink);
  void read_some(std::size_t begin, std::size_t end, const SparseChipSink& sink);
  bool as_glanced(std::size_t a, std::size_t k, std::size_t b) const;
  template <class ReadBatch>
  void engage(std::size_t first, std::size_t count, ReadBatch read_batch);
  void cut_batch(std::size_t begin, std::size_t end);
  void cut(std::size_t tile, BatchCut& batch_cut);
  void cut_general(std::size_t tile);
};

void RigidEngager::Impl::start_tiles() {
  for (auto& tile : tiles)
    if (tile) tile->last = -1;
  load_cut(stock, arena, envelope.shape, tips_by_id(all, first_id, 0), tiles);
  arena.read_tops(static_cast<int>(std::ceil(blocks.widest_mm() / stock.voxel_mm())),
                  [&](std::size_t t) -> const ColumnCover& { return tiles[t]->cover; });
}

std::vector<std::int32_t> RigidEngager::Impl::earlier(std::size_t k) const {
  std::vector<std::int32_t> out;
  for (const std::int32_t j : order.earlier(static_cast<std::int32_t>(k)))
    out.push_back(j + static_cast<std::int32_t>(from));
  return out;
}

std::span<const ChipBlock> RigidEngager::Impl::read(std::size_t k) {
  return reader.read(arena, all[from + k], earlier(k), buffers.local());
}

void RigidEngager::Impl::read_batch(std::size_t begin, std::size_t end, const ChipSink& sink) {
  tbb::parallel_for(begin, end, [&](std::size_t k) { sink(k, read(k)); });
}

bool RigidEngager::Impl::as_glanced(std::size_t a, std::size_t k, std::size_t b) const {
  return on_line_of_glances(glances, a, k, b);
}

void RigidEngager::Impl::read_some(std::size_t begin, std::size_t end, const SparseChipSink& sink) {
  using Gap = std::pair<std::size_t, std::size_t>;
  const auto read_all = [&](const std::vector<std::size_t>& which) {
    tbb::parallel_for(std::size_t{0}, which.size(), [&](std::size_t i) {
      const std::span<const ChipBlock> chips = read(which[i]);
      glances[which[i]] = reader.glance_of(chips);
      sink.read(which[i], chips);
    });
  };
  constexpr std::size_t kWidestGap = 16;
  std::vector<std::size_t> which;
  std::vector<Gap> gaps, left_out;
  for (std::size_t k = begin; k < end; ++k) {
    if (k != begin && k + 1 != end && k < which.back() + kWidestGap && !sink.must_read(k)) continue;
    if (k != begin) gaps.emplace_back(which.back(), k);
    which.push_back(k);
  }
  for (read_all(which); !gaps.empty();) {
    std::erase_if(gaps, [](const Gap& gap) { return gap.second - gap.first < 2; });
    which.clear();
    for (const auto& [a, b] : gaps) which.push_back(a + (b - a) / 2);
    read_all(which);
    std::vector<Gap> halves;
    for (std::size_t i = 0; i < gaps.size(); ++i) {
      const auto [a, b] = gaps[i];
      auto& into = as_glanced(a, which[i], b) && sink.on_line(a, which[i], b) ? left_out : halves;
      into.emplace_back(a, which[i]);
      into.emplace_back(which[i], b);
    }
    gaps = std::move(halves);
  }
  std::vector<Gap> gap_of;
  which.clear();
  for (const Gap& gap : left_out)
    for (std::size_t k = gap.first + 1; k < gap.second; ++k) which.push_back(k), gap_of.push_back(gap);
  tbb::parallel_for(std::size_t{0}, which.size(), [&](std::size_t i) {
    const std::size_t k = which[i];
    const auto [a, b] = gap_of[i];
    glances[k] = reader.glance(arena, all[from + k], earlier(k), buffers.local());
    if (as_glanced(a, k, b))
      sink.between(a, k, b);
    else
      sink.read(k, read(k));
  });
}

void RigidEngager::Impl::cut_batch(std::size_t begin, std::size_t end) {
  std::vector<std::size_t> reached;
  for (std::size_t k = begin; k < end; ++k)
    for (const std::int32_t t : arena.reached_by(k)) {
      CutTile& tile = *tiles[static_cast<std::size_t>(t)];
      if (tile.cover.all_air()) continue;
      if (tile.batch.empty()) reached.push_back(static_cast<std::size_t>(t));
      tile.batch.push_back(static_cast<std::int32_t>(k));
    }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, reached.size()), [&](const auto& range) {
    BatchCut batch_cut(envelope.shape, stock.voxel_mm(), stock.band_mm(), 0);
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (envelope.shape.general)
        cut_general(reached[i]);
      else
        cut(reached[i], batch_cut);
      CutTile& tile = *tiles[reached[i]];
      tile.last = tile.batch.back();
      tile.batch.clear();
    }
  });
}

void RigidEngager::Impl::cut(std::size_t t, BatchCut& batch_cut) {
  CutTile& tile = *tiles[t];
  tile.changed |= batch_cut.cut(arena[t], tile.cover, stamps, tile.batch, first_id + static_cast<std::int32_t>(from));
}

void RigidEngager::Impl::cut_general(std::size_t t) {
  CutTile& tile = *tiles[t];
  const auto tip = [&](std::int32_t k) -> const Vec3& { return stamps[static_cast<std::size_t>(k)].pose.tip_mm; };
  const auto covers = [&](std::int32_t last, std::int32_t k) {
    return last >= 0 && !tile.cover.changeable_after(tip(last), 0, tip(k), 0);
  };
  for_each_coarse_to_fine(
      static_cast<std::int32_t>(tile.batch.size()), [&](std::int32_t i, std::int32_t left, std::int32_t right) {
        const auto stamp = [&](std::int32_t n) { return tile.batch[static_cast<std::size_t>(n)]; };
        const std::int32_t k = stamp(i);
        // The neighbours of the batch are in the tile already; in the first of a batch the one before it.
        if (covers(left >= 0 ? stamp(left) : tile.last, k) || (right >= 0 && covers(stamp(right), k))) return;
        tile.changed |= carve(arena[t], tile.cover, arena.index(t), stock.voxel_mm(), stock.band_mm(), envelope.shape,
                              {tip(k), first_id + static_cast<std::int32_t>(from) + k, 0});
      });
}

RigidEngager::RigidEngager(Stock& stock, const Stock& blank, const EnvelopeGrid& envelope,
                           std::span<const Stamp> stamps, std::int32_t first_id, int pitches, const KnownRun* known)
    : impl_(std::make_unique<Impl>(stock, blank, envelope, stamps, first_id, pitches, known)) {
  if (!upright_run(stamps, known))
    impl_->tilted.emplace(stock, blank, envelope, stamps, first_id, pitches, impl_->blocks);
}
RigidEngager::~RigidEngager() = default;

const EnvelopeBlocks& RigidEngager::blocks() const { return impl_->blocks; }

template <class ReadBatch>
void RigidEngager::Impl::engage(std::size_t first, std::size_t count, ReadBatch read_batch) {
  assert(first >= from + stamps.size());
  from = first;
  stamps = all.subspan(from, count);
  if (count == 0) return;
  order = StampOrder::of_path(stamps, envelope.shape);
  arena.load(stock, &blank, envelope.shape, stamps,
             [&](auto left) { removed_mm3 += store_cut(stock, arena, left, tiles); });
  start_tiles();
  for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
    const std::int32_t batch = order.batch(static_cast<std::int32_t>(begin));
    while (end < count && order.batch(static_cast<std::int32_t>(end)) == batch) ++end;
    read_batch(begin, end);
    cut_batch(begin, end);
  }
}

void RigidEngager::engage(std::size_t from, std::size_t count, const ChipSink& sink) {
  if (impl_->tilted) return impl_->tilted->engage(from, count, sink);
  impl_->engage(from, count, [&](std::size_t begin, std::size_t end) { impl_->read_batch(begin, end, sink); });
}

void RigidEngager::engage(std::size_t from, std::size_t count, const SparseChipSink& sink) {
  if (impl_->tilted) return impl_->tilted->engage(from, count, sink);
  impl_->glances.assign(count, 0.0);
  impl_->engage(from, count, [&](std::size_t begin, std::size_t end) { impl_->read_some(begin, end, sink); });
}

double RigidEngager::commit() {
  Impl& m = *impl_;
  if (m.tilted) return m.tilted->commit();
  m.arena.clear([&](auto left) { m.removed_mm3 += store_cut(m.stock, m.arena, left, m.tiles); });
  return std::exchange(m.removed_mm3, 0.0);
}

}  // namespace camber::removal
