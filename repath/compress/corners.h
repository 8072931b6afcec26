#pragma once
// Which vertices of a path are corners: where no curve, arc or smoothing runs over.
#include <limits>
#include <span>
#include <vector>

#include "base/geometry.h"

namespace camber::repath {

/// A vertex is a corner where the path turns by more than `min_turn_rad` and more than `times_beside` as much as beside
/// it (a coarse circle turns everywhere alike), or by more than `always_rad`. Turns are measured between legs of at
/// least `leg_mm`, or to the path's ends.
struct CornerRule {
  double min_turn_rad = 0, times_beside = 2;
  double always_rad = std::numeric_limits<double>::infinity();
  double leg_mm = 0;
};

/// One value a vertex, true for corners; the first and the last are none. Time grows linearly with their number.
std::vector<bool> corners_of(std::span<const Vec3> points, const CornerRule& rule);

/// How much the path turns at each vertex, rad, between legs of at least `leg_mm`; zero at its ends.
std::vector<double> turns_of(std::span<const Vec3> points, double leg_mm);

}  // namespace camber::repath
