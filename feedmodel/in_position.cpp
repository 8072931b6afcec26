#include "feedmodel/in_position.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "feedmodel/axes.h"

namespace camber::feedmodel {
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
