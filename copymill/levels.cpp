#include "copymill/levels.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace camber::copymill {

std::vector<double> level_floors(const TriangleMesh& part, const AxisRegion& region, double least_mm2) {
  std::map<long, double> area_of_height;  // by micrometres
  for (const auto& t : part.triangles) {
    const Vec3 a = part.points[t[0]].cast<double>(), b = part.points[t[1]].cast<double>(),
               c = part.points[t[2]].cast<double>();
    constexpr double kLevel_mm = 1e-5;
    if (std::max({a.z(), b.z(), c.z()}) - std::min({a.z(), b.z(), c.z()}) > kLevel_mm) continue;
    const double area = 0.5 * ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
    const Vec2 lo = a.cwiseMin(b).cwiseMin(c).head<2>(), hi = a.cwiseMax(b).cwiseMax(c).head<2>();
    const bool beside = (lo.array() > region.max_mm().array()).any() || (hi.array() < region.min_mm().array()).any();
    if (area > 0 && !beside) area_of_height[std::lround(a.z() * 1000)] += area;
  }
  std::vector<double> out;
  for (const auto& [um, area] : area_of_height)
    if (area >= least_mm2) out.push_back(static_cast<double>(um) / 1000);
  std::ranges::reverse(out);
  return out;
}

Levels::Levels(double top_mm, double bottom_mm, std::vector<double> floors_mm) : top_(top_mm), bottom_(bottom_mm) {
  std::ranges::sort(floors_mm, std::greater<>());
  constexpr double kApart_mm = 1e-3;
  for (const double f : floors_mm)
    if (f < top_mm - kApart_mm && f > bottom_mm + kApart_mm && (stops_.empty() || f < stops_.back() - kApart_mm))
      stops_.push_back(f);
  if (bottom_mm < top_mm - kApart_mm) stops_.push_back(bottom_mm);
}

bool Levels::next(double above_mm, double axial_depth_mm, double& level_mm) const {
  constexpr double kApart_mm = 1e-6;
  const auto stop = std::ranges::find_if(stops_, [&](double s) { return s < above_mm - kApart_mm; });
  if (stop == stops_.end()) return false;
  const double steps = std::max(1.0, std::ceil((above_mm - *stop) / axial_depth_mm - 1e-6));
  level_mm = steps <= 1 ? *stop : above_mm - (above_mm - *stop) / steps;
  return true;
}

}  // namespace camber::copymill
