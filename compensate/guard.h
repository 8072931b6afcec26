#pragma once
// Keeps the surface out of the part: points that came out too deep pull the path outwards.
#include <vector>

#include "compensate/attribution.h"

namespace camber::compensate {

/// A one-sided limit by weights (an active set): a point of the surface that lies deeper than the tolerance asks for
/// half the tolerance, with a weight that grows each time it does so again; the others keep asking for zero. What a
/// shift cannot make flat is so left standing instead of cut away.
class Guard {
 public:
  explicit Guard(double tolerance_mm) : tolerance_mm_(tolerance_mm) {}

  /// Of a surface's points in their order. Returns how many lie too deep.
  std::size_t learn(const Observed& observed);
  /// Errors and weights as the fit is to see them; `observed` in the same order.
  void apply_to(Observed& observed) const;
  bool active() const { return !weight_.empty(); }

 private:
  static constexpr double kFirst = 50, kGrowth = 5, kGreatest = 10000, kWanted = 0.5;
  double tolerance_mm_;
  std::vector<double> weight_;
};

}  // namespace camber::compensate
