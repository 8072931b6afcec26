#include <gtest/gtest.h>

#include <cmath>

#include "base/units.h"
#include "feedmodel/corner.h"
#include "feedmodel/drive.h"
#include "feedmodel/limits.h"
#include "feedmodel/overlap.h"
#include "tests/support/test_program.h"

namespace camber::feedmodel {
namespace {

TEST(Limits, ProjectionOnTheDirection) {
  EXPECT_NEAR(limit_along(Vec3(0.6, 0.8, 0), Vec3(600, 500, 400)), 500 / 0.8, 1e-9);
  EXPECT_NEAR(limit_in_plane(Vec3::UnitZ(), Vec3(600, 500, 400)), 500, 1e-9);
  EXPECT_TRUE(std::isinf(limit_along(Vec3::UnitX(), Vec3::Constant(machine::kNoLimit))));
}

TEST(Limits, BlockTimeAndArcs) {
  EXPECT_DOUBLE_EQ(mm_per_min_from_mm_per_s(block_time_speed(0.13333333333333333, 0.001)), 8000);  // KAKEN eq. 3
  EXPECT_NEAR(mm_per_min_from_mm_per_s(arc_speed(10, 3500, 1)), 11225, 1);                         // Takata B6
  EXPECT_NEAR(mm_per_min_from_mm_per_s(arc_servo_speed(10, 0.01, 33, 90, 8)), 4063, 1);            // Takata B7
}

/// v_b of docs/feed-model.md, also beside blocks slower than 1 mm/s.
TEST(Limits, OverlapBesideASlowBlock) {
  const PlanRow fast{.length_mm = 100, .speed_limit_mm_per_s = 10, .acceleration_mm_per_s2 = 100};
  const PlanRow slow{.length_mm = 0.02, .speed_limit_mm_per_s = 0.5, .acceleration_mm_per_s2 = 100};
  EXPECT_DOUBLE_EQ(overlap_speed(fast, slow, false), 0.02 / 0.5 * 100);
  EXPECT_DOUBLE_EQ(overlap_speed(slow, fast, false), 0.5);
  const PlanRow short_row{.length_mm = 0.02, .speed_limit_mm_per_s = 10, .acceleration_mm_per_s2 = 100};
  EXPECT_DOUBLE_EQ(overlap_speed(fast, short_row, true), 0.02 / 1 * 100);
}

/// At a reversal the load stays until the motor has taken up the play.
TEST(Backlash, IsLostAtAReversal) {
  Backlash load(0.02, 0);
  EXPECT_DOUBLE_EQ(load(1), 0.99);
  EXPECT_DOUBLE_EQ(load(0.985), 0.99);
  EXPECT_DOUBLE_EQ(load(0.5), 0.51);
  Backlash none(0, 0);
  EXPECT_EQ(none(1), 1);
}

TEST(Corner, SpeedDifferenceIsTheFanucForm) {
  EXPECT_NEAR(speed_difference_limit(Vec3::UnitX(), Vec3::UnitY(), Vec3(4, 5, 6)), 4, 1e-12);
  EXPECT_TRUE(std::isinf(speed_difference_limit(Vec3::UnitX(), Vec3::UnitX(), Vec3(4, 5, 6))));
}

TEST(Corner, AngleLawDividesByTheChange) {
  EXPECT_NEAR(angle_limit(Vec3::UnitX(), Vec3::UnitY(), 500, 0.01), 5 / std::sqrt(2.0), 1e-12);
}

TEST(Corner, RoundingKeepsTheTolerance) {
  const BlendOptions options{.tolerance_mm = 0.01,
                             .room_mm = 10,
                             .goal_speed_mm_per_s = 100,
                             .normal_fraction = 0.5,
                             .velocity_mm_per_s = Vec3::Constant(1000),
                             .acceleration_mm_per_s2 = Vec3(600, 500, 400)};
  const auto blend = blend_corner(Vec3::UnitX(), Vec3::UnitY(), options);
  ASSERT_TRUE(blend);
  EXPECT_NEAR(blend->radius_mm * (std::sqrt(2.0) - 1), 0.01, 1e-12);
  EXPECT_NEAR(blend->trim_mm, blend->radius_mm, 1e-12);
  EXPECT_NEAR(blend->speed_mm_per_s, std::sqrt(0.5 * 500 * blend->radius_mm), 1e-12);
  EXPECT_FALSE(blend_corner(Vec3::UnitX(), -Vec3::UnitX(), options));
}

TEST(Merge, StopsWhereACornerLeavesTheTolerance) {
  tests::TestProgram p;
  for (int i = 1; i <= 10; ++i) p.line(i, 0, 0, 600);
  p.line(10, 5, 0, 600);
  EXPECT_EQ(merged_run_end(p.program.moves, 0, 0.01), 10u);
  EXPECT_EQ(merged_run_end(p.program.moves, 0, 0), 1u);
}

TEST(AxisFilter, StepOfSpeedBecomesARamp) {
  AxisFilter filter(64, 0);
  double last = 0, position = 0, command = 0;
  for (int k = 0; k < 64; ++k) {
    last = position;
    position = filter(command += 0.01);
  }
  EXPECT_NEAR(position - last, 0.01, 1e-12);
}

TEST(PositionLoop, FollowingErrorIsSpeedOverGain) {
  PositionLoop loop({.gain_per_s = 33, .feed_forward_percent = 40, .period_s = 0.001}, 0);
  double command = 0;
  for (int k = 0; k < 2000; ++k) loop(command += 0.025);
  EXPECT_NEAR(command - loop.position_mm(), 25.0 * 0.6 / 33, 1e-9);
  EXPECT_NEAR(loop.velocity_mm_per_s(), 25, 1e-9);
}

TEST(PositionLoop, StepOfFirstOrderIsExponential) {
  PositionLoop loop({.gain_per_s = 50, .period_s = 0.001}, 0);
  loop(1.0);
  const double first = loop.position_mm();
  for (int k = 0; k < 100; ++k) loop(1.0);
  EXPECT_NEAR(1 - loop.position_mm(), (1 - first) * std::exp(-50 * 0.1), 1e-12);
}

TEST(PositionLoop, LagDoesNotDependOnThePeriod) {
  PositionLoop fine({.gain_per_s = 40, .velocity_lag_s = 0.004, .period_s = 0.0001}, 0);
  PositionLoop coarse({.gain_per_s = 40, .velocity_lag_s = 0.004, .period_s = 0.01}, 0);
  for (int k = 1; k <= 1000; ++k) fine(k * 0.001);
  for (int k = 1; k <= 10; ++k) coarse(k * 0.1);
  EXPECT_NEAR(fine.position_mm(), coarse.position_mm(), 1e-9);
}

TEST(PositionLoop, CircleShrinksByTheFirstOrderRatio) {
  const double r = 10, w = 8, kp = 33, dt = 0.001;
  PositionLoop x({.gain_per_s = kp, .period_s = dt}, r), y({.gain_per_s = kp, .period_s = dt}, 0);
  for (int k = 1; k <= 4000; ++k) {
    x(r * std::cos(w * k * dt));
    y(r * std::sin(w * k * dt));
  }
  EXPECT_NEAR(std::hypot(x.position_mm(), y.position_mm()), r / std::sqrt(1 + w * w / (kp * kp)), 1e-4);
}

}  // namespace
}  // namespace camber::feedmodel
