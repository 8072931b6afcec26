#include "deflection/chip_ends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace camber::deflection {

using removal::ChipBlock;
using removal::EnvelopeBlocks;

namespace {
constexpr double kMaxRamp = 2;  ///< steps; ends that run along a ring are not drawn out further
constexpr double kSameEnd = 3;  ///< steps within which the ends of two rings belong together
constexpr double kAbrupt = 2;   ///< ways between samples: a chip does not fall to a material that is farther
}  // namespace

std::span<const ChipEnd> ChipEnds::find(const removal::EnvelopeGrid& envelope, const EnvelopeBlocks& blocks,
                                        std::span<const ChipBlock> chips) {
  ends_.clear();
  first_.assign(envelope.rings.size() + 1, 0);
  const int rings = static_cast<int>(envelope.rings.size());
  int next_ring = 0;
  for (std::size_t from = 0, end = 0; from < chips.size(); from = end) {
    const int ring = blocks.block(chips[from].block).ring;
    while (end < chips.size() && blocks.block(chips[end].block).ring == ring) ++end;
    for (int half = 0; half < EnvelopeBlocks::kRings && ring + half < rings; ++half) {
      for (; next_ring <= ring + half; ++next_ring) first_[static_cast<std::size_t>(next_ring)] = ends_.size();
      add_ring(envelope, ring + half, chips.subspan(from, end - from), blocks, half);
    }
  }
  for (; next_ring <= rings; ++next_ring) first_[static_cast<std::size_t>(next_ring)] = ends_.size();
  set_ramps(envelope.steps);
  return ends_;
}

void ChipEnds::add_ring(const removal::EnvelopeGrid& envelope, int ring, std::span<const ChipBlock> chips,
                        const EnvelopeBlocks& blocks, int half) {
  constexpr int kSteps = EnvelopeBlocks::kSteps;
  const int pitch = envelope.steps_per_pitch, per_pitch = (pitch + kSteps - 1) / kSteps;
  const auto in_turn = static_cast<std::uint32_t>(per_pitch * envelope.flutes);
  // A pitch need not be whole blocks.
  const bool whole = pitch % kSteps == 0;
  const auto count_of = [&](const ChipBlock& chip) {
    return whole ? kSteps : std::min(kSteps, pitch - blocks.block(chip.block).step);
  };
  const double way_mm = envelope.rings[static_cast<std::size_t>(ring)].profile.radius_mm * 2 * kPi / envelope.steps;
  const auto samples_of = [&](const ChipBlock& chip) { return chip.thickness_mm.data() + half * kSteps; };
  // The block that follows in the turn; null: nothing is cut there, nor nearly.
  const auto neighbour = [&](std::size_t k, int side) -> const ChipBlock* {
    const std::uint32_t own = chips[k].block;
    const std::size_t next = side > 0 ? (k + 1 < chips.size() ? k + 1 : 0) : (k > 0 ? k - 1 : chips.size() - 1);
    const std::uint32_t other = chips[next].block;
    const bool beside =
        side > 0 ? other == own + 1 || other + in_turn == own + 1 : other + 1 == own || own + in_turn == other + 1;
    return beside && next != k ? &chips[next] : nullptr;
  };
  for (std::size_t k = 0; k < chips.size(); ++k) {
    const int count = count_of(chips[k]);
    std::array<float, kSteps + 2> h{};  // with a sample of each neighbour
    std::copy_n(samples_of(chips[k]), count, h.begin() + 1);
    int in_cut = 0;
    for (int l = 1; l <= count; ++l) in_cut += h[static_cast<std::size_t>(l)] > 0;
    if (in_cut == 0) continue;
    if (const ChipBlock* before = neighbour(k, -1)) h.front() = samples_of(*before)[count_of(*before) - 1];
    if (const ChipBlock* after = neighbour(k, 1)) h[static_cast<std::size_t>(count) + 1] = *samples_of(*after);
    if (in_cut == count && h.front() > 0 && h[static_cast<std::size_t>(count) + 1] > 0) continue;
    for (int l = 1; l <= count; ++l)
      for (const int side : {-1, 1}) {
        const auto at = [&](int i) { return static_cast<double>(h[static_cast<std::size_t>(i)]); };
        if (!(at(l) > 0) || at(l + side) > 0) continue;
        const int lane = half * kSteps + l - 1;
        ChipEnd e{.point = blocks.point(chips[k].block, lane), .ring = ring, .side = side, .thickness_mm = at(l)};
        e.step = blocks.block(chips[k].block).step + l - 1;
        e.width_fraction = chips[k].cut_255[static_cast<std::size_t>(lane)] / 255.0;
        double inside = 0;  // of the sample before, on the way out
        if (l - side >= 0 && l - side <= count + 1) inside = at(l - side);
        e.inside_mm = std::max(0.0, inside);
        const double beyond = at(l + side);
        if (beyond < -kAbrupt * way_mm)
          e.fall_mm = 0;
        else
          e.fall_mm = beyond < 0 ? at(l) - beyond : std::max(0.0, inside - at(l));
        if (e.fall_mm > 0) e.at = std::min(1.0, at(l) / e.fall_mm);
        ends_.push_back(e);
      }
  }
}

void ChipEnds::set_ramps(int steps) {
  const auto place = [&](const ChipEnd& e) { return static_cast<int>(e.point) % steps + e.side * e.at; };
  // Delay of the same end on the next ring, steps; NaN: there is none.
  const auto later = [&](const ChipEnd& e, int ring) {
    double least = std::numeric_limits<double>::quiet_NaN();
    if (ring < 0 || ring + 1 >= static_cast<int>(first_.size())) return least;
    for (std::size_t k = first_[static_cast<std::size_t>(ring)]; k < first_[static_cast<std::size_t>(ring) + 1]; ++k) {
      if (ends_[k].side != e.side) continue;
      const double d = std::remainder(place(ends_[k]) - place(e), static_cast<double>(steps));
      if (std::abs(d) < kSameEnd && !(std::abs(d) >= std::abs(least))) least = d;
    }
    return least;
  };
  for (ChipEnd& e : ends_) {
    const double up = later(e, e.ring + 1), down = later(e, e.ring - 1);
    const double ramp = std::isnan(up) ? (std::isnan(down) ? 0 : -down) : std::isnan(down) ? up : (up - down) / 2;
    e.ramp = std::min(kMaxRamp, std::abs(ramp));
  }
}

}  // namespace camber::deflection
