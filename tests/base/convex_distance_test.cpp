#include "base/convex_distance.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace camber {
namespace {

class Points : public ConvexSolid {
 public:
  explicit Points(std::vector<Vec3> points) : points_(std::move(points)) {}
  Vec3 support(const Vec3& direction) const override {
    Vec3 best = points_.front();
    for (const Vec3& p : points_)
      if (p.dot(direction) > best.dot(direction)) best = p;
    return best;
  }

 private:
  std::vector<Vec3> points_;
};

class Ball : public ConvexSolid {
 public:
  Ball(const Vec3& centre, double radius) : centre_(centre), radius_(radius) {}
  Vec3 support(const Vec3& direction) const override { return centre_ + radius_ * direction.normalized(); }

 private:
  Vec3 centre_;
  double radius_;
};

Points box(const Vec3& half, const Eigen::Isometry3d& motion) {
  std::vector<Vec3> out(8, half);
  for (unsigned c = 0; c < 8; ++c) {
    for (unsigned axis = 0; axis < 3; ++axis)
      if ((c >> axis & 1U) == 0) out[c][axis] *= -1;
    out[c] = motion * out[c];
  }
  return Points(out);
}

Eigen::Isometry3d random_motion(std::mt19937& random, double far_mm) {
  std::normal_distribution<double> normal;
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                     .normalized()
                     .toRotationMatrix();
  out.translation() = far_mm * Vec3(normal(random), normal(random), normal(random));
  return out;
}

/// At most the true distance, and less by no more than the header says.
void expect_distance(double found, double exact) {
  constexpr double kRounding_mm = 1e-9;
  EXPECT_LE(found, exact + kRounding_mm);
  EXPECT_GE(found, exact - std::max(1e-4, 1e-3 * exact) - kRounding_mm);
}

TEST(ConvexDistance, OfBallsAndBoxesIsThatOfTheClosedForm) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> size(0.01, 300);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 half(size(random), size(random), size(random));
    const Eigen::Isometry3d motion = random_motion(random, 200);
    const Vec3 centre = random_motion(random, 200).translation();
    const double radius = size(random);
    const Vec3 local = motion.inverse() * centre;
    const double apart = (local - local.cwiseMax(-half).cwiseMin(half)).norm() - radius;
    expect_distance(convex_distance(box(half, motion), Ball(centre, radius)), std::max(0.0, apart));
  }
}

TEST(ConvexDistance, OfParallelBoxesThatAreATenthApartOrDeepIsExact) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> size(0.5, 500), across(-0.9, 0.9);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 a(size(random), size(random), size(random)), b(size(random), size(random), size(random));
    const double gap = i % 2 == 0 ? 0.1 : -0.1;
    const Eigen::Isometry3d motion = random_motion(random, 300);
    const Vec3 way(across(random) * (a.x() + b.x()), across(random) * (a.y() + b.y()), a.z() + b.z() + gap);
    expect_distance(convex_distance(box(a, motion), box(b, motion * Eigen::Translation3d(way))), std::max(0.0, gap));
  }
}

TEST(ConvexDistance, NearerThanALimitIsThatOfTheDistanceFromAnyFirstDirection) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> size(0.5, 100), around(0.5, 1.5), one(-1, 1);
  int nearer = 0, farther = 0;
  for (int i = 0; i < 5000; ++i) {
    const Points a = box(Vec3(size(random), size(random), size(random)), random_motion(random, 150));
    const Points b = box(Vec3(size(random), size(random), size(random)), random_motion(random, 150));
    const double distance = convex_distance(a, b), limit = std::max(0.01, distance * around(random));
    if (std::abs(limit - distance) < 2e-3 * distance) continue;
    const Vec3 guess(one(random), one(random), one(random));
    EXPECT_EQ(convex_nearer(a, b, limit, guess), distance < limit) << distance << " " << limit;
    (distance < limit ? nearer : farther)++;
  }
  EXPECT_GT(nearer, 1000);
  EXPECT_GT(farther, 1000);
}

TEST(ConvexDistance, ThinTriangleInABigBoxOverlaps) {
  const Points triangle({{0, 0, 0}, {0.01, 0, 0}, {0, 500, 0.01}});
  EXPECT_EQ(convex_distance(triangle, box(Vec3::Constant(1000), Eigen::Isometry3d::Identity())), 0);
}

}  // namespace
}  // namespace camber
