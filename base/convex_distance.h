#pragma once
// Distance of convex solids.
#include "base/geometry.h"

namespace camber {

class ConvexSolid {
 public:
  virtual ~ConvexSolid() = default;
  /// The point of the solid that is farthest in this direction (any length but zero).
  virtual Vec3 support(const Vec3& direction) const = 0;
};

/// Least distance, by the iteration of Gilbert, Johnson and Keerthi (1988): at most the true one and no more than
/// 1e-4 mm or a thousandth of it less; 0 where the solids overlap.
double convex_distance(const ConvexSolid& a, const ConvexSolid& b);

/// Whether convex_distance() is less than `limit_mm` (above zero), which is mostly known much sooner than the distance.
/// `from_b_to_a`: about the direction in which a is off b, any but zero; the better it is, the sooner.
bool convex_nearer(const ConvexSolid& a, const ConvexSolid& b, double limit_mm, const Vec3& from_b_to_a);

}  // namespace camber
