#pragma once
// A pass: the points that the tip follows, before they become lines and arcs.
#include <functional>
#include <vector>

#include "base/geometry.h"

namespace camber::copymill {

/// A pass at one level, seen from above. Closed: the first point is not repeated.
struct FlatPass {
  std::vector<Vec2> points;
  bool closed = false;
};

/// A pass in space.
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
/// The stretches of a pass whose points, `step_mm` apart, are `wanted`, `lead_mm` longer at either end; shorter gaps
/// than `join_mm` between them are passed through. A pass that is wanted everywhere stays as it is.
std::vector<Pass> stretches(const Pass& pass, double step_mm, const std::function<bool(const Vec3&)>& wanted,
                            double lead_mm, double join_mm);
/// Distance of a place from a line through points, beginning to end.
double distance_mm(const std::vector<Vec3>& line, const Vec3& place);

}  // namespace camber::copymill
