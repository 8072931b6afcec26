#pragma once
// Limits of a path from its joints: no joint may be faster, or accelerated more, than its axis allows.
#include <functional>

#include "feedmodel/segment.h"
#include "kinematics/joint_map.h"
#include "machine/machine.h"

namespace camber::feedmodel {

/// A value of each axis: x, y, z (mm) and a, b, c (rad).
struct AxisValues {
  Vec3 linear = Vec3::Zero(), rotary = Vec3::Zero();
};

struct JointLimits {
  AxisValues speed, acceleration;
};

JointLimits feed_limits(const machine::Machine& machine);
JointLimits rapid_limits(const machine::Machine& machine);

/// min_i limit_i / |rate_i|; infinite where no axis with a limit moves. `rate`: of the joints, per unit of path.
double limit_along_joints(const AxisValues& rate, const AxisValues& limits);

/// dq/ds at the length s, by central difference.
AxisValues joint_rates(const Segment& segment, double s, const kinematics::JointMap& map);

/// Hands the segment out in pieces, each with the limits of the joints in it:
///     |q_i'| v <= V_i,        |q_i''| v^2 <= kTurningFraction A_i,        |q_i'| a <= A_i - |q_i''| v^2,
/// v the limit of the piece, the segment's own included. A piece turns by at most a degree. Requires segment.turn.
void hand_out_within_limits(const Segment& segment, const kinematics::JointMap& map, const JointLimits& limits,
                            const std::function<void(const Segment&)>& sink);

}  // namespace camber::feedmodel
