#pragma once
// The heights at which roughing cuts.
#include <vector>

#include "base/geometry.h"
#include "base/stl.h"
#include "copymill/region.h"

namespace camber::copymill {

/// Level faces of the part that look up, over the region: heights, descending, with more than `least_mm2` each.
std::vector<double> level_floors(const TriangleMesh& part, const AxisRegion& region, double least_mm2);

/// From the top down to the bottom, each floor (raised by the allowance) on the way included: levels between two of
/// these are evenly spaced, no more than the axial depth apart.
class Levels {
 public:
  Levels(double top_mm, double bottom_mm, std::vector<double> floors_mm);

  /// The next level below one, no deeper than the axial depth; nothing at the bottom.
  bool next(double above_mm, double axial_depth_mm, double& level_mm) const;
  double top_mm() const { return top_; }
  double bottom_mm() const { return bottom_; }

 private:
  double top_, bottom_;
  std::vector<double> stops_;  ///< floors and the bottom, descending
};

}  // namespace camber::copymill
