#include "feedmodel/axes.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"

namespace camber::feedmodel {
namespace {

/// e-foldings after which a following error counts as gone: 100 mm/s at Kp 30 leave under 0.1 um.
constexpr double kSettlingFoldings = 12.0;

/// Returns the settling time of an axis without its filter, s.
template <class Axis>
double settling_s(const Axis& axis) {
  const double lag = std::isinf(axis.position_gain_per_s) ? 0.0 : 1.0 / axis.position_gain_per_s + axis.velocity_lag_s;
  return axis.dead_time_s + kSettlingFoldings * (lag + axis.exponential_1_s + axis.exponential_2_s);
}

/// Returns the filter windows of x, y, z, a, b, c, s, as filter_times_s does for three axes.
std::array<double, 6> joint_filter_times_s(const machine::Machine& machine) {
  double jerk_window = 0;
  const auto take = [&](double acceleration, double jerk) {
    if (std::isfinite(jerk) && std::isfinite(acceleration)) jerk_window = std::max(jerk_window, acceleration / jerk);
  };
  for (const machine::Axis& axis : machine.axis) take(axis.acceleration_mm_per_s2, axis.jerk_mm_per_s3);
  for (const machine::RotaryAxis& axis : machine.rotary) take(axis.acceleration_rad_per_s2, axis.jerk_rad_per_s3);
  std::array<double, 6> times{};
  for (std::size_t i = 0; i < 3; ++i) {
    times[i] = std::max(machine.axis[i].filter_s, jerk_window);
    times[3 + i] = std::max(machine.rotary[i].filter_s, jerk_window);
  }
  return times;
}

}  // namespace

Vec3 filter_times_s(const machine::Machine& machine) {
  double jerk_window = 0;
  for (const machine::Axis& axis : machine.axis) {
    if (std::isfinite(axis.jerk_mm_per_s3) && std::isfinite(axis.acceleration_mm_per_s2))
      jerk_window = std::max(jerk_window, axis.acceleration_mm_per_s2 / axis.jerk_mm_per_s3);
  }
  Vec3 times;
  for (int i = 0; i < 3; ++i) times[i] = std::max(machine.axis[i].filter_s, jerk_window);
  return times;
}

double settling_time_s(const machine::Machine& machine) {
  const Vec3 filters = filter_times_s(machine);
  double max_s = 0;
  for (int i = 0; i < 3; ++i) {
    max_s = std::max(max_s, filters[i] + settling_s(machine.axis[i]));
  }
  return max_s;
}

Axes::Axes(const machine::Machine& machine, const Vec3& start_mm) {
  const Vec3 filters = filter_times_s(machine);
  for (int i = 0; i < 3; ++i)
    axes_[i].emplace(drive_options(machine.axis[i], filters[i], machine.control.period_s), start_mm[i]);
}

Vec3 Axes::operator()(const Vec3& command_mm) {
  Vec3 position;
  for (int i = 0; i < 3; ++i) position[i] = (*axes_[i])(command_mm[i]);
  return position;
}

Vec3 Axes::velocity_mm_per_s() const {
  Vec3 velocity;
  for (int i = 0; i < 3; ++i) velocity[i] = axes_[i]->velocity_per_s();
  return velocity;
}

JointAxes::JointAxes(const machine::Machine& machine, const kinematics::Joints& start) {
  const double period_s = machine.control.period_s;
  const std::array<double, 6> filters = joint_filter_times_s(machine);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    drives_[i].emplace(drive_options(machine.axis[i], filters[i], period_s), start.linear_mm[index]);
    drives_[3 + i].emplace(drive_options(machine.rotary[i], filters[3 + i], period_s), start.rotary_rad[index]);
  }
}

kinematics::Joints JointAxes::operator()(const kinematics::Joints& command) {
  kinematics::Joints position;
  for (int i = 0; i < 3; ++i) {
    position.linear_mm[i] = (*drives_[i])(command.linear_mm[i]);
    position.rotary_rad[i] = (*drives_[3 + i])(command.rotary_rad[i]);
  }
  return position;
}

