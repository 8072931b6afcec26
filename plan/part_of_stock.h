#pragma once
// A stock, as a program leaves it, as a part.
#include <array>
#include <vector>

#include "base/geometry.h"
#include "plan/faces.h"
#include "plan/triangle_solid.h"
#include "removal/stock.h"

namespace camber::plan {

// Solids as layers of upright walls, and regions between loops as triangles.

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

struct PartOfStock {
  TriangleSolid solid;      ///< closed, with its holes filled
  std::vector<Hole> holes;  ///< by x, then y, then top
  TriangleSolid drilled;    ///< with its holes, down to the tips of their cones
};

/// Layers between the levels of the stock's floors (a three-hundredth of its area at least), each with the outline that
/// the stock has in the middle of the layer: walls become upright, and chamfers and fillets steps. Outlines are within
/// 0.005 mm of the stock's surface; walls within 0.1 degrees of an axis are along it. Edges of `blank` are sharp: the
/// field rounds them by about half a voxel. In layers thinner than two voxels, whose outline is near such an edge,
/// loops within half a voxel of one of the layer below or above are that, and walls along an axis so near to one of a
/// thicker layer are in line with it. A hole is a chain of circles in slices a voxel apart; its top is the level above
/// it.
PartOfStock part_of(const removal::Stock& stock, const SolidBounds& blank, const FaceOptions& options);

}  // namespace camber::plan
