#pragma once
// A stock, as a program leaves it, as a part.
#include <vector>

#include "plan/faces.h"
#include "removal/stock.h"

namespace camber::plan {

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