kinematics::Joints JointAxes::velocity_per_s() const {
  kinematics::Joints velocity;
  for (int i = 0; i < 3; ++i) {
    velocity.linear_mm[i] = drives_[i]->velocity_per_s();
    velocity.rotary_rad[i] = drives_[3 + i]->velocity_per_s();
  }
  return velocity;
}

double joint_settling_time_s(const machine::Machine& machine) {
  const std::array<double, 6> filters = joint_filter_times_s(machine);
  double max_s = settling_time_s(machine);
  for (std::size_t i = 0; i < 3; ++i)
    max_s = std::max({max_s, filters[i] + settling_s(machine.axis[i]), filters[3 + i] + settling_s(machine.rotary[i])});
  return max_s;
}

namespace {

constexpr double kShortestPeriodS = 1e-4;  // of this simulation alone

/// Drives of which the command is that of a motion: X, Y and Z alone.
class LinearFollower {
 public:
  LinearFollower(const machine::Machine& machine, const Segment& segment, const SegmentMotion& motion, double from_s)
      : segment_(segment), motion_(motion), axes_(machine, motion.point_at(segment, from_s)) {}
  void step(double t_s) {
    off_mm_ = axes_(motion_.point_at(segment_, t_s)) - motion_.point_at(segment_, motion_.duration_s);
  }
  double off() const { return off_mm_.cwiseAbs().maxCoeff(); }

 private:
  const Segment& segment_;
  const SegmentMotion& motion_;
  Axes axes_;
  Vec3 off_mm_ = Vec3::Zero();
};

/// Includes the rotary axes, whose width is the same number of degrees.
class JointFollower {
 public:
  JointFollower(const machine::Machine& machine, const Segment& segment, const SegmentMotion& motion, double from_s,
                const kinematics::JointMap& map)
      : segment_(segment), motion_(motion), map_(map), end_(at(motion.duration_s)), axes_(machine, at(from_s)) {}
  void step(double t_s) { now_ = axes_(at(t_s)); }
  double off() const {
    return std::max((now_.linear_mm - end_.linear_mm).cwiseAbs().maxCoeff(),
                    deg_from_rad((now_.rotary_rad - end_.rotary_rad).cwiseAbs().maxCoeff()));
  }

 private:
  kinematics::Joints at(double t_s) const { return joints_of(map_, motion_.pose_at(segment_, t_s), *segment_.turn); }

  const Segment& segment_;
  const SegmentMotion& motion_;
  const kinematics::JointMap& map_;
  kinematics::Joints end_, now_;
  JointAxes axes_;
};

/// Follows from `from_s` to the end of the motion, and on until the axis is within the width.
template <class Follower>
double wait_of(Follower follower, double from_s, double end_s, double period_s, double width, double max_s) {
  const auto steps = static_cast<long>(std::ceil((end_s - from_s) / period_s));
  for (long k = steps - 1; k > 0; --k) follower.step(end_s - static_cast<double>(k) * period_s);
  follower.step(end_s);
  double wait_s = 0;
  for (; follower.off() > width && wait_s < max_s; wait_s += period_s) follower.step(end_s);
  return wait_s;
}

}  // namespace

double in_position_wait_s(const machine::Machine& machine, const Segment& segment, const SegmentMotion& motion,
                          const kinematics::JointMap* map) {
  const double width_mm = machine.control.in_position_mm;
  if (std::isinf(width_mm)) return 0;
  machine::Machine m = machine;
  m.control.period_s = std::max(machine.control.period_s, kShortestPeriodS);
  const double period_s = m.control.period_s, end_s = motion.duration_s;
  const double max_s = map ? joint_settling_time_s(m) : settling_time_s(m);
  if (max_s == 0) return 0;
  const double from_s = std::max(0.0, end_s - max_s);
  return map ? wait_of(JointFollower(m, segment, motion, from_s, *map), from_s, end_s, period_s, width_mm, max_s)
             : wait_of(LinearFollower(m, segment, motion, from_s), from_s, end_s, period_s, width_mm, max_s);
}

}  // namespace camber::feedmodel
