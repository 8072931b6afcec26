#pragma once
// Limits of a block by its axes: maximum speed and acceleration along a direction, in a plane, on an arc.
#include "base/geometry.h"
#include "machine/machine.h"

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

}  // namespace camber::feedmodel
