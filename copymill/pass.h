#pragma once
// What the tip follows, before it becomes lines and arcs.
#include <vector>

#include "base/geometry.h"

namespace camber::copymill {

/// At one level, as seen from above. Closed: the first point is not repeated.
struct FlatPass {
  std::vector<Vec2> points;
  bool closed = false;
};

/// In space.
struct Pass {
  std::vector<Vec3> points;
  bool closed = false;
};

Pass at_height(const FlatPass& pass, double z_mm);
FlatPass reversed(FlatPass pass);
Pass reversed(Pass pass);
/// Begins a closed pass at the point nearest to a place; an open one is left as it is.
void start_near(Pass& pass, const Vec3& place);
double length_mm(const Pass& pass);
/// Points added so that none is farther than this from the next.
std::vector<Vec3> dense(const Pass& pass, double step_mm);

}  // namespace camber::copymill
