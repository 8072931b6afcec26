#include "compensate/guard.h"

#include <algorithm>

namespace camber::compensate {

std::size_t Guard::learn(const Observed& observed) {
  if (weight_.empty()) weight_.assign(observed.points.size(), 1.0);
  std::size_t count = 0;
  for (std::size_t i = 0; i < observed.points.size(); ++i) {
    if (!observed.compensated[i] || observed.points[i].error_mm >= -tolerance_mm_) continue;
    weight_[i] = weight_[i] > 1 ? std::min(kGreatest, kGrowth * weight_[i]) : kFirst;
    ++count;
  }
  return count;
}

void Guard::apply_to(Observed& observed) const {
  if (weight_.empty()) return;
  for (std::size_t i = 0; i < observed.points.size(); ++i) {
    if (weight_[i] <= 1) continue;
    Observation& o = observed.points[i];
    o.weight = weight_[i];
    const double wanted = -kWanted * tolerance_mm_;
    o.error_mm = o.error_mm < wanted ? o.error_mm - wanted : 0;
  }
}

}  // namespace camber::compensate
