#pragma once
// Position on a segment at a time, by the speed law of the segment, whichever it is.
#include <array>

#include "feedmodel/segment.h"

namespace camber::feedmodel {

/// Accelerate, cruise, brake. Speeds in mm/s, lengths in mm.
struct Trapezoid {
  double entry = 0, peak = 0, exit = 0;
  double acceleration = 0;  ///< infinite: the speed jumps
  double accelerate_s = 0, cruise_s = 0, brake_s = 0;
  double length = 0;

  double duration_s() const { return accelerate_s + cruise_s + brake_s; }
  /// Length covered after the time t, clamped to [0, length].
  double distance_at(double t_s) const;
  double speed_at(double t_s) const;
};

/// The fastest profile over `length`: v_peak = min(limit, sqrt((v0^2 + v1^2)/2 + a L)).
/// Source: Yan & Shirase 1997, eqs. 6-11; Takata 1999, eqs. 2.7-2.8.
/// entry and exit must be reachable from each other (the lookahead sees to it; rounding is forgiven) and not
/// above the limit.
Trapezoid make_trapezoid(double length_mm, double entry_mm_per_s, double exit_mm_per_s, double limit_mm_per_s,
                         double acceleration_mm_per_s2);

/// f(t) = F + (f_s - F)/(T1 - T2) (T1 e^(-t/T1) - T2 e^(-t/T2)); the limit where T1 = T2. Times in s, >= 0.
/// Source: Yan & Shirase 1997, eq. 2.
struct ExponentialRamp {
  double start_mm_per_s = 0;    ///< f_s
  double command_mm_per_s = 0;  ///< F
  double t1_s = 0, t2_s = 0;    ///< 0: no lag

  double speed_at(double t_s) const;
  /// d(t) = F (t - T1 - T2) + f_s (T1 + T2) + (F - f_s)/(T1 - T2) (T1^2 e^(-t/T1) - T2^2 e^(-t/T2))
  /// Source: Yan & Shirase 1997, eq. 3 as corrected (docs/errata.md).
  double distance_at(double t_s) const;
  /// The time at which the distance is covered, exact to 1e-12 s. Infinite where it is never covered (F = 0).
  double time_of(double distance_mm) const;
  /// Returns the same by the printed model, once the lags have died out: d/F + (1 - f_s/F)(T1 + T2).
  double approximate_time_of(double distance_mm) const;
};

/// Returns the time from rest to rest: the ramp's time and T1 + T2 for the stop, d/F + 2 (T1 + T2) on a long block.
/// Source: Yan & Shirase 1997, eqs. 4-5.
double exponential_rest_to_rest_s(double distance_mm, double feed_mm_per_s, double t1_s, double t2_s);

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
