#pragma once
// Measures the steps of the surface from row to row, before and after compensation.
#include <cstddef>
#include <span>

#include "compensate/attribution.h"
#include "compensate/row_links.h"

namespace camber::compensate {

/// Differences of the mean error between points of neighbouring rows, of one sense or the other. Up and down milling
/// require different shifts; the criterion is that the steps between their surfaces become smaller.
struct SurfaceSteps {
  double before_p95_mm = 0, before_max_mm = 0;
  double after_p95_mm = 0, after_max_mm = 0;
  double growth_rad = 0;  ///< additional turn of the surface from row to row, at the worst pair
  std::size_t pairs = 0;
};

/// `pairs`: row_links(path, reach, RowSense::any). A point's error is the mean, by area, of what it made; pairs of
/// which one made nothing are left out.
SurfaceSteps surface_steps(const ShiftPath& path, std::span<const RowLink> pairs, const Observed& before,
                           const Observed& after);

}  // namespace camber::compensate
