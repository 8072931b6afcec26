#pragma once
// Solids as layers of upright walls.
#include <vector>

#include "plan/solid.h"

namespace camber::plan {

/// A hole from the top of a layer down, at most to its bottom.
struct Well {
  std::vector<Vec2> ring;  ///< clockwise
  double bottom_mm = 0;
};

/// Adds the prism over a region from one height to another. `loops`: the region on the left of each, counter-clockwise
/// around it and clockwise around holes, in whole micrometres, not crossing. The prism is closed by itself: each of its
/// edges has two triangles of opposite direction.
void add_layer(Solid& out, const std::vector<std::vector<Vec2>>& loops, double from_mm, double to_mm,
               const std::vector<Well>& wells = {});

}  // namespace camber::plan
