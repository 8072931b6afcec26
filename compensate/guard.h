#pragma once
// Guard against gouging: lifts the path smoothly where the surface is too deep.
#include <vector>

#include "compensate/attribution.h"

namespace camber::compensate {

/// What a shift cannot make flat is left as excess material rather than overcut: the fit aims at excess material (a
/// lift) instead of zero. A point of the surface that lies deeper than the limit requests a lift of its path position
/// along its normal. Each lift fades out over `reach_mm`, along the path and across rows, as cos^2, so that its slope
/// is at most pi / 2 of its height over that length.
class Guard {
 public:
  /// Requests of single points are limited to the depth that 99.9 % of the surface does not exceed.
  Guard(const ShiftPath& path, double limit_mm, double reach_mm);

  /// Adds lifts for points that are too deep; `depth_p999_mm`: depth that 99.9 % of the surface does not exceed.
  void learn(const Observed& observed, double depth_p999_mm);
  /// Errors as the fit is to see them: less the lift.
  void apply_to(std::vector<Observation>& observations) const;

 private:
  static constexpr double kWanted = 0.8;  ///< fraction of the limit that a lift aims at
  double lift_mm(const Observation& o) const;

  double limit_mm_, reach_mm_;
  std::vector<Vec3> place_mm_;  ///< of the path's points
  std::vector<Vec3> lift_mm_;   ///< at the path's points
};

}  // namespace camber::compensate
