#pragma once
// Traces the outline of a region that is given by a yes or no at each point.
#include <functional>
#include <vector>

#include "base/geometry.h"
#include "copymill/grid.h"

namespace camber::copymill {

using Inside = std::function<bool(const Vec2&)>;

/// A closed chain of points, the region on its left: counter-clockwise around it, clockwise around holes.
using Outline = std::vector<Vec2>;

/// Marching squares over the grid; the grid's border must be outside. Points lie on grid lines where `crossing`, given
/// an inside and an outside grid point beside each other, puts them. Where two inside points of a cell are opposite,
/// they are not joined.
std::vector<Outline> outlines(const Grid& grid, const std::vector<char>& inside,
                              const std::function<Vec2(const Vec2& in, const Vec2& out)>& crossing);

/// Returns the last place inside on the way out, by bisection to `tolerance_mm`.
Vec2 last_inside(const Inside& inside, Vec2 in, Vec2 out, double tolerance_mm);

/// Adds points to an outline of exact points until no chord is farther from the region's border than `tolerance_mm`:
/// corners that the grid cut off (found by prolonging the chords beside them, within `reach_mm`), and the middles of
/// chords. All added points are inside.
Outline refined(const Outline& coarse, const Inside& inside, double tolerance_mm, double reach_mm);

}  // namespace camber::copymill
