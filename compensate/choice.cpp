#include "compensate/choice.h"

#include <algorithm>
#include <utility>

namespace camber::compensate {

std::size_t choose_round(std::span<const RoundFigures> rounds, double depth_limit_um, bool by_p95) {
  std::size_t best = 0;
  const auto order = [&](const RoundFigures& r) {
    return std::pair(r.depth_um > depth_limit_um, by_p95 ? r.p95_um : r.rms_um);
  };
  for (std::size_t i = 1; i < rounds.size(); ++i) {
    const RoundFigures &given = rounds[0], &r = rounds[i];
    if (r.over_budget) continue;
    if (r.rms_um >= given.rms_um || r.p95_um > given.p95_um) continue;
    if (r.depth_um > std::max(depth_limit_um, given.depth_um)) continue;
    if (best == 0 || order(r) < order(rounds[best])) best = i;
  }
  return best;
}

}  // namespace camber::compensate
