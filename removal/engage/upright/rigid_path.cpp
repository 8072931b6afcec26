#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "removal/engage/engaged_path.h"
#include "removal/engage/upright/block_reader.h"
#include "removal/field/upright/batch_cut.h"
#include "removal/field/upright/carve.h"
#include "removal/field/upright/cut_tiles.h"
#include "removal/field/upright/stamp_order.h"
#include "removal/field/upright/tile_arena.h"

namespace camber::removal::upright {
namespace {

/// A tile that is being cut.
struct CutTile {
  ColumnCover cover;
  double material;  ///< volume of material when it was loaded, voxels
  bool changed = false;
  std::int32_t last = -1;  ///< last stamp of the stretch that cut it
  std::vector<std::int32_t> batch{};
};

/// Reads the stamps of a batch from the unchanged tiles, then cuts it.
class UprightRigidPath : public RigidPath {
 public:
  UprightRigidPath(const EngagedRun& run, const EnvelopeBlocks& blocks, int pitches)
      : stock_(run.stock),
        blank_(run.blank),
        envelope_(run.envelope),
        all_(run.stamps),
        first_id_(run.first_id),
        blocks_(blocks),
        reader_(envelope_, blocks_, StampTips(all_, run.known), first_id_, stock_.voxel_mm(),
                stock_.max_mm().z() + stock_.band_mm(), pitches) {}

  void engage(std::size_t first, std::size_t count, const ChipSink& sink) override {
    engage_batches(first, count, [&](std::size_t begin, std::size_t end) { read_batch(begin, end, sink); });
  }
  void engage(std::size_t first, std::size_t count, const SparseChipSink& sink) override {
    glances_.assign(count, 0.0);
    engage_batches(first, count, [&](std::size_t begin, std::size_t end) { read_some(begin, end, sink); });
  }
  double commit() override {
    arena_.clear([&](auto left) { removed_mm3_ += store_cut(stock_, arena_, left, tiles_); });
    return std::exchange(removed_mm3_, 0.0);
  }

 private:
  void start_tiles();
  std::span<const ChipBlock> read(std::size_t k);
  std::vector<std::int32_t> earlier(std::size_t k) const;
  void read_batch(std::size_t begin, std::size_t end, const ChipSink& sink);
  void read_some(std::size_t begin, std::size_t end, const SparseChipSink& sink);
  bool as_glanced(std::size_t a, std::size_t k, std::size_t b) const;
  template <class ReadBatch>
  void engage_batches(std::size_t first, std::size_t count, ReadBatch read_batch);
  void cut_batch(std::size_t begin, std::size_t end);
  void cut(std::size_t tile, BatchCut& batch_cut);
  void cut_general(std::size_t tile);

