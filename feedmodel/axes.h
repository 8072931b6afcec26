#pragma once
// Turns commanded axis positions into actual ones, period by period: filter, exponential lags, position loop.
#include <array>
#include <optional>

#include "base/geometry.h"
#include "feedmodel/drive.h"
#include "feedmodel/segment_motion.h"
#include "kinematics/joint_map.h"
#include "kinematics/joints.h"
#include "machine/machine_model.h"

namespace camber::feedmodel {

/// Seconds of the moving average of every axis: its own filter, or what turns its acceleration into one with
/// the given jerk (acceleration / jerk), whichever is longer. Jerk windows are those of the slowest axis for
/// all three, so that they do not distort the path.
Vec3 filter_times_s(const machine::Machine& machine);

/// Upper bound of the settling time of the axes after the command stops; 0: no lag.
double settling_time_s(const machine::Machine& machine);

class Axes {
 public:
  Axes(const machine::Machine& machine, const Vec3& start_mm);

  /// Advances by one period: takes the command at its end, returns the actual position at its end.
  Vec3 operator()(const Vec3& command_mm);
  Vec3 velocity_mm_per_s() const;

 private:
  std::array<std::optional<Drive>, 3> axes_;
};

/// All axes of a machine with rotary ones. The jerk limit of any axis is a filter window for all.
class JointAxes {
 public:
  JointAxes(const machine::Machine& machine, const kinematics::Joints& start);

  kinematics::Joints operator()(const kinematics::Joints& command);
  /// mm/s and rad/s.
  kinematics::Joints velocity_per_s() const;

 private:
  std::array<std::optional<Drive>, 6> drives_;
};

/// Returns settling_time_s with the rotary axes.
double joint_settling_time_s(const machine::Machine& machine);

/// Time from the end of a segment's command until every axis is within control.in_position_mm of it, a multiple of the
/// control's period: the axes are driven along the end of the segment, from at most twelve of their time constants
/// before it. With `map`, of a program with rotary motion, the joints, of which rotary ones have the same number of
/// degrees. 0 where the control does not wait or the axes have no lag.
double in_position_wait_s(const machine::Machine& machine, const Segment& segment, const SegmentMotion& motion,
                          const kinematics::JointMap* map = nullptr);

}  // namespace camber::feedmodel
