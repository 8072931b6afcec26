#pragma once
// Position on a segment at a time, by the speed law of the segment, whichever it is.
#include <array>

#include "feedmodel/exponential.h"
#include "feedmodel/profile.h"
#include "feedmodel/segment.h"

namespace camber::feedmodel {

/// Time t of a phase that takes `extra_s` longer than the `plain_s` it was planned with -> time of the plan, 0 to
/// plain_s. At both ends the phase runs at its planned speed, in its middle slower; nowhere faster.
double planned_time(double t_s, double plain_s, double extra_s);

struct SegmentMotion {
  enum class Kind { rest, along_path, overlapping, exponential, axes_apart };
  Kind kind = Kind::rest;
  double duration_s = 0;

  // along_path: changes of speed may take longer than constant acceleration has it (jerk filter, bell).
  Trapezoid along;
  double accelerate_extra_s = 0, brake_extra_s = 0;
  double time_scale = 1;  ///< overlapping: of `along`; whole periods of the control make the block longer

  // exponential: the ramp reaches the segment's end after ramp_s; a stop there takes duration_s - ramp_s more.
  ExponentialRamp ramp;
  double ramp_s = 0;

  // axes_apart: from rest to rest.
  std::array<Trapezoid, 3> axes;
  double axes_s = 0;  ///< time of the slowest axis; duration_s also has the delay of a jerk filter

  /// Length along the segment at the time t_s since its start, clamped to its ends; 0 for a rest, and for axes_apart.
  double distance_at(const Segment& segment, double t_s) const;
  /// Place on the segment at the time t_s since its start, clamped to its ends. Without Turn::bend_mm.
  Vec3 point_at(const Segment& segment, double t_s) const;
  /// Does the same with the rotary axes. Requires segment.turn.
  ProgramPose pose_at(const Segment& segment, double t_s) const;
};

SegmentMotion positioning_motion(const Segment& segment, double extra_s);

}  // namespace camber::feedmodel
