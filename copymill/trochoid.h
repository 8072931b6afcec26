#pragma once
// Trochoidal milling: circles that advance by a step, so that a slot is cut without a full cut.
#include <vector>

#include "base/geometry.h"
#include "copymill/path_piece.h"

namespace camber::copymill {

/// Returns the angle of the cutter's circumference in the cut at a radial depth on a straight wall: acos(1 - a_e / R);
/// pi from 2 R on.
double engagement_angle_rad(double cutter_radius_mm, double radial_depth_mm);

/// A circle that the cutter's axis runs.
struct Circle {
  Vec2 centre = Vec2::Zero();
  double radius_mm = 0;
};

/// The greatest engagement angle of a cutter, radius R, whose axis runs around `next` after it has run around `before`
/// (radius r0) and all within it. With the axis at c, e the unit vector from the circle's centre to it, and q = c -
/// before.centre, the circumference is in material where |q + R u| > R + r0, u a unit vector:
///
///   cos(angle of u and q) > ((R + r0)^2 - |q|^2 - R^2) / (2 R |q|),
///
/// and on the side of e to which the cutter moves, since the circle itself has just cut the other side. The greatest
/// angle over the circle is found in steps of a degree and then by golden section. It is the same in either sense. The
/// radial depth, measured across the circle, is next.radius + |next.centre - before.centre| - r0 at most; since the
/// wall that it cuts is hollow, the angle is greater than that depth takes on a straight one.
double greatest_engagement_rad(double cutter_radius_mm, const Circle& before, const Circle& next);

/// The line to a larger circle goes outwards by so much; on its way no more than this comes to the engagement angle.
double outward_rad(const Circle& before, const Circle& next);

/// The greatest advance from circle to circle of one radius whose engagement stays within a limit (below half a turn).
double trochoid_step_mm(double cutter_radius_mm, double circle_radius_mm, double limit_rad);

/// Circle after circle, each once around, joined by lines: counter-clockwise with the line on the right of the way from
/// centre to centre, clockwise with it on the left; either way it leaves and meets the circles in their own direction.
/// The path lies at one height and begins on the first circle, at start_of().
std::vector<PathPiece> trochoid(const std::vector<Circle>& circles, double z_mm, bool counter_clockwise,
                                double increment_mm);
/// Returns where the line to the second circle leaves the first one.
Vec2 start_of(const std::vector<Circle>& circles, bool counter_clockwise);

}  // namespace camber::copymill
