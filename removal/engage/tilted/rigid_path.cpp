#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "removal/engage/tilted/deflected_path.h"

namespace camber::removal::tilted {
namespace {

/// Engages stamp by stamp, and sorts the chips into blocks.
class TiltedRigidPath : public RigidPath {
 public:
  TiltedRigidPath(const EngagedRun& run, const EnvelopeBlocks& blocks, int pitches)
      : engager_(run, {true, pitches}),
        blocks_(blocks),
        steps_(run.envelope.steps_per_pitch),
        place_(run.envelope.size()) {
    constexpr auto lanes = static_cast<std::uint32_t>(EnvelopeBlocks::kLanes);
    for (std::uint32_t i = 0; i < blocks.size() * lanes; ++i)
      if (const std::uint32_t p = blocks.point(i / lanes, static_cast<int>(i % lanes)); p != EnvelopeBlocks::kNoPoint)
        place_[p] = i;
  }

  void engage(std::size_t from, std::size_t count, const ChipSink& sink) override {
    start(from, count);
    for (std::size_t k = 0; k < count; ++k) {
      sink(k, in_blocks(engager_.read(k)));
      engager_.cut(k, 1);
    }
  }

  /// Each stamp is cut before the next is read. Between two readings the middle one is read, too: where it or a glance
  /// at another one is not on the line between them, the tiles go back to the first, and all are read.
  void engage(std::size_t from, std::size_t count, const SparseChipSink& sink) override {
    start(from, count);
    glances_.assign(count, kUnknown);
    loads_known_.assign(count, 0);
    if (count > 0) read(0, sink);
    for (std::size_t last = 0, gap = 1; last + 1 < count;) {
      const std::size_t end = end_of_gap(last, gap, count, sink);
      gap = pass(last, end, sink) ? std::min(2 * (end - last), kWidestGap) : std::max<std::size_t>(1, (end - last) / 4);
      last = end;
    }
    if (count > 0) engager_.cut(count - 1, 1);
  }
  double commit() override { return engager_.commit(); }

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
    engager_.cut(a, 1);
    for (std::size_t k = a + 1; k < b; ++k) {
      if (leaves_out && k != middle)
        glances_[k] = engager_.glance(k, 1).front();
      else
        read(k, sink);
      engager_.cut(k, 1);
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
    engager_.cut(a, 1);
    for (std::size_t k = a + 1; k < b; ++k) {
      read(k, sink);
      engager_.cut(k, 1);
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

  Engager engager_;
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

std::unique_ptr<RigidPath> rigid_path(const EngagedRun& run, const EnvelopeBlocks& blocks, int pitches) {
  return std::make_unique<TiltedRigidPath>(run, blocks, pitches);
}

}  // namespace camber::removal::tilted
