#pragma once
// Guard against gouging: adds lifts, smooth shifts away from the part, where the surface lies too deep.
#include <span>
#include <vector>

#include "compensate/attribution.h"
#include "compensate/fit_shift.h"

namespace camber::compensate {

/// Lifts the path: what a shift cannot make flat is left as excess material rather than overcut. A point of the surface
/// that lies deeper than the limit requests a lift of its path position along its normal. Each lift fades out over
/// `reach_mm`, along the path and across rows, as cos^2, so that its slope is at most pi / 2 of its height over that
/// length. A round of the guard takes the lifts alone: elsewhere the path stays as it is.
class Guard {
 public:
  /// Requests of single points are limited to the depth that 99.9 % of the surface does not exceed.
  Guard(const ShiftPath& path, double limit_mm, double reach_mm);

  /// Removes all lifts.
  void clear();
  /// Adds lifts for points that are too deep; `depth_p999_mm`: depth that 99.9 % of the surface does not exceed.
  void learn(const Observed& observed, double depth_p999_mm);
  /// Replaces the errors of a fit by those whose correction gives the lifts, and nothing else.
  void apply_to(std::vector<Observation>& observations) const;

 private:
  static constexpr double kWanted = 0.8;  ///< fraction of the limit that a lift aims at
  double lift_mm(const Observation& o) const;

  double limit_mm_, reach_mm_;
  std::vector<Vec3> place_mm_;  ///< positions of the path's points
  std::vector<Vec3> lift_mm_;   ///< lifts at the path's points
};

/// Adds the lifts (Guard::apply_to) to the path's shifts, as smooth as fit_shift makes them; the sum is cut to the
/// largest shift. Returns the number of points at which it was cut.
std::size_t fit_lifts(ShiftPath& path, std::span<const Observation> lifts, const FitShiftOptions& options);

}  // namespace camber::compensate
