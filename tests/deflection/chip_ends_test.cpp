#include "deflection/chip_ends.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "deflection/tooth_pass.h"
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

/// Greatest lateral force of a chip of 0.02 mm that a slanting face bounds: behind it there is no material for
/// `beyond_mm` along the normal. In the cut from `from` on, turned back by two degrees and a bit a ring, to 60 degrees.
double greatest_force_N(double step_deg, double from_deg, double beyond_mm) {
  const auto tool = testing::make_tool(machine::ToolType::flat, 10, 2, 30);
  const auto grid = removal::make_envelope(tool, 2, 0.1, step_deg * kPi / 180);
  const EnvelopeBlocks blocks(grid, kVoxel, kBand);
  const machine::Material material{800, 300, 100, 12, 10, 1};
  const ToothPassModel model(grid, material, beam_of(tool), {0, 1, 2}, 0, Teeth(tool));
  constexpr double kBackOfARing_deg = 2.1, kTo_deg = 60;
  const auto chips = chips_where(grid, blocks, [&](int ring, int step) {
    const double at_deg = (step > grid.steps / 2 ? step - grid.steps : step) * step_deg;
    const bool in = at_deg > from_deg - kBackOfARing_deg * ring && at_deg < kTo_deg;
    return in ? 0.02 : -beyond_mm;
  });
  ToothPass pass;
  std::vector<float> fine(removal::DeflectionTable(0, kFine * model.steps(), model.node_height_mm(), false).row_size());
  model.evaluate(blocks, chips, 0, removal::ToothMotion{Vec3(0.05, 0, 0)}, pass, fine);
  double most = 0;
  for (const Vec3& f : pass.force_N) most = std::max(most, f.head<2>().norm());
  return most;
}

TEST(ChipEnds, AtAFaceAlongTheNormalAddNoForce) {
  for (const double from_deg : {20.0, 20.7, 21.3})
    for (const double beyond_mm : {0.1, 0.3, 0.4, 2.0}) {
      const double fine_N = greatest_force_N(0.25, from_deg, beyond_mm);
      EXPECT_NEAR(greatest_force_N(2, from_deg, beyond_mm), fine_N, 0.02 * fine_N) << from_deg << ' ' << beyond_mm;
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
