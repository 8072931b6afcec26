#pragma once
// Keeps the surface out of the part: where it came out too deep, the path is lifted, and smoothly so.
#include <vector>

#include "compensate/attribution.h"

namespace camber::compensate {

/// What a shift cannot make flat is left as excess material rather than cut too deep: the fit aims at material left on
/// (a lift) instead of at zero. A point of the surface that lies deeper than the limit asks for a lift of the path at
/// its place, along its normal; each lift fades out over `reach_mm` around, along the path and across rows, as
/// cos^2. So the lift changes by no more than pi / 2 of its height over that length, whatever single points ask for.
class Guard {
 public:
  /// Single points deeper than all but a thousandth of the surface ask for no more than those.
  Guard(const ShiftPath& path, double limit_mm, double reach_mm);

  /// Adds lifts for what lies too deep; `held_mm`: depth that 99.9 % of the surface does not exceed.
  void learn(const Observed& observed, double held_mm);
  /// Errors as the fit is to see them: less the lift.
  void apply_to(std::vector<Observation>& observations) const;

 private:
  static constexpr double kWanted = 0.8;  ///< of the limit: where a lift brings a point to
  double lift_mm(const Observation& o) const;

  double limit_mm_, reach_mm_;
  std::vector<Vec3> place_mm_;  ///< of the path's points
  std::vector<Vec3> lift_mm_;   ///< at the path's points
};

}  // namespace camber::compensate
