#pragma once
// Solids as layers of upright walls, and regions between loops as triangles.
#include <array>
#include <vector>

#include "base/geometry.h"
#include "plan/triangle_solid.h"

namespace camber::plan {

/// Loops have the region on their left: counter-clockwise around it, clockwise around its holes; several regions may
/// lie beside or within each other. Triangles name points as if the loops followed each other in one list, are
/// counter-clockwise, and have no other corners than the loops' points. Each hole is joined to what is round it by a
/// line that is passed twice; then one ear after the other is cut off. Whole nanometres: decisions are exact. Where
/// loops cross each other the triangles overlap, but each side of a loop still has one of them.
std::vector<std::array<std::size_t, 3>> triangles_of(const std::vector<std::vector<Vec2>>& loops);

/// A hole from the top of a layer down, at most to its bottom.
struct Well {
  std::vector<Vec2> ring;  ///< clockwise
  double bottom_mm = 0;
};

/// Adds the prism over a region from one height to another. `loops`: the region on the left of each, counter-clockwise
/// around it and clockwise around holes, in whole micrometres, not crossing. The prism is closed by itself: each of its
/// edges has two triangles of opposite direction.
void add_layer(TriangleSolid& out, const std::vector<std::vector<Vec2>>& loops, double from_mm, double to_mm,
               const std::vector<Well>& wells = {});

}  // namespace camber::plan
