#include "feedmodel/limits.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace camber::feedmodel {
namespace {

[[maybe_unused]] constexpr double kUnitVector = 1e-6;  ///< rounding of its squared length

}  // namespace

double limit_along(const Vec3& direction, const Vec3& limits) {
  assert(direction.squaredNorm() <= 1 + kUnitVector && (limits.array() > 0).all());
  double slowest = 0;
  for (int i = 0; i < 3; ++i) slowest = std::max(slowest, std::abs(direction[i]) / limits[i]);
  return slowest > 0 ? 1.0 / slowest : machine::kNoLimit;
}

double limit_in_plane(const Vec3& normal, const Vec3& limits) {
  assert(std::abs(normal.squaredNorm() - 1) <= kUnitVector && (limits.array() > 0).all());
  double least = machine::kNoLimit;
  for (int i = 0; i < 3; ++i) {
    const double in_plane = std::sqrt(std::max(0.0, 1.0 - normal[i] * normal[i]));
    if (in_plane > 1e-6) least = std::min(least, limits[i] / in_plane);
  }
  return least;
}

Vec3 velocity_limits_mm_per_s(const machine::Machine& m) {
  Vec3 limits;
  for (int i = 0; i < 3; ++i) limits[i] = std::min(m.axis[i].max_velocity_mm_per_s, m.axis[i].max_feed_mm_per_s);
  return limits;
}

Vec3 acceleration_limits_mm_per_s2(const machine::Machine& m) {
  return {m.axis[0].acceleration_mm_per_s2, m.axis[1].acceleration_mm_per_s2, m.axis[2].acceleration_mm_per_s2};
}

double block_time_speed(double length_mm, double block_time_s) {
  return block_time_s > 0 ? length_mm / block_time_s : machine::kNoLimit;
}

double arc_speed(double radius_mm, double acceleration_mm_per_s2, double normal_fraction) {
  return std::sqrt(normal_fraction * acceleration_mm_per_s2 * radius_mm);
}

double arc_servo_speed(double radius_mm, double radius_error_mm, double gain_per_s, double feed_forward_percent,
                       double m) {
  const double kf = feed_forward_percent / 100.0;
  const double left = 1.0 - kf * kf;
  if (left <= 0 || std::isinf(gain_per_s)) return machine::kNoLimit;
  return gain_per_s * std::sqrt(m * radius_mm * radius_error_mm / left);
}

double helix_curvature_radius(double radius_mm, double rise_per_rad_mm) {
  const double slope = rise_per_rad_mm / radius_mm;
  return radius_mm * (1.0 + slope * slope);
}

}  // namespace camber::feedmodel
