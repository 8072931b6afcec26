#pragma once
// Form across the rows: the part of the error that keeps its form along a row, as the bow that a ball or a helix
// leaves.
#include <cmath>
#include <span>
#include <vector>

#include "compensate/fit_shift.h"
#include "compensate/shift_path.h"

namespace camber::compensate {

/// Length of path over which the form is taken to stay the same.
inline constexpr double kFormAlong_mm = 1.5;

/// Finds what no shift removes but stays the same for millimetres along the path: of `left` (one per observation,
/// what the best shift of every point leaves, mm) the part that is a cubic of the place across the row,
///
///   left(l, t) ~ b0(l) + b1(l) t + b2(l) t^2 + b3(l) t^3,      t = (p - c) . (d x N),
///
/// p the point, c the centre of the cutter's corner, d the path's direction, N the mean normal about l; least squares
/// with weights that fall to 1/e in 1.5 mm along the path. A grid shows a row at a few places across, others every
/// voxel; a shift that is fitted to the error less this form does not follow which ones.
///
/// Where the grid shows many points across (n within 2 smoothing_mm of path: a wall), their mean is accurate enough and
/// a form that changes along the path would do harm: the form is multiplied by 1 / (1 + (n / 40)^2). Where the surface
/// faces more than one way (a wall and its floor, a corner) the form is zero. Returns one value per observation.
std::vector<double> row_form_mm(const ShiftPath& path, std::span<const Observation> observations,
                                const std::vector<double>& left_mm, double smoothing_mm);

/// Adds to each point what the others of its chain have, less by e for every `about_mm` of path between.
template <class Sums>
void spread_along(std::vector<Sums>& sums, const ShiftPath& path, double about_mm) {
  const auto& points = path.points();
  const std::vector<Sums> own = sums;
  for (const ShiftChain& c : path.chains()) {
    const auto pass = [&](std::size_t from, std::size_t count, int step) {
      Sums carried = own[from];
      for (std::size_t k = 1, i = from + static_cast<std::size_t>(step); k < count; ++k) {
        const std::size_t last = i - static_cast<std::size_t>(step);
        carried = carried * std::exp(-std::abs(points[i].along_mm - points[last].along_mm) / about_mm);
        sums[i] = sums[i] + carried;
        carried = carried + own[i];
        i += static_cast<std::size_t>(step);
      }
    };
    pass(c.from, c.count, 1);
    pass(c.from + c.count - 1, c.count, -1);
  }
}

}  // namespace camber::compensate
