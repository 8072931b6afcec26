#include "compensate/safety.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "compensate/error_split.h"
#include "simulate/cut.h"

namespace camber::compensate {
namespace {

void add_point(Depth& out, const removal::SurfacePoint& p, double error_mm, double tolerance_um, double& over) {
  const double deep_um = -1000 * error_mm;
  if (deep_um > out.deepest_um) {
    out.deepest_um = deep_um;
    out.place_mm = p.place_mm;
    out.stamp = p.machined_stamp;
  }
  if (deep_um > tolerance_um) over += p.area_mm2;
}

}  // namespace

Depth depth_of(const std::vector<removal::SurfacePoint>& surface, const Observed& observed, double tolerance_um,
               bool compensated) {
  Depth out;
  double over = 0, area = 0;
  std::vector<removal::ValueOfArea> depths;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    area += surface[i].area_mm2;
    if (observed.compensated[i] != compensated || !surface[i].valid) continue;
    const double error_mm = observed.points[i].error_mm;
    add_point(out, surface[i], error_mm, tolerance_um, over);
    depths.push_back({-1000 * error_mm, surface[i].area_mm2});
  }
  out.gouge_depth_p999_um = depth_p999(std::move(depths), area);
  out.over_fraction = area > 0 ? over / area : 0;
  return out;
}

Depth depth_of(const std::vector<removal::SurfacePoint>& surface, machine::Reference reference, double others_mm2,
               double tolerance_um) {
  Depth out;
  double over = 0, area = others_mm2;
  std::vector<removal::ValueOfArea> depths;
  for (const removal::SurfacePoint& p : surface) {
    area += p.area_mm2;
    if (!p.valid) continue;
    add_point(out, p, judged_mm(p, reference), tolerance_um, over);
    depths.push_back({-1000 * judged_mm(p, reference), p.area_mm2});
  }
  out.gouge_depth_p999_um = depth_p999(std::move(depths), area);
  out.over_fraction = area > 0 ? over / area : 0;
  return out;
}

Depth depth_without_bending(const machine::Job& job, const simulate::Target& target,
                            const simulate::SimulatedProgram& emitted, double tolerance_um) {
  removal::Stock stock(target.blank);
  simulate::sweep_path(stock, job, emitted.path, 0);
  Depth out;
  double over = 0, area = 0;
  std::vector<removal::ValueOfArea> depths;
  auto surface = removal::compare_surfaces(stock, target.surface);
  target.holes.drop_from(surface);
  for (const auto& p : surface) {
    area += p.area_mm2;
    add_point(out, p, p.error_mm, tolerance_um, over);
    depths.push_back({-1000 * p.error_mm, p.area_mm2});
  }
  out.gouge_depth_p999_um = depth_p999(std::move(depths), area);
  out.over_fraction = area > 0 ? over / area : 0;
  return out;
}

double not_worse_mm(double given_mm, double tolerance_mm) {
  return std::max(std::abs(given_mm) + kWorse_mm, tolerance_mm);
}

WorsePlaces worse_places(const std::vector<removal::SurfacePoint>& before,
                         const std::vector<removal::SurfacePoint>& after, const Observed& observed,
                         const machine::CompensationSettings& asked) {
  WorsePlaces out;
  std::vector<removal::ValueOfArea> excesses;
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
    excesses.push_back({1000 * excess_mm, before[i].area_mm2});
  }
  if (area <= 0) return out;
  out.area_fraction = worse_area / area;
  out.p999_um = depth_p999(std::move(excesses), area);
  return out;
}

}  // namespace camber::compensate
