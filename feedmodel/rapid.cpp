#include "feedmodel/rapid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "feedmodel/segment_motion.h"

namespace camber::feedmodel {
namespace {

Trapezoid axis_profile(double distance_mm, double speed, double acceleration) {
  return make_trapezoid(std::abs(distance_mm), 0, 0, speed, acceleration);
}

constexpr double kInstant = 1e-9;  // s; axes that move by more in this time jump

/// The three axes of one positioning.
class AxesApart {
 public:
  AxesApart(const Vec3& from_mm, const Vec3& to_mm, const Vec3& speed, const Vec3& acceleration)
      : from_mm_(from_mm), way_mm_(to_mm - from_mm) {
    for (int i = 0; i < 3; ++i) {
      axes_[i] = axis_profile(way_mm_[i], speed[i], acceleration[i]);
      duration_s_ = std::max(duration_s_, axes_[i].duration_s());
    }
  }
  double duration_s() const { return duration_s_; }
  Vec3 at(double t_s) const {
    Vec3 place = from_mm_;
    for (int i = 0; i < 3; ++i) place[i] += std::copysign(axes_[i].distance_at(t_s), way_mm_[i]);
    return place;
  }

 private:
  Vec3 from_mm_, way_mm_;
  std::array<Trapezoid, 3> axes_;
  double duration_s_ = 0;
};

void append_line(std::vector<Vec3>& places, const Vec3& to_mm, double step_mm) {
  const Vec3 from_mm = places.back();
  const int n = std::max(1, static_cast<int>(std::ceil((to_mm - from_mm).norm() / step_mm)));
  for (int i = 1; i <= n; ++i) places.push_back(i == n ? to_mm : Vec3(from_mm + (to_mm - from_mm) * i / n));
}

/// Every axis runs one way only: between two places that are near each other lies nothing further away.
void append_motion(std::vector<Vec3>& places, const AxesApart& axes, double from_s, double to_s, const Vec3& to_mm,
                   double step_mm) {
  const bool near = (to_mm - places.back()).norm() <= step_mm;
  if (near || to_s - from_s < kInstant) return append_line(places, to_mm, step_mm);
  const double middle_s = (from_s + to_s) / 2;
  append_motion(places, axes, from_s, middle_s, axes.at(middle_s), step_mm);
  append_motion(places, axes, middle_s, to_s, to_mm, step_mm);
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

std::vector<Vec3> positioning_places(const machine::Machine& machine, const Vec3& from_mm, const Vec3& to_mm,
                                     double step_mm) {
  std::vector<Vec3> places{from_mm};
  if (machine.cycle.rapid_path == machine::RapidPath::linear) {
    append_line(places, to_mm, step_mm);
    return places;
  }
  const AxesApart axes(from_mm, to_mm, rapid_speeds_mm_per_s(machine), rapid_accelerations_mm_per_s2(machine));
  append_motion(places, axes, 0, axes.duration_s(), to_mm, step_mm);
  return places;
}

}  // namespace camber::feedmodel
