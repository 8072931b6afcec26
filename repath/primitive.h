#pragma once
// A line or an arc that replaces a stretch of a polyline, and its deviation.
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "base/geometry.h"

namespace camber::repath {

/// From points[first] to points[last]. Both ends are points of the polyline.
struct Primitive {
  std::uint32_t first = 0, last = 0;
  bool arc = false;
  Vec2 center_from_start_mm = Vec2::Zero();  ///< as the program will say it: a whole number of increments
  double sweep_rad = 0;                      ///< counter-clockwise positive; +-2 pi: a full turn
  double deviation_mm = 0;                   ///< Hausdorff distance to the stretch, both ways (an upper bound)
};

/// Lines. The distance holds both ways: the polyline's distance to the line is greatest at a vertex (the distance to a
/// convex set is convex), and every point of the line is the foot of a point of the polyline, which runs from one end
/// to the other. Nothing where the polyline runs back along the line by more than `max_backwards_mm`.
std::optional<double> line_deviation(std::span<const Vec2> points, std::uint32_t first, std::uint32_t last,
                                     double max_backwards_mm);

/// In space: `heights` is the third coordinate of each point. The same holds.
std::optional<double> line_deviation(std::span<const Vec2> points, std::span<const double> heights, std::uint32_t first,
                                     std::uint32_t last, double max_backwards_mm);

/// An arc as the control runs it: centre and, for ends whose radii differ, a radius between the two.
struct ArcShape {
  Vec2 center_mm = Vec2::Zero();
  double radius_mm = 0;             ///< mean of the radii at start and end
  double radius_difference_mm = 0;  ///< |end - start|
  int direction = 1;                ///< 1 counter-clockwise
};
ArcShape arc_shape(const Vec2& start, const Vec2& end, const Vec2& center_mm, int direction);

struct ArcFit {
  double deviation_mm = 0;
  double sweep_rad = 0;  ///< signed
};

/// Arcs. Greatest difference between the arc's radius and the polyline's distance from the centre, over the vertices
/// and the feet of the perpendiculars on the edges, and half the difference of the radii. As the polyline turns about
/// the centre from the arc's start to its end, every point of the arc has a point of the polyline on its ray: the
/// distance holds both ways. Nothing where a point is farther than `max_mm`, where the polyline turns back by more
/// than `max_backwards_mm` along the arc, passes an end of the arc by more than that, or turns by more than one turn.
std::optional<ArcFit> arc_deviation(std::span<const Vec2> points, std::uint32_t first, std::uint32_t last,
                                    const ArcShape& arc, double max_mm, double max_backwards_mm);

/// How far the heights of the polyline, taken at its angle about the centre, are from those of a helix of constant
/// pitch from the first point to the last (controls move the third axis evenly with the angle). Greatest value over
/// whole edges: height is linear along an edge and the angle is not, so between its ends it is looked for where the
/// difference stands still, r^2 = pitch (from x to) / rise. With the arc's deviation beside it, hypot of the two bounds
/// the Hausdorff distance: points at one angle belong to each other. `sweep_rad` as arc_deviation says it.
double helix_deviation(std::span<const Vec2> points, std::span<const double> heights, std::uint32_t first,
                       std::uint32_t last, const Vec2& center_mm, double sweep_rad);

}  // namespace camber::repath
