#include "copymill/slotting.h"

#include <cmath>

#include <gtest/gtest.h>

namespace camber::copymill {
namespace {

Vec2 unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

TEST(Trochoid, EngagementOnAStraightWall) {
  EXPECT_NEAR(engagement_angle_rad(5, 5), kPi / 2, 1e-12);
  EXPECT_NEAR(engagement_angle_rad(5, 2.5), kPi / 3, 1e-12);
  EXPECT_NEAR(engagement_angle_rad(5, 10), kPi, 1e-12);
  EXPECT_NEAR(engagement_angle_rad(5, 12), kPi, 1e-12);
}

/// A hole of radius 8 made 1 mm larger by a cutter of radius 5: a triangle of the axis' way 4, R = 5 and the old wall.
TEST(Trochoid, EngagementOfACircleInACircle) {
  const double angle = greatest_engagement_rad(5, {Vec2::Zero(), 3}, {Vec2::Zero(), 4});
  EXPECT_NEAR(angle, std::acos((8.0 * 8 - 4.0 * 4 - 5.0 * 5) / (2 * 4 * 5)), 1e-9);
}

/// Around circles much larger than the cutter the wall is straight, and the advance is the radial depth.
TEST(Trochoid, LargeCirclesHaveTheEngagementOfAStraightWall) {
  for (const double depth : {0.2, 1.0, 3.0}) {
    const double r = 5000;
    EXPECT_NEAR(greatest_engagement_rad(5, {Vec2::Zero(), r}, {Vec2(depth, 0), r}), engagement_angle_rad(5, depth),
                2e-3)
        << depth;
  }
}

/// Places of the axis, close together: around one circle, on to the next, and around that.
std::vector<Vec2> walked(double R, const Circle& before, const Circle& next) {
  std::vector<Vec2> out;
  const int n = static_cast<int>(2 * kPi * std::max(before.radius_mm, next.radius_mm) / (0.002 * R));
  const auto around = [&](const Circle& c) {
    for (int k = 0; k <= n; ++k) out.emplace_back(c.centre + c.radius_mm * unit(2 * kPi * k / n - kPi / 2));
  };
  around(before);
  const Vec2 from = out.back(), to = next.centre + next.radius_mm * unit(-kPi / 2);
  for (int k = 1; k < 200; ++k) out.emplace_back(from + k / 200.0 * (to - from));
  around(next);
  return out;
}

/// The part of the circumference, in degrees, that is in none of the discs that the cutter has been at before.
int fresh_degrees(double R, const std::vector<Vec2>& places, std::size_t now, const Vec2& way) {
  int out = 0;
  for (int d = -89; d <= 90; ++d) {
    const double a = std::atan2(way.y(), way.x()) + (d - 0.5) * kPi / 180;
    const Vec2 p = places[now] + R * unit(a);
    bool cut = false;
    for (std::size_t k = 0; k < now && !cut; ++k) cut = (p - places[k]).squaredNorm() < R * R * (1 - 1e-9);
    out += cut ? 0 : 1;
  }
  return out;
}

/// Against discs that are taken away one by one, also on the way to a larger circle.
TEST(Trochoid, EngagementIsThatOfDiscsTakenAway) {
  struct Case {
    double R, r0, r1, advance;
  };
  for (const Case& c :
       {Case{5, 0.8, 0.8, 0.15}, {5, 0.8, 0.8, 0.5}, {5, 2.5, 2.5, 1}, {4, 2, 2, 1.5}, {3, 1, 1.2, 0.4}}) {
    const Circle before{Vec2::Zero(), c.r0}, next{Vec2(c.advance, 0), c.r1};
    const std::vector<Vec2> places = walked(c.R, before, next);
    int most = 0;
    const std::size_t begin = places.size() / 2;
    for (std::size_t k = begin; k + 1 < places.size(); k += 12)
      most = std::max(most, fresh_degrees(c.R, places, k, places[k + 1] - places[k]));
    const double said = greatest_engagement_rad(c.R, before, next) * 180 / kPi;
    EXPECT_LT(most, said + outward_rad(before, next) * 180 / kPi + 2.5) << c.R << ' ' << c.r0 << ' ' << c.advance;
    EXPECT_GT(most, said - 3.5) << c.R << ' ' << c.r0 << ' ' << c.advance;
  }
}

TEST(Trochoid, TheStepHasTheEngagementThatIsAllowed) {
  for (const double radial : {0.5, 2.0, 4.0})
    for (const double r : {0.5, 2.0, 10.0}) {
      const double limit = engagement_angle_rad(5, radial), step = trochoid_step_mm(5, r, limit);
      EXPECT_NEAR(greatest_engagement_rad(5, {Vec2::Zero(), r}, {Vec2(step, 0), r}), limit, 1e-5);
      EXPECT_LT(step, radial);  // the wall is hollow
      EXPECT_GT(step, 0.02 * radial);
    }
}

TEST(Trochoid, RunsAroundItsCirclesWithoutAKink) {
  const std::vector<Circle> circles{{{0, 0}, 2}, {{0.5, 0}, 2}, {{1, 0.1}, 2.1}, {{1.4, 0.5}, 2}};
  for (const bool ccw : {true, false}) {
    const std::vector<PathPiece> path = trochoid(circles, -3, ccw, 0.001);
    const Vec2 start = start_of(circles, ccw);
    EXPECT_NEAR(start.y(), ccw ? -2 : 2, 1e-12);
    EXPECT_LT((path.front().from - Vec3(start.x(), start.y(), -3)).norm(), 0.001);
    double turned = 0;
    for (std::size_t k = 0; k < path.size(); ++k) {
      if (path[k].arc) {
        turned += path[k].sweep_rad;
        EXPECT_NEAR((path[k].to.head<2>() - path[k].centre).norm(), path[k].radius_mm(), 0.002);
        EXPECT_EQ(path[k].sweep_rad > 0, ccw);
      }
      if (k == 0) continue;
      EXPECT_EQ(path[k].from, path[k - 1].to);
      EXPECT_GT(path[k].direction(0).dot(path[k - 1].direction(path[k - 1].length_mm)), std::cos(0.25)) << k;
    }
    // Once around each, and as much more as the way turns: 45 degrees to the left.
    EXPECT_NEAR(turned, (ccw ? 1 : -1) * 8 * kPi + kPi / 4, 0.02);
  }
}

}  // namespace
}  // namespace camber::copymill
