#include "deflection/chip_ends.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/cutting.h"

namespace camber::deflection {
namespace {

using removal::ChipBlock;
using removal::EnvelopeBlocks;

constexpr double kVoxel = 0.1, kBand = 0.3;

/// Blocks of a cut whose thickness at every point is `thickness(ring, step of the turn)`.
template <class Thickness>
std::vector<ChipBlock> chips_where(const removal::EnvelopeGrid& grid, const EnvelopeBlocks& blocks,
                                   Thickness thickness) {
  std::vector<ChipBlock> out;
  for (std::uint32_t b = 0; b < blocks.size(); ++b) {
    ChipBlock chip{.block = b};
    chip.cut_255.fill(255);
    bool any = false;
    for (int l = 0; l < EnvelopeBlocks::kLanes; ++l) {
      const std::uint32_t p = blocks.point(b, l);
      if (p == EnvelopeBlocks::kNoPoint) continue;
      const auto turn = static_cast<std::uint32_t>(grid.steps);
      const double h = thickness(static_cast<int>(p / turn), static_cast<int>(p % turn));
      chip.thickness_mm[static_cast<std::size_t>(l)] = static_cast<float>(h);
      any |= h != 0;
    }
    if (any) out.push_back(chip);
  }
  return out;
}

/// Four flutes: a pitch of 90 steps is not whole blocks.
removal::EnvelopeGrid envelope(int flutes) {
  return removal::make_envelope(testing::make_tool(machine::ToolType::flat, 10, flutes, 30), 2, 0.1, kPi / 180);
}

TEST(ChipEnds, LieWhereTheThicknessPassesThroughZero) {
  for (const int flutes : {2, 4}) {
    const auto grid = envelope(flutes);
    const EnvelopeBlocks blocks(grid, kVoxel, kBand);
    // In the cut from step -20.3 + ring / 10 to step 100.6 - ring / 4, across the turn's beginning.
    const auto from = [](int ring) { return -20.3 + 0.1 * ring; };
    const auto to = [](int ring) { return 100.6 - 0.25 * ring; };
    const auto chips = chips_where(grid, blocks, [&](int ring, int step) {
      const double at = step > 180 ? step - 360 : step;
      return 0.001 * std::max(-3.0, std::min({at - from(ring), to(ring) - at, 10.0}));
    });
    ChipEnds finder;
    const auto ends = finder.find(grid, blocks, chips);
    ASSERT_EQ(ends.size(), 2 * grid.rings.size());
    for (const ChipEnd& e : ends) {
      const int step = static_cast<int>(e.point) % grid.steps;
      const double at = (step > 180 ? step - 360 : step) + e.side * e.at;
      EXPECT_NEAR(at, e.side < 0 ? from(e.ring) : to(e.ring), 1e-3);
      EXPECT_NEAR(e.fall_mm, 0.001, 1e-6);
      EXPECT_NEAR(e.ramp, e.side < 0 ? 0.1 : 0.25, 1e-3);
    }
  }
}

TEST(ChipEnds, AreDrawnOutWhereTheNextSampleTellsNothing) {
  const auto grid = envelope(2);
  const EnvelopeBlocks blocks(grid, kVoxel, kBand);
  const auto chips = chips_where(grid, blocks, [&](int, int step) { return std::max(0.0, 0.002 * (50.7 - step)); });
  ChipEnds finder;
  const auto ends = finder.find(grid, blocks, chips);
  ASSERT_FALSE(ends.empty());
  for (const ChipEnd& e : ends) {
    if (e.side < 0) continue;  // the beginning at full thickness: half way
    EXPECT_EQ(static_cast<int>(e.point) % grid.steps, 50);
    EXPECT_NEAR(e.at, 0.7, 1e-3);
    EXPECT_NEAR(e.ramp, 0, 1e-3);
  }
  EXPECT_EQ(ends.front().at, 0.5);
}

}  // namespace
}  // namespace camber::deflection
