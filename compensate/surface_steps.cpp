#include "compensate/surface_steps.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace camber::compensate {
namespace {

std::vector<std::optional<double>> mean_errors_mm(const ShiftPath& path, const Observed& observed) {
  struct Sums {
    double error = 0, area = 0;
  };
  std::vector<Sums> sums(path.points().size());
  for (std::size_t i = 0; i < observed.points.size(); ++i) {
    if (!observed.compensated[i]) continue;
    const Observation& o = observed.points[i];
    const auto add = [&](std::size_t at, double fraction) {
      sums[at].error += fraction * o.area_mm2 * o.error_mm;
      sums[at].area += fraction * o.area_mm2;
    };
    add(o.place.lower, 1 - o.place.upper_fraction);
    add(o.place.lower + 1, o.place.upper_fraction);
  }
  std::vector<std::optional<double>> out(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i)
    if (sums[i].area > 0) out[i] = sums[i].error / sums[i].area;
  return out;
}

double p95(std::vector<double> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

SurfaceSteps surface_steps(const ShiftPath& path, std::span<const RowLink> pairs, const Observed& before,
                           const Observed& after) {
  const auto was = mean_errors_mm(path, before), is = mean_errors_mm(path, after);
  SurfaceSteps out;
  std::vector<double> steps_before, steps_after;
  for (const RowLink& l : pairs) {
    if (!was[l.a] || !was[l.b] || !is[l.a] || !is[l.b]) continue;
    steps_before.push_back(std::abs(*was[l.a] - *was[l.b]));
    steps_after.push_back(std::abs(*is[l.a] - *is[l.b]));
    out.growth_rad = std::max(
        out.growth_rad, std::atan2(steps_after.back(), l.distance_mm) - std::atan2(steps_before.back(), l.distance_mm));
  }
  out.pairs = steps_before.size();
  if (out.pairs == 0) return out;
  out.before_max_mm = *std::max_element(steps_before.begin(), steps_before.end());
  out.after_max_mm = *std::max_element(steps_after.begin(), steps_after.end());
  out.before_p95_mm = p95(std::move(steps_before));
  out.after_p95_mm = p95(std::move(steps_after));
  return out;
}

}  // namespace camber::compensate
