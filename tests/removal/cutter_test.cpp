#include "removal/cutter.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/cutting.h"

namespace camber::removal {
namespace {

using testing::make_tool;

TEST(CutterShape, DistanceIsExactOnAndAroundABall) {
  const CutterShape ball = shape_of(make_tool(machine::ToolType::ball, 6, 2, 30));
  EXPECT_NEAR(ball.distance_mm({0, 0, 0}), 0, 1e-12);
  EXPECT_NEAR(ball.distance_mm({0, 0, 3}), -3, 1e-12);
  EXPECT_NEAR(ball.distance_mm({4, 0, 3}), 1, 1e-12);
  EXPECT_NEAR(ball.distance_mm({0, 5, 20}), 2, 1e-12);
  EXPECT_NEAR(ball.distance_mm({3, 4, -1}), std::sqrt(41.0) - 3, 1e-12);
}

TEST(CutterShape, DistanceIsExactAroundAFlatCuttersCorner) {
  const CutterShape flat = shape_of(make_tool(machine::ToolType::flat, 10, 2, 30));
  EXPECT_NEAR(flat.distance_mm({8, 0, -4}), 5, 1e-12);
  EXPECT_NEAR(flat.distance_mm({1, 0, -2}), 2, 1e-12);
  EXPECT_NEAR(flat.distance_mm({4, 0, 3}), -1, 1e-12);
}

TEST(CutterShape, GradientIsThatOfTheDistance) {
  const CutterShape bull{5, 1.5};
  constexpr double kStep = 1e-6;
  for (const Vec3& p : {Vec3(5.3, 1, 0.2), Vec3(1, 2, -0.5), Vec3(3, -5, 4), Vec3(4.2, 1.7, 0.3)}) {
    Vec3 g;
    for (int a = 0; a < 3; ++a) {
      Vec3 step = Vec3::Zero();
      step[a] = kStep;
      g[a] = (bull.distance_mm(p + step) - bull.distance_mm(p - step)) / (2 * kStep);
    }
    EXPECT_NEAR((g - bull.gradient(p)).norm(), 0, 1e-6);
  }
}

TEST(Envelope, RingsCoverTheProfileAndPointsLieOnIt) {
  const auto tool = make_tool(machine::ToolType::ball, 6, 2, 30);
  const EnvelopeGrid grid = make_envelope(tool, 5, 0.07, kPi / 180);
  double width = 0;
  for (const auto& ring : grid.rings) width += ring.width_mm;
  EXPECT_NEAR(width, 3 * kPi / 2 + 2, 1e-9);
  for (std::size_t i = 0; i < grid.size(); i += 97)
    EXPECT_NEAR(grid.shape.distance_mm({grid.x[i], grid.y[i], grid.z[i]}), 0, 1e-6);
}

TEST(Envelope, HigherPointsLagByTheHelix) {
  const auto tool = make_tool(machine::ToolType::flat, 10, 2, 45);
  const EnvelopeGrid grid = make_envelope(tool, 5, 0.1, kPi / 180);
  const auto& top = grid.rings.back();
  EXPECT_NEAR(top.lag_rad, top.profile.height_mm / 5, 1e-12);
}

TEST(Envelope, PatchesHoldEveryPointOnce) {
  EnvelopeGrid grid = make_envelope(make_tool(machine::ToolType::ball, 6, 3, 30), 4, 0.1, kPi / 90);
  make_patches(grid, 0.3);
  std::vector<int> count(grid.size());
  for (const auto& patch : grid.patches)
    for (int r = patch.ring_from; r < patch.ring_to; ++r)
      for (int i = patch.step_from; i < patch.step_to; ++i) {
        const auto p = static_cast<std::size_t>(r * grid.steps + i);
        ++count[p];
        EXPECT_LE((Vec3(grid.x[p], grid.y[p], grid.z[p]) - patch.centre_from_tip).norm(), patch.radius_mm + 1e-9);
      }
  for (const int c : count) EXPECT_EQ(c, 1);
}

}  // namespace
}  // namespace camber::removal
