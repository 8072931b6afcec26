// A flat bottom that hardly goes down, as under an axis whose position loop comes to rest. Rigid coupling.
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "simulate/cut.h"
#include "tests/support/cutting.h"

namespace camber::simulate {
namespace {

using testing::make_box;
using testing::make_tool;

constexpr machine::Material kSteel{2000, 700, 300, 15, 12, 5};
constexpr double kRadius = 5, kFeed = 0.1;
constexpr int kFlutes = 3;
constexpr std::size_t kJudged = 150;  // passings: the cutter is in the slot with its whole disc

using Lean = std::function<void(removal::Stamp&)>;
void upright(removal::Stamp&) {}
/// By a hair, so that the code for tilted tools cuts: the bottom goes down by 1e-10 mm a passing more.
void hardly_tilted(removal::Stamp& stamp) { stamp.pose.axis = Eigen::AngleAxisd(-1e-9, Vec3::UnitY()) * Vec3::UnitZ(); }

/// A slot that is 1.033 mm deep at the last passing, to which the tool sinks by `sink_mm` a passing.
StampLoad slot(const machine::Tool& tool, double sink_mm, const Lean& lean = upright) {
  removal::Stock stock = make_box({0, -7, -3}, {16, 7, 0}, 0.1);
  std::vector<removal::Stamp> stamps;
  for (std::size_t k = 0; k <= kJudged; ++k) {
    removal::Stamp s;
    const auto passing = static_cast<double>(k);
    s.pose.tip_mm = {-5.2 + kFeed * passing, 0, -1.033 + sink_mm * (static_cast<double>(kJudged) - passing)};
    s.feed_per_tooth_mm = {kFeed, 0, -sink_mm};
    s.first = k == 0;
    lean(s);
    stamps.push_back(s);
  }
  CutOptions options;
  options.coupling = machine::Coupling::rigid;
  options.longest_gap = 1;
  return cut(stock, tool, kSteel, stamps, {}, 0, options).loads.back();
}

void expect_same(const StampLoad& is, const StampLoad& should) {
  EXPECT_NEAR(is.lateral_max_N, should.lateral_max_N, 1e-3 * should.lateral_max_N);
  EXPECT_NEAR(is.force_mean_N.z(), should.force_mean_N.z(), 1e-3 * should.lateral_max_N);
  EXPECT_NEAR(is.torque_mean_Nmm, should.torque_mean_Nmm, 1e-3 * should.torque_mean_Nmm);
}

machine::Tool mill() { return make_tool(machine::ToolType::flat, 2 * kRadius, kFlutes, 30); }

TEST(RestingAxis, ABottomThatSinksByNothingHasNoEdgeForce) {
  const StampLoad level = slot(mill(), 0);
  ASSERT_GT(level.lateral_max_N, 200);
  for (const double sink : {1e-15, 1e-12, 1e-9, 1e-6}) {
    SCOPED_TRACE(sink);
    expect_same(slot(mill(), sink), level);
  }
}

TEST(RestingAxis, NorHasThatOfTeethThatDiffer) {
  machine::Tool tool = mill();
  tool.runout_mm = 0.005;
  const StampLoad level = slot(tool, 0);
  for (const double sink : {1e-12, 1e-9}) {
    SCOPED_TRACE(sink);
    expect_same(slot(tool, sink), level);
  }
}

TEST(RestingAxis, NorHasThatOfATiltedTool) {
  const StampLoad level = slot(mill(), 0);
  for (const double sink : {1e-12, 1e-9}) {
    SCOPED_TRACE(sink);
    expect_same(slot(mill(), sink, hardly_tilted), level);
  }
}

TEST(RestingAxis, ABottomThatGoesDownCutsWithAllOfItsEdges) {
  // Every edge, R long, under the whole disc: N (K_rc h + K_re) R along the axis, and N (K_tc h + K_te) R^2 / 2 about
  // it, beside the wall's.
  const StampLoad level = slot(mill(), 0);
  for (const double sink : {1e-4, 1e-3}) {
    SCOPED_TRACE(sink);
    const StampLoad sinking = slot(mill(), sink);
    const double up = kFlutes * (kSteel.krc_MPa * sink + kSteel.kre_N_per_mm) * kRadius;
    const double torque = kFlutes * (kSteel.ktc_MPa * sink + kSteel.kte_N_per_mm) * kRadius * kRadius / 2;
    EXPECT_NEAR(sinking.force_mean_N.z() - level.force_mean_N.z(), up, 0.03 * up);
    EXPECT_NEAR(sinking.torque_mean_Nmm - level.torque_mean_Nmm, torque, 0.03 * torque);
  }
}

}  // namespace
}  // namespace camber::simulate
