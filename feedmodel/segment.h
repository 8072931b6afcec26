#pragma once
// One piece of the path that the control commands: a straight line or a circular arc (helix), with its limits.
#include <cstdint>

#include "base/geometry.h"

namespace camber::feedmodel {

struct Segment {
  Vec3 start_mm = Vec3::Zero();
  Vec3 along = Vec3::UnitX();  ///< line: unit direction; arc: unit vector from the centre to the start
  Vec3 across = Vec3::Zero();  ///< arc: unit tangent at the start, within the plane of the turn
  Vec3 rise = Vec3::Zero();    ///< arc: mm along the normal for each mm of path (helix)
  double radius_mm = 0;        ///< 0: a line
  double turn_rad_per_mm = 0;  ///< arc: angle turned for each mm of path
  double length_mm = 0;

  double speed_limit_mm_per_s = 0;
  double acceleration_mm_per_s2 = 0;  ///< along the path
  double planned_fraction = 1;        ///< of the acceleration, that the look-ahead counts on
  double entry_limit_mm_per_s = 0;    ///< at its start: what the corner before it allows
  double feed_command_mm_per_s = 0;   ///< programmed (rapid: top speed of the axes along it)
  double dwell_s = 0;                 ///< a rest instead of a motion: length 0, speed limit 0
  std::uint32_t move = 0;             ///< last of the moves that were merged in it
  bool cutting = false;
  bool joined = false;  ///< planned as one with the rounding that follows

  Vec3 point_at(double s_mm) const;
  Vec3 direction_at(double s_mm) const;  ///< unit
};

/// A straight line; length 0 for equal points.
Segment line_segment(const Vec3& from_mm, const Vec3& to_mm);

/// An arc that leaves `from_mm` and turns by sweep_rad about `normal` through `center_mm`; `rise_mm` along the
/// normal over the whole sweep.
Segment arc_segment(const Vec3& from_mm, const Vec3& center_mm, const Vec3& normal, double sweep_rad, double rise_mm);

/// The part of a segment between two lengths along it; the limits stay.
Segment part_of(const Segment& segment, double from_s_mm, double to_s_mm);

}  // namespace camber::feedmodel
