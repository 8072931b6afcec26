#pragma once
// Lines and circles in a plane, and their intersections.
#include <cmath>
#include <vector>

#include "base/geometry.h"

namespace camber::nc {

inline Vec2 left_of(const Vec2& direction) { return {-direction.y(), direction.x()}; }
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }
/// Counter-clockwise from a to b, -pi .. pi.
inline double angle_between(const Vec2& a, const Vec2& b) { return std::atan2(cross(a, b), a.dot(b)); }
/// Returns the angle from a to b in the sense (1: counter-clockwise, -1), 0 .. 2 pi; just short of a full turn counts
/// as just behind.
double turn_from(const Vec2& a, const Vec2& b, double sense);

/// A line, or a circle.
struct PlaneCurve {
  bool circle = false;
  Vec2 point = Vec2::Zero();      ///< point on a line
  Vec2 direction = Vec2::Zero();  ///< unit direction of a line
  Vec2 centre = Vec2::Zero();     ///< centre of a circle
  double radius = 0;              ///< radius of a circle
};

/// Returns where two curves meet; empty where they do not. Lines that are parallel give a point that is not finite.
std::vector<Vec2> meetings(const PlaneCurve& a, const PlaneCurve& b);

}  // namespace camber::nc
