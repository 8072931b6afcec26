// What stands round a primitive.
#include <algorithm>
#include <cmath>
#include <set>

#include "plan/order.h"
#include "plan/room.h"

namespace camber::plan {
namespace {

Rect rect_of(const CellGrid& g, int x, int y) {
  return {g.plane_mm(0, x), g.plane_mm(0, x + 1), g.plane_mm(1, y), g.plane_mm(1, y + 1)};
}

Rect rect_of(const Primitive& p) { return {p.min_mm.x(), p.max_mm.x(), p.min_mm.y(), p.max_mm.y()}; }

constexpr double kTouch_mm = 1e-3, kFloor_mm = 0.02;

}  // namespace

double sharp_corners_mm2(double radius_mm) { return (4 - kPi) * radius_mm * radius_mm; }

double Workpiece::highest_near_mm(std::size_t primitive, double distance_mm) const {
  const Primitive& p = primitives_[primitive];
  const CellGrid& g = removal_.grid;
  const Rect own = rect_of(p);
  double top = p.min_mm.z();
  for (int x = 0; x < g.count(0); ++x)
    for (int y = 0; y < g.count(1); ++y) {
      if (own.distance(rect_of(g, x, y)) > distance_mm - kTouch_mm) continue;
      for (int z = g.count(2) - 1; z >= 0 && g.plane_mm(2, z + 1) > top; --z) {
        const int of = owner({x, y, z});
        if (of != kAir && of != static_cast<int>(primitive)) top = g.plane_mm(2, z + 1);
      }
    }
  return top;
}

double Workpiece::unreached_mm2(std::size_t primitive, const OpenFaces& open, double radius_mm) const {
  const Primitive& p = primitives_[primitive];
  const CellGrid& g = removal_.grid;
  const Rect own = rect_of(p);
  Rect middles = own;
  const double beyond = radius_mm + 1;
  if (open.side[0]) middles.x0 -= beyond;
  if (open.side[1]) middles.x1 += beyond;
  if (open.side[2]) middles.y0 -= beyond;
  if (open.side[3]) middles.y1 += beyond;
  std::set<std::array<int, 2>> columns;
  for (const CellIndex& c : p.cells) columns.insert({c.x, c.y});
  const auto wanted = [&](double x, double y) {
    return own.holds(x, y) && columns.contains({g.cell_of(0, x), g.cell_of(1, y)});
  };
  return Room(removal_.stays, middles, radius_mm, p.min_mm.z() + kFloor_mm).unreached_mm2(wanted);
}

double Workpiece::stands_within_mm2(std::size_t primitive) const {
  const Primitive& p = primitives_[primitive];
  const Rect own = rect_of(p);
  constexpr double kFine_mm = 1;  // the grid's radius
  return Room(removal_.stays, own, kFine_mm, p.min_mm.z() + kFloor_mm).standing_mm2([&](double x, double y) {
    return own.holds(x, y);
  });
}

bool Workpiece::has_room(std::size_t primitive, const OpenFaces& open, double radius_mm) const {
  const Primitive& p = primitives_[primitive];
  const double area = (p.max_mm.x() - p.min_mm.x()) * (p.max_mm.y() - p.min_mm.y());
  constexpr double kCoarse = 0.005;  // the grid's own error
  int inner = 0;                     // corners between sides that are not open
  for (const auto& [x, y] : {std::pair(0, 2), std::pair(0, 3), std::pair(1, 2), std::pair(1, 3)})
    inner += !open.side[static_cast<std::size_t>(x)] && !open.side[static_cast<std::size_t>(y)];
  const double corners = std::min(inner * sharp_corners_mm2(radius_mm) / 4, 0.25 * area);
  return unreached_mm2(primitive, open, radius_mm) <= corners + kCoarse * area;
}

double Workpiece::part_area_mm2(const Primitive& p, int axis, int step) const {
  double sum = 0;
  for (const CellIndex& c : p.cells) {
    CellIndex next = c;
    (axis == 0 ? next.x : axis == 1 ? next.y : next.z) += step;
    if (removal_.grid.holds(next) && owner(next) == kPart) sum += removal_.grid.face_mm2(c, axis);
  }
  return sum;
}

double Workpiece::wall_mm2(std::size_t primitive) const {
  double sum = 0;
  for (const int axis : {0, 1})
    for (const int step : {-1, 1}) sum += part_area_mm2(primitives_[primitive], axis, step);
  return sum;
}

double Workpiece::floor_mm2(std::size_t primitive) const { return part_area_mm2(primitives_[primitive], 2, -1); }

}  // namespace camber::plan
