#pragma once
// The underside of a cutter: height of its surface above the tip, by distance from the axis.
#include <algorithm>
#include <cmath>

#include "removal/cutter.h"

namespace camber::copymill {

/// Height of the cutter's underside above its tip at a distance from the axis; 1e30 at the radius and beyond.
inline double underside_mm(const removal::CutterShape& shape, double r) {
  if (r >= shape.radius_mm) return 1e30;
  if (shape.general) return shape.profile.height_at_radius_mm(r);
  const double out = r - (shape.radius_mm - shape.corner_radius_mm);
  return out <= 0 ? 0
                  : shape.corner_radius_mm -
                        std::sqrt(std::max(0.0, shape.corner_radius_mm * shape.corner_radius_mm - out * out));
}

}  // namespace camber::copymill
