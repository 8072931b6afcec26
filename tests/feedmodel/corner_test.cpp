// Rounded corners against the geometry of a circle that touches both sides.
#include "feedmodel/corner.h"

#include <cmath>

#include <gtest/gtest.h>

namespace camber::feedmodel {
namespace {

constexpr double kFar = 1e9;

BlendOptions wide_open() {
  return {.tolerance_mm = kFar,
          .room_mm = kFar,
          .goal_speed_mm_per_s = 10,
          .normal_fraction = 1,
          .velocity_mm_per_s = {kFar, kFar, kFar},
          .acceleration_mm_per_s2 = {1000, 1000, 1000}};
}

Vec3 direction(double degrees) {
  const double angle = degrees * kPi / 180;
  return {std::cos(angle), std::sin(angle), 0};
}

class BlendedCorner : public testing::TestWithParam<double> {
 protected:
  double turn_ = GetParam() * kPi / 180, half_ = (kPi - turn_) / 2;
  Blend blend(const BlendOptions& options) { return blend_corner({1, 0, 0}, direction(GetParam()), options).value(); }
};

TEST_P(BlendedCorner, PassesTheCornerAtTheTolerance) {
  BlendOptions options = wide_open();
  options.tolerance_mm = 0.001;
  options.goal_speed_mm_per_s = 1000;
  const Blend b = blend(options);
  EXPECT_NEAR(b.turn_rad, turn_, 1e-12);
  // From the corner to the centre less the radius.
  EXPECT_NEAR(std::hypot(b.trim_mm, b.radius_mm) - b.radius_mm, 0.001, 1e-9);
}

TEST_P(BlendedCorner, CutsOffTheWholeRoomAndNoMore) {
  BlendOptions options = wide_open();
  options.room_mm = 0.002;
  options.goal_speed_mm_per_s = 1000;
  const Blend b = blend(options);
  EXPECT_NEAR(b.trim_mm, 0.002, 1e-9);
  EXPECT_NEAR(b.radius_mm, 0.002 * std::tan(half_), 1e-9);
  EXPECT_NEAR(b.speed_mm_per_s, std::sqrt(b.acceleration_mm_per_s2 * b.radius_mm), 1e-9);
}

/// Each side loses v^2 / (a sin h), where nothing else limits the radius.
TEST_P(BlendedCorner, IsNoLargerThanTheGoalAsksFor) {
  const Blend b = blend(wide_open());
  EXPECT_NEAR(b.trim_mm, 100 / (b.acceleration_mm_per_s2 * std::sin(half_)), 1e-9);
  EXPECT_NEAR(b.radius_mm, b.trim_mm * std::tan(half_), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Turns, BlendedCorner, testing::Values(20.0, 90.0, 120.0, 150.0));

TEST(BlendedCorners, AreNoneWhereTheWayGoesOnOrBack) {
  EXPECT_FALSE(blend_corner({1, 0, 0}, {1, 0, 0}, wide_open()));
  EXPECT_FALSE(blend_corner({1, 0, 0}, {-1, 0, 0}, wide_open()));
}

}  // namespace
}  // namespace camber::feedmodel
