#include "copymill/levels.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace camber::copymill {

std::vector<double> level_floors(const TriangleMesh& part, const AxisRegion& region, double least_mm2) {
  struct Floor {
    double area_mm2 = 0, highest_mm = -1e30;
  };
  std::map<long, Floor> floors;  // by micrometres
  for (const auto& t : part.triangles) {
    const Vec3 a = part.points[t[0]].cast<double>(), b = part.points[t[1]].cast<double>(),
               c = part.points[t[2]].cast<double>();
    constexpr double kLevel_mm = 1e-5;
    if (std::max({a.z(), b.z(), c.z()}) - std::min({a.z(), b.z(), c.z()}) > kLevel_mm) continue;
    const double area = 0.5 * ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
    const Vec2 lo = a.cwiseMin(b).cwiseMin(c).head<2>(), hi = a.cwiseMax(b).cwiseMax(c).head<2>();
    const bool beside = (lo.array() > region.max_mm().array()).any() || (hi.array() < region.min_mm().array()).any();
    if (area <= 0 || beside) continue;
    Floor& floor = floors[std::lround(a.z() * 1000)];
    floor.area_mm2 += area, floor.highest_mm = std::max({floor.highest_mm, a.z(), b.z(), c.z()});
  }
  std::vector<double> out;
  for (const auto& [um, floor] : floors)
    if (floor.area_mm2 >= least_mm2) out.push_back(floor.highest_mm);
  std::ranges::reverse(out);
  return out;
}

std::vector<double> BoxLevels::floors_between(double above, double level) const {
  constexpr double kApart_mm = 1e-7;
  std::vector<double> out;
  for (const double f : floors_mm)
    if (f < above - kApart_mm && f > level + kApart_mm) out.push_back(f);
  return out;
}

BoxLevels box_levels(double top_mm, double bottom_mm, std::vector<double> floors_mm, const AxisRegion& region,
                     double allowance_mm) {
  for (const auto& b : region.boxes_mm()) floors_mm.push_back(b[0].z());
  std::vector<double> all;
  all.reserve(floors_mm.size() + region.boxes_mm().size());
  for (const double f : floors_mm) all.push_back(f + allowance_mm);
  if (allowance_mm > 0)
    for (const auto& b : region.boxes_mm()) all.push_back(b[0].z());
  std::ranges::sort(all, std::greater<>());
  // Of the mesh's and the table's numbers for one height the higher.
  constexpr double kSame_mm = 1e-5;
  BoxLevels out{Levels(top_mm, bottom_mm, {}), {}};
  for (const double f : all)
    if (out.floors_mm.empty() || f < out.floors_mm.back() - kSame_mm) out.floors_mm.push_back(f);
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
