#include "compensate/choice.h"

#include <algorithm>
#include <cmath>

namespace camber::compensate {
namespace {

constexpr double kAlike = 0.1;          // of the figure: rounds that differ by less are chosen by what they make worse
constexpr double kAlikeWorse_um = 0.1;  // and with less than this between them by the figure

bool keeps_limits(const RoundFigures& r, const RoundFigures& given, double depth_limit_um) {
  return !r.over_budget && r.rms_um < given.rms_um && r.p95_um <= given.p95_um &&
         r.depth_um <= std::max(depth_limit_um, given.depth_um);
}

bool is_better(const RoundFigures& r, const RoundFigures& best, double depth_limit_um, bool by_p95) {
  const bool too_deep = r.depth_um > depth_limit_um, best_too_deep = best.depth_um > depth_limit_um;
  if (too_deep != best_too_deep) return best_too_deep;
  const double figure = by_p95 ? r.p95_um : r.rms_um, best_figure = by_p95 ? best.p95_um : best.rms_um;
  const bool alike = std::abs(figure - best_figure) <= kAlike * std::max(figure, best_figure);
  if (alike && std::abs(r.worse_um - best.worse_um) > kAlikeWorse_um) return r.worse_um < best.worse_um;
  return figure < best_figure;
}

}  // namespace

std::size_t choose_round(std::span<const RoundFigures> rounds, double depth_limit_um, bool by_p95) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < rounds.size(); ++i) {
    if (!keeps_limits(rounds[i], rounds[0], depth_limit_um)) continue;
    if (best == 0 || is_better(rounds[i], rounds[best], depth_limit_um, by_p95)) best = i;
  }
  return best;
}

}  // namespace camber::compensate