  Stock& stock_;
  const Stock& blank_;
  const EnvelopeGrid& envelope_;
  std::span<const Stamp> all_;
  std::int32_t first_id_;
  const EnvelopeBlocks& blocks_;
  BlockReader reader_;
  double removed_mm3_ = 0;           ///< volume removed from tiles given back since the last commit
  std::size_t from_ = 0;             ///< its first stamp
  std::span<const Stamp> stamps_{};  ///< stamps of the stretch
  StampOrder order_{};
  TileArena arena_{};
  std::vector<std::optional<CutTile>> tiles_{};  ///< by the arena's numbers
  tbb::enumerable_thread_specific<BlockReader::Buffers> buffers_{};
  std::vector<double> glances_{};  ///< one per stamp of the stretch, where some stamps are not read
};

void UprightRigidPath::start_tiles() {
  for (auto& tile : tiles_)
    if (tile) tile->last = -1;
  load_cut(stock_, arena_, envelope_.shape, tips_by_id(all_, first_id_, 0), tiles_);
  arena_.read_tops(static_cast<int>(std::ceil(blocks_.widest_mm() / stock_.voxel_mm())),
                   [&](std::size_t t) -> const ColumnCover& { return tiles_[t]->cover; });
}

std::vector<std::int32_t> UprightRigidPath::earlier(std::size_t k) const {
  std::vector<std::int32_t> out;
  for (const std::int32_t j : order_.earlier(static_cast<std::int32_t>(k)))
    out.push_back(j + static_cast<std::int32_t>(from_));
  return out;
}

std::span<const ChipBlock> UprightRigidPath::read(std::size_t k) {
  return reader_.read(arena_, all_[from_ + k], earlier(k), buffers_.local());
}

void UprightRigidPath::read_batch(std::size_t begin, std::size_t end, const ChipSink& sink) {
  tbb::parallel_for(begin, end, [&](std::size_t k) { sink(k, read(k)); });
}

bool UprightRigidPath::as_glanced(std::size_t a, std::size_t k, std::size_t b) const {
  return on_line_of_glances(glances_, a, k, b);
}

void UprightRigidPath::read_some(std::size_t begin, std::size_t end, const SparseChipSink& sink) {
  using Gap = std::pair<std::size_t, std::size_t>;
  const auto read_all = [&](const std::vector<std::size_t>& which) {
    tbb::parallel_for(std::size_t{0}, which.size(), [&](std::size_t i) {
      const std::span<const ChipBlock> chips = read(which[i]);
      glances_[which[i]] = reader_.glance_of(chips);
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
    glances_[k] = reader_.glance(arena_, all_[from_ + k], earlier(k), buffers_.local());
    if (as_glanced(a, k, b))
      sink.between(a, k, b);
    else
      sink.read(k, read(k));
  });
}

void UprightRigidPath::cut_batch(std::size_t begin, std::size_t end) {
  std::vector<std::size_t> reached;
  for (std::size_t k = begin; k < end; ++k)
    for (const std::int32_t t : arena_.reached_by(k)) {
      CutTile& tile = *tiles_[static_cast<std::size_t>(t)];
      if (tile.cover.all_air()) continue;
      if (tile.batch.empty()) reached.push_back(static_cast<std::size_t>(t));
      tile.batch.push_back(static_cast<std::int32_t>(k));
    }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, reached.size()), [&](const auto& range) {
    BatchCut batch_cut(envelope_.shape, stock_.voxel_mm(), stock_.band_mm(), 0);
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (envelope_.shape.general)
        cut_general(reached[i]);
      else
        cut(reached[i], batch_cut);
      CutTile& tile = *tiles_[reached[i]];
      tile.last = tile.batch.back();
      tile.batch.clear();
    }
  });
}

void UprightRigidPath::cut(std::size_t t, BatchCut& batch_cut) {
  CutTile& tile = *tiles_[t];
  tile.changed |=
      batch_cut.cut(arena_[t], tile.cover, stamps_, tile.batch, first_id_ + static_cast<std::int32_t>(from_));
}

void UprightRigidPath::cut_general(std::size_t t) {
  CutTile& tile = *tiles_[t];
  const auto tip = [&](std::int32_t k) -> const Vec3& { return stamps_[static_cast<std::size_t>(k)].pose.tip_mm; };
  const auto covers = [&](std::int32_t last, std::int32_t k) {
    return last >= 0 && !tile.cover.changeable_after(tip(last), 0, tip(k), 0);
  };
  for_each_coarse_to_fine(
      static_cast<std::int32_t>(tile.batch.size()), [&](std::int32_t i, std::int32_t left, std::int32_t right) {
        const auto stamp = [&](std::int32_t n) { return tile.batch[static_cast<std::size_t>(n)]; };
        const std::int32_t k = stamp(i);
        // The neighbours of the batch are in the tile already; in the first of a batch the one before it.
        if (covers(left >= 0 ? stamp(left) : tile.last, k) || (right >= 0 && covers(stamp(right), k))) return;
        tile.changed |= carve(arena_[t], tile.cover, arena_.index(t), stock_.voxel_mm(), stock_.band_mm(),
                              envelope_.shape, {tip(k), first_id_ + static_cast<std::int32_t>(from_) + k, 0});
      });
}

template <class ReadBatch>
void UprightRigidPath::engage_batches(std::size_t first, std::size_t count, ReadBatch read_batch) {
  assert(first >= from_ + stamps_.size());
  from_ = first;
  stamps_ = all_.subspan(from_, count);
  if (count == 0) return;
  order_ = StampOrder::of_path(stamps_, envelope_.shape);
  arena_.load(stock_, &blank_, envelope_.shape, stamps_,
              [&](auto left) { removed_mm3_ += store_cut(stock_, arena_, left, tiles_); });
  start_tiles();
  for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
    const std::int32_t batch = order_.batch(static_cast<std::int32_t>(begin));
    while (end < count && order_.batch(static_cast<std::int32_t>(end)) == batch) ++end;
    read_batch(begin, end);
    cut_batch(begin, end);
  }
}

}  // namespace

std::unique_ptr<RigidPath> rigid_path(const EngagedRun& run, const EnvelopeBlocks& blocks, int pitches) {
  return std::make_unique<UprightRigidPath>(run, blocks, pitches);
}

}  // namespace camber::removal::upright
