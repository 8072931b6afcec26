#pragma once
// Positioning (G0) in which every axis moves on its own: times, and the corners of the dog-leg path.
#include <vector>

#include "base/geometry.h"
#include "machine/machine_model.h"

namespace camber::feedmodel {

/// Top speed of each axis in G0, override taken: the lower of rapid and max_velocity.
Vec3 rapid_speeds_mm_per_s(const machine::Machine& machine);
/// Acceleration of each axis in G0, at most that of the control along the path.
Vec3 rapid_accelerations_mm_per_s2(const machine::Machine& machine);

/// Time of each axis from rest to rest: s/F + F/a where the distance s is at least F^2/a, else 2 sqrt(s/a).
/// Source: Takata 1999, eqs. 2.7, 2.8. distance: with or without sign, mm.
Vec3 axis_times_s(const Vec3& distance_mm, const Vec3& speed_mm_per_s, const Vec3& acceleration_mm_per_s2);

/// The slowest axis' time. Source: Takata 1999, eq. 2.12.
double rapid_time_s(const Vec3& distance_mm, const Vec3& speed_mm_per_s, const Vec3& acceleration_mm_per_s2);

/// True where the slowest axis does not come to its rapid: its distance is shorter than F^2/a. False
/// without a rapid.
bool below_full_rapid(const Vec3& distance_mm, const Vec3& speed_mm_per_s, const Vec3& acceleration_mm_per_s2);

/// The path of a positioning: its start, the places where an axis has arrived while others still move, its end.
/// Because of the accelerations the path between them is curved near the ends. Source: Yan & Shirase 1997 (dog-leg
/// path).
std::vector<Vec3> dog_leg(const Vec3& from_mm, const Vec3& to_mm, const Vec3& speed_mm_per_s,
                          const Vec3& acceleration_mm_per_s2);

/// Returns places of the tool in a positioning, `from_mm` and `to_mm` included, in order, at most `step_mm` apart:
/// along the straight line, or, with rapid_path = "dogleg", where each axis on its own is at the same instant (the bent
/// ends as well). Between axes without a limit, which arrive at once, the way is straight.
std::vector<Vec3> positioning_places(const machine::Machine& machine, const Vec3& from_mm, const Vec3& to_mm,
                                     double step_mm);

}  // namespace camber::feedmodel
