#include "inspect/fits.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <random>

namespace camber::inspect {
namespace {

constexpr double kExact_mm = 1e-9;  // of a fit against its closed form

std::vector<Vec2> ring(int count, const std::function<double(double)>& radius, const Vec2& centre = {3, -7}) {
  std::vector<Vec2> out;
  for (int i = 0; i < count; ++i) {
    const double a = 2 * kPi * i / count;
    out.push_back(centre + radius(a) * Vec2(std::cos(a), std::sin(a)));
  }
  return out;
}

TEST(Minimax, FindsTheCornerOfATriangle) {
  // Maximize x + y within x + 2 y <= 4, 3 x + y <= 6: (1.6, 1.2).
  const std::vector<Inequality> sides{{Eigen::Vector2d(1, 2), 4}, {Eigen::Vector2d(3, 1), 6}};
  const LinearOptimum best = minimize(Eigen::Vector2d(-1, -1), sides, Eigen::Vector2d(100, 100));
  ASSERT_TRUE(best.optimal);
  EXPECT_NEAR(best.x[0], 1.6, 1e-12);
  EXPECT_NEAR(best.x[1], 1.2, 1e-12);
  EXPECT_EQ(best.active.size(), 2u);
}

TEST(Minimax, SaysWhereNothingFulfilsAllInequalities) {
  const std::vector<Inequality> sides{{Eigen::VectorXd::Constant(1, 1.0), -2},
                                      {Eigen::VectorXd::Constant(1, -1.0), -2}};
  EXPECT_FALSE(minimize(Eigen::VectorXd::Constant(1, 1.0), sides, Eigen::VectorXd::Constant(1, 10.0)).optimal);
}

TEST(Circle, ThreeLobesHaveClosedFormsForEveryFilter) {
  // r = R + e cos 3t. The three highest and the three lowest points are 120 degrees apart, so that no shift of the
  // centre brings all three in or out: inscribed R - e, circumscribed R + e, zone 2 e about R, all about the lobes'
  // centre.
  const double radius = 5, e = 0.004;
  const auto points = ring(36, [&](double t) { return radius + e * std::cos(3 * t); });
  const std::array<double, 4> wanted{radius, radius - e, radius + e, radius};
  for (const FeatureFilter f : {FeatureFilter::least_squares, FeatureFilter::max_inscribed,
                                FeatureFilter::min_circumscribed, FeatureFilter::min_zone}) {
    const CircleFit c = fit_circle(points, f);
    ASSERT_TRUE(c.converged);
    EXPECT_NEAR(c.radius_mm, wanted[static_cast<std::size_t>(f)], kExact_mm);
    EXPECT_NEAR(c.zone_mm, 2 * e, kExact_mm);
    EXPECT_NEAR((c.centre_mm - Vec2(3, -7)).norm(), 0, kExact_mm);
  }
}

TEST(Circle, LeastSquaresOfPartOfACircleIsExact) {
  std::vector<Vec2> points;
  for (int i = 0; i <= 10; ++i) points.emplace_back(7 + 2 * std::cos(0.1 * i), -3 + 2 * std::sin(0.1 * i));
  const CircleFit c = fit_circle(points, FeatureFilter::least_squares);
  ASSERT_TRUE(c.converged);
  EXPECT_NEAR(c.radius_mm, 2, kExact_mm);
}

TEST(Circle, CircumscribedOfATriangleIsItsCircumcircleOrItsLongestSide) {
  // Acute 3-4-... : equilateral, R = side / sqrt 3. Obtuse: half of the longest side.
  const std::vector<Vec2> acute{{0, 0}, {2, 0}, {1, std::sqrt(3.0)}}, obtuse{{0, 0}, {4, 0}, {2, 0.5}};
  EXPECT_NEAR(fit_circle(acute, FeatureFilter::min_circumscribed).radius_mm, 2 / std::sqrt(3.0), kExact_mm);
  EXPECT_NEAR(fit_circle(obtuse, FeatureFilter::min_circumscribed).radius_mm, 2, kExact_mm);
}

TEST(Circle, TwoPointsAndPointsInLineDetermineNone) {
  const std::vector<Vec2> two{{0, 0}, {1, 0}}, line{{0, 0}, {1, 1}, {2, 2}, {3, 3}};
  EXPECT_FALSE(fit_circle(two, FeatureFilter::least_squares).converged);
  EXPECT_FALSE(fit_circle(line, FeatureFilter::least_squares).converged);
}

/// No circle near the optimum does better: the goal at random neighbours.
TEST(Circle, ChebyshevFitsOfRandomPointsAreOptimal) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(-0.01, 0.01);
  for (int run = 0; run < 20; ++run) {
    const auto points = ring(25, [&](double) { return 3 + noise(random); });
    const auto range_at = [&](const Vec2& c) {
      double lo = 1e9, hi = 0;
      for (const Vec2& p : points) lo = std::min(lo, (p - c).norm()), hi = std::max(hi, (p - c).norm());
      return std::pair{lo, hi};
    };
    const CircleFit zone = fit_circle(points, FeatureFilter::min_zone),
                    in = fit_circle(points, FeatureFilter::max_inscribed),
                    out = fit_circle(points, FeatureFilter::min_circumscribed);
    for (int k = 0; k < 200; ++k) {
      const double step = std::pow(10, -2 - k % 5);
      const Vec2 off = step * Vec2(noise(random), noise(random)) / 0.01;
      const auto [zl, zh] = range_at(zone.centre_mm + off);
      EXPECT_GE(zh - zl, zone.zone_mm - 1e-10);
      EXPECT_LE(range_at(in.centre_mm + off).first, in.radius_mm + 1e-10);
      EXPECT_GE(range_at(out.centre_mm + off).second, out.radius_mm - 1e-10);
    }
  }
}

TEST(Plane, MinimumZoneOfATwistedSquareIsItsTwist) {
  // z = +-h at the corners of a square, alternating, on a tilted frame: zone 2 h between planes of the frame's normal;
  // least squares is the same plane.
  const double h = 0.004;
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(0.3, Vec3::UnitX()) * Eigen::AngleAxisd(-0.7, Vec3::UnitY())).toRotationMatrix();
  std::vector<Vec3> points;
  for (const double x : {-10.0, 10.0})
    for (const double y : {-10.0, 10.0}) points.push_back(turn * Vec3(x, y, x * y > 0 ? h : -h) + Vec3(5, 6, 7));
  for (const FeatureFilter f : {FeatureFilter::least_squares, FeatureFilter::min_zone}) {
    const PlaneFit plane = fit_plane(points, f);
    ASSERT_TRUE(plane.converged);
    EXPECT_NEAR(plane.zone_mm, 2 * h, kExact_mm);
    EXPECT_NEAR(std::abs(plane.normal.dot(turn.col(2))), 1, 1e-12);
    EXPECT_NEAR(plane.normal.dot(plane.point_mm - Vec3(5, 6, 7)), 0, kExact_mm);
  }
}

