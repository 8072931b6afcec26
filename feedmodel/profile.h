#pragma once
// Speed over time along one segment with constant acceleration: a trapezoid or a triangle.

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

}  // namespace camber::feedmodel
