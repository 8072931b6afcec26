#include "feedmodel/rapid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "feedmodel/profile.h"

namespace camber::feedmodel {
namespace {

Trapezoid axis_profile(double distance_mm, double speed, double acceleration) {
  return make_trapezoid(std::abs(distance_mm), 0, 0, speed, acceleration);
}

}  // namespace

Vec3 rapid_speeds_mm_per_s(const machine::Machine& machine) {
  Vec3 out;
  for (int i = 0; i < 3; ++i)
    out[i] = std::min(machine.axis[i].rapid_mm_per_s, machine.axis[i].max_velocity_mm_per_s) *
             machine.cycle.rapid_override_percent / 100.0;
  return out;
}

Vec3 rapid_accelerations_mm_per_s2(const machine::Machine& machine) {
  Vec3 out;
  for (int i = 0; i < 3; ++i) {
    const machine::Axis& axis = machine.axis[i];
    out[i] = std::min(
        std::isinf(axis.rapid_acceleration_mm_per_s2) ? axis.acceleration_mm_per_s2 : axis.rapid_acceleration_mm_per_s2,
        machine.control.path_acceleration_mm_per_s2);
  }
  return out;
}

Vec3 axis_times_s(const Vec3& distance_mm, const Vec3& speed_mm_per_s, const Vec3& acceleration_mm_per_s2) {
  Vec3 out;
  for (int i = 0; i < 3; ++i)
    out[i] = axis_profile(distance_mm[i], speed_mm_per_s[i], acceleration_mm_per_s2[i]).duration_s();
  return out;
}

double rapid_time_s(const Vec3& distance_mm, const Vec3& speed_mm_per_s, const Vec3& acceleration_mm_per_s2) {
  return axis_times_s(distance_mm, speed_mm_per_s, acceleration_mm_per_s2).maxCoeff();
}

bool below_full_rapid(const Vec3& distance_mm, const Vec3& speed_mm_per_s, const Vec3& acceleration_mm_per_s2) {
  Eigen::Index slowest = 0;
  axis_times_s(distance_mm, speed_mm_per_s, acceleration_mm_per_s2).maxCoeff(&slowest);
  const double full = speed_mm_per_s[slowest] * speed_mm_per_s[slowest] / acceleration_mm_per_s2[slowest];
  return std::isfinite(full) && std::abs(distance_mm[slowest]) < full;
}

std::vector<Vec3> dog_leg(const Vec3& from_mm, const Vec3& to_mm, const Vec3& speed_mm_per_s,
                          const Vec3& acceleration_mm_per_s2) {
  const Vec3 way = to_mm - from_mm;
  std::array<Trapezoid, 3> axes;
  std::array<double, 3> arrivals{};
  for (int i = 0; i < 3; ++i) {
    axes[i] = axis_profile(way[i], speed_mm_per_s[i], acceleration_mm_per_s2[i]);
    arrivals[i] = axes[i].duration_s();
  }
  std::sort(arrivals.begin(), arrivals.end());
  std::vector<Vec3> path{from_mm};
  double last_s = 0;
  for (const double t : arrivals) {
    if (t <= last_s + 1e-12) continue;
    Vec3 point;
    for (int i = 0; i < 3; ++i) point[i] = from_mm[i] + std::copysign(axes[i].distance_at(t), way[i]);
    path.push_back(point);
    last_s = t;
  }
  if (path.size() > 1) path.back() = to_mm;
  return path;
}

}  // namespace camber::feedmodel