TEST(Plane, MinimumZoneOfABumpIsHalfwayBetweenBumpAndFeet) {
  // Four feet at 0 and one point at h in the middle: zone h, plane at h / 2; least squares h / 5.
  const double h = 0.01;
  std::vector<Vec3> points{{-5, -5, 0}, {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}, {0, 0, h}};
  const PlaneFit zone = fit_plane(points, FeatureFilter::min_zone),
                 mean = fit_plane(points, FeatureFilter::least_squares);
  EXPECT_NEAR(zone.zone_mm, h, kExact_mm);
  EXPECT_NEAR(zone.normal.dot(zone.point_mm) / zone.normal.z(), h / 2, kExact_mm);
  EXPECT_NEAR(mean.normal.dot(mean.point_mm) / mean.normal.z(), h / 5, kExact_mm);
}

std::vector<Vec3> tube(const Eigen::Isometry3d& place, int around, int along, double length,
                       const std::function<double(double, double)>& radius) {
  std::vector<Vec3> out;
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const double t = 2 * kPi * i / around, z = length * (along > 1 ? double(j) / (along - 1) : 0.5);
      out.push_back(place * Vec3(radius(t, z) * std::cos(t), radius(t, z) * std::sin(t), z));
    }
  return out;
}

Eigen::Isometry3d somewhere() {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.translate(Vec3(12, -4, 3)).rotate(Eigen::AngleAxisd(0.06, Vec3(1, 2, 0).normalized()));
  return out;
}

TEST(Cylinder, AllFiltersOfAnExactTiltedCylinder) {
  const auto points = tube(somewhere(), 24, 5, 20, [](double, double) { return 6.5; });
  for (const FeatureFilter f : {FeatureFilter::least_squares, FeatureFilter::max_inscribed,
                                FeatureFilter::min_circumscribed, FeatureFilter::min_zone}) {
    const CylinderFit c = fit_cylinder(points, Vec3::UnitZ(), f);
    ASSERT_TRUE(c.converged);
    EXPECT_NEAR(c.radius_mm, 6.5, kExact_mm);
    EXPECT_NEAR(c.zone_mm, 0, kExact_mm);
    EXPECT_NEAR((c.axis - somewhere().linear().col(2)).norm(), 0, 1e-9);
  }
}

TEST(Cylinder, ThreeLobesHaveClosedFormsForEveryFilter) {
  const double radius = 4, e = 0.003;
  const auto points = tube(somewhere(), 36, 7, 15, [&](double t, double) { return radius + e * std::cos(3 * t); });
  const std::array<double, 4> wanted{radius, radius - e, radius + e, radius};
  for (const FeatureFilter f : {FeatureFilter::least_squares, FeatureFilter::max_inscribed,
                                FeatureFilter::min_circumscribed, FeatureFilter::min_zone}) {
    const CylinderFit c = fit_cylinder(points, Vec3::UnitZ(), f);
    ASSERT_TRUE(c.converged);
    EXPECT_NEAR(c.radius_mm, wanted[static_cast<std::size_t>(f)], kExact_mm);
    EXPECT_NEAR(c.zone_mm, 2 * e, kExact_mm);
  }
}

TEST(Cylinder, OneCircleDoesNotDetermineAnAxis) {
  const auto points = tube(Eigen::Isometry3d::Identity(), 24, 1, 0, [](double, double) { return 6.5; });
  EXPECT_FALSE(fit_cylinder(points, Vec3::UnitZ(), FeatureFilter::least_squares).converged);
}

}  // namespace
}  // namespace camber::inspect
