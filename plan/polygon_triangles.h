#pragma once
// A region between closed loops, in triangles.
#include <array>
#include <vector>

#include "base/geometry.h"

namespace camber::plan {

/// Loops have the region on their left: counter-clockwise around it, clockwise around its holes; several regions may
/// lie beside or within each other. Triangles name points as if the loops followed each other in one list, are
/// counter-clockwise, and have no other corners than the loops' points. Each hole is joined to what is round it by a
/// line that is passed twice; then one ear after the other is cut off. Whole nanometres: decisions are exact. Where
/// loops cross each other the triangles overlap, but each side of a loop still has one of them.
std::vector<std::array<std::size_t, 3>> triangles_of(const std::vector<std::vector<Vec2>>& loops);

}  // namespace camber::plan
