#pragma once
// Local sensitivity g of the error to the shift, by which each step is divided (Newton's method): a cutter that goes
// deeper takes a thicker chip and deflects more.
#include <span>
#include <vector>

#include "compensate/attribution.h"
#include "compensate/shift_path.h"

namespace camber::compensate {

/// A cutter shifted into the work takes a thicker chip and deflects more, so that the surface moves by less than the
/// shift; shifted across rows, the surface may move by more. From two predictions,
///
///   g = sum a (n . ds) de / sum a (n . ds)^2
///
/// with a the area, ds the change of the shift and de that of the error at the same points of the surface, averaged
/// along the path over a few millimetres and blended with the g of the whole path where the shift hardly changed. A
/// gain over one indicates an over-correction; the next step is shorter by it.
class Sensitivity {
 public:
  static constexpr double kMin = 0.4, kGreatest = 1.6;

  explicit Sensitivity(const ShiftPath& path) : gain_(path.points().size(), 1.0) {}

  /// `before`, `now`: the same points of the surface, predicted with the shifts `shifts_before` and the path's.
  void learn(const ShiftPath& path, std::span<const Vec3> shifts_before, const Observed& before, const Observed& now);
  void apply_to(std::vector<Observation>& observations) const;
  double mean() const;

 private:
  std::vector<double> gain_;  ///< one per point of the path
};

}  // namespace camber::compensate
