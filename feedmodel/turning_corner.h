#pragma once
// Corner laws between blocks of which at least one turns rotary axes or moves joints that are not its X Y Z.
#include "feedmodel/joint_limits.h"
#include "feedmodel/segment.h"

namespace camber::feedmodel {

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
