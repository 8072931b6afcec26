#include "deflection/teeth.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/units.h"
#include "simulate/cut.h"
#include "tests/support/cutting.h"

namespace camber::simulate {
namespace {

using deflection::Teeth;

machine::Tool mill(int flutes) { return testing::make_tool(machine::ToolType::flat, 10, flutes, 0); }

TEST(Teeth, RunOutMovesTheChipFromOneToothToTheOther) {
  auto tool = mill(2);
  tool.runout_mm = 0.01;
  const Teeth teeth(tool);
  EXPECT_FALSE(teeth.even());
  EXPECT_NEAR(teeth.tooth_runout_mm(0, 0), 0.01, 1e-12);
  EXPECT_NEAR(teeth.tooth_runout_mm(1, 0), -0.01, 1e-12);
  EXPECT_NEAR(teeth.chip_mm(0, 0.05, 1, 0), 0.07, 1e-12);
  EXPECT_NEAR(teeth.chip_mm(1, 0.05, 1, 0), 0.03, 1e-12);
  // Beyond the feed the short tooth no longer cuts, and the long one takes both chips.
  EXPECT_NEAR(teeth.chip_mm(0, 0.015, 1, 0), 0.03, 1e-12);
  EXPECT_NEAR(teeth.chip_mm(1, 0.015, 1, 0), 0, 1e-12);
}

TEST(Teeth, TakeTogetherWhatEvenTeethTake) {
  auto tool = mill(4);
  tool.pitch_rad = {rad_from_deg(85), rad_from_deg(97), rad_from_deg(83), rad_from_deg(95)};
  for (const double runout : {0.0, 0.008, 0.03, 0.2}) {
    tool.runout_mm = runout;
    tool.runout_angle_rad = 0.7;
    const Teeth teeth(tool);
    for (const double even : {0.02, 0.05}) {
      double sum = 0;
      for (int j = 0; j < 4; ++j) sum += teeth.chip_mm(j, even, 0.8, 0.3);
      EXPECT_NEAR(sum, 4 * even, 1e-12) << runout;
    }
  }
}

/// Slot loads in the steady middle: per tooth passing, in order.
std::vector<StampLoad> slot(const machine::Tool& tool, double feed) {
  // Along +Y: a tooth is in the middle of its cut in the middle of its passing.
  auto stock = testing::make_box({-6, 0, -3}, {6, 16, 0}, 0.1);
  std::vector<removal::Stamp> stamps;
  testing::add_row(stamps, {0, -6, -1}, {0, 12, -1}, feed);
  CutOptions options;
  options.coupling = machine::Coupling::rigid;
  const CutResult r = cut(stock, tool, {2000, 700, 0, 0, 0, 0}, stamps, {}, 0, options);
  std::vector<StampLoad> out;
  for (std::size_t k = 0; k < stamps.size(); ++k)
    if (stamps[k].pose.tip_mm.y() > 7 && stamps[k].pose.tip_mm.y() < 10) out.push_back(r.loads[k]);
  out.resize(out.size() / 2 * 2);
  return out;
}

TEST(Teeth, PeaksOfASlotFollowTheirTeethAndTheMeanStays) {
  auto tool = mill(2);
  const auto even = slot(tool, 0.1);
  tool.runout_mm = 0.01;
  const auto uneven = slot(tool, 0.1);
  // Straight teeth, no edge force: the force is proportional to the chip, 0.12 and 0.08 against 0.1.
  double most = 0, least = 1e9;
  Vec3 mean = Vec3::Zero(), even_mean = Vec3::Zero();
  for (std::size_t k = 0; k < uneven.size(); ++k) {
    most = std::max(most, uneven[k].lateral_max_N / even[k].lateral_max_N);
    least = std::min(least, uneven[k].lateral_max_N / even[k].lateral_max_N);
    mean += uneven[k].force_mean_N;
    even_mean += even[k].force_mean_N;
  }
  EXPECT_NEAR(most, 1.2, 0.01);
  EXPECT_NEAR(least, 0.8, 0.01);
  // Each tooth's chip is as long: the throw cancels over a turn, but for where sin(phi) is below the throw.
  EXPECT_NEAR((mean - even_mean).norm() / even_mean.norm(), 0, 0.03);
}

TEST(Teeth, UnequalPitchScalesTheChipWithThePitchBefore) {
  auto tool = mill(2);
  const auto even = slot(tool, 0.1);
  tool.pitch_rad = {rad_from_deg(160), rad_from_deg(200)};
  const auto uneven = slot(tool, 0.1);
  double most = 0;
  for (std::size_t k = 0; k < uneven.size(); ++k) most = std::max(most, uneven[k].lateral_max_N);
  EXPECT_NEAR(most / even[0].lateral_max_N, 200.0 / 180, 0.01);
}

}  // namespace
}  // namespace camber::simulate
