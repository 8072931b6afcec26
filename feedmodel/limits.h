#pragma once
// Limits of a block by its axes: maximum speed and acceleration along a direction, in a plane, on an arc; those of a
// path by its joints, and its corners.
#include <functional>

#include "base/geometry.h"
#include "feedmodel/segment.h"
#include "kinematics/joint_map.h"
#include "machine/machine_model.h"

namespace camber::feedmodel {

/// Largest of |direction_i| / limit_i: the time an axis needs for its fraction of 1 mm (or of 1 mm/s). The limit
/// along the direction is its reciprocal; infinite when no axis that moves has a limit.
/// direction: unit vector, or the part of one that the limits are for; limits > 0, infinity allowed.
double limit_along(const Vec3& direction, const Vec3& limits);

/// Largest magnitude that every direction of a plane allows: min_i limit_i / sqrt(1 - n_i^2), n the plane's unit
/// normal; axes that are square to the plane do not count. limits > 0, infinity allowed.
double limit_in_plane(const Vec3& normal, const Vec3& limits);

/// Limits of feed moves.
Vec3 velocity_limits_mm_per_s(const machine::Machine& machine);
Vec3 acceleration_limits_mm_per_s2(const machine::Machine& machine);

/// Block processing time: V <= L_b / T_b (mm/s, mm, s); infinite when T_b is zero.
/// Source: KAKEN report, V = 60000 L_b / T_b in mm/min, mm, ms.
double block_time_speed(double length_mm, double block_time_s);

/// Centripetal limit on an arc, v <= sqrt(share a r).          [mm/s] = sqrt([mm/s^2][mm])
/// Source: Yan & Shirase 1997, eq. 15 (share 1).
double arc_speed(double radius_mm, double acceleration_mm_per_s2, double normal_fraction);

/// Speed at which the position loops make a circle's radius wrong by `radius_error_mm`:
/// v <= sqrt(m Kp^2 r dr / (1 - (Kf/100)^2)).   m: 8 or 2, by the kind of position loop.
/// Source: Takata 1999, eq. 2.10 as corrected (docs/errata.md). Infinite at Kf = 100 or an infinite gain.
double arc_servo_speed(double radius_mm, double radius_error_mm, double gain_per_s, double feed_forward_percent,
                       double m);

/// Radius of curvature of a helix that rises `rise_per_rad_mm` while it turns: r (1 + (b/r)^2).
double helix_curvature_radius(double radius_mm, double rise_per_rad_mm);

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

struct CornerRoom {
  double tolerance_mm = 0;  ///< largest distance between the rounded path and the corner in X Y Z; infinite: none
  double room = 0;          ///< most that may be cut off each side
};

/// Length that a rounding takes off each side. A parabola in X Y Z and in the angles alike that touches both sides d
/// away from the corner passes it at d |u2 - u1| / 4, u1 and u2 the directions in X Y Z. Where they agree only the room
/// counts.
double corner_trim(const Segment& from, const Segment& to, const CornerRoom& room);

/// That parabola: begins at from_end_s on `from`, ends `trim` after the start of `to`. Its limits are those of `from`;
/// at a constant speed along it every program coordinate has a constant acceleration.
Segment rounded_corner(const Segment& from, double from_end_s, const Segment& to, double trim);

/// Speed at which no joint's speed steps by more than `permitted`: min_i permitted_i / |q2_i' - q1_i'|.
double joint_step_speed(const AxisValues& from, const AxisValues& to, const AxisValues& permitted);

}  // namespace camber::feedmodel
