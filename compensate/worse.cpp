#include "compensate/worse.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "compensate/error_split.h"

namespace camber::compensate {

double not_worse_mm(double given_mm, double tolerance_mm) {
  return std::max(std::abs(given_mm) + kWorse_mm, tolerance_mm);
}

WorsePlaces worse_places(const std::vector<removal::SurfacePoint>& before,
                         const std::vector<removal::SurfacePoint>& after, const Observed& observed,
                         const machine::CompensationSettings& asked) {
  WorsePlaces out;
  std::vector<std::pair<double, double>> excess_and_area;
  double area = 0, worse_area = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!observed.judged(i) || !before[i].valid || !after[i].valid) continue;
    area += before[i].area_mm2;
    const double given_mm = judged_mm(before[i], asked.reference);
    const double now_mm = std::abs(judged_mm(after[i], asked.reference));
    const double excess_mm = now_mm - not_worse_mm(given_mm, asked.half_width_um() / 1000);
    if (excess_mm <= 0) continue;
    ++out.points;
    worse_area += before[i].area_mm2;
    out.max_um = std::max(out.max_um, 1000 * (now_mm - std::abs(given_mm)));
    excess_and_area.emplace_back(1000 * excess_mm, before[i].area_mm2);
  }
  if (area <= 0) return out;
  out.area_fraction = worse_area / area;
  out.p999_um = depth_p999(std::move(excess_and_area), area);
  return out;
}

}  // namespace camber::compensate
