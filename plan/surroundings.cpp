// What stands round a primitive.
#include <algorithm>
#include <cmath>

#include "plan/order.h"

namespace camber::plan {
namespace {

struct Rect {
  double x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  double distance(double x, double y) const {
    return std::hypot(std::max({x0 - x, x - x1, 0.0}), std::max({y0 - y, y - y1, 0.0}));
  }
  double distance(const Rect& o) const {
    return std::hypot(std::max({x0 - o.x1, o.x0 - x1, 0.0}), std::max({y0 - o.y1, o.y0 - y1, 0.0}));
  }
};

Rect rect_of(const CellGrid& g, int x, int y) {
  return {g.plane_mm(0, x), g.plane_mm(0, x + 1), g.plane_mm(1, y), g.plane_mm(1, y + 1)};
}

Rect rect_of(const Primitive& p) { return {p.min_mm.x(), p.max_mm.x(), p.min_mm.y(), p.max_mm.y()}; }

constexpr double kTouch_mm = 1e-3;
constexpr int kCentres = 40, kPoints = 20;  // of the grid, along each side

}  // namespace

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

bool Workpiece::has_room(std::size_t primitive, const OpenFaces& open, double radius_mm) const {
  const Primitive& p = primitives_[primitive];
  const CellGrid& g = removal_.grid;
  const Rect own = rect_of(p);
  Rect room = own;
  const double beyond = radius_mm + 1;
  if (open.side[0]) room.x0 -= beyond;
  if (open.side[1]) room.x1 += beyond;
  if (open.side[2]) room.y0 -= beyond;
  if (open.side[3]) room.y1 += beyond;
  std::vector<Rect> obstacles;
  for (int x = 0; x < g.count(0); ++x)
    for (int y = 0; y < g.count(1); ++y)
      for (int z = 0; z < g.count(2); ++z) {
        const int of = owner({x, y, z});
        const Cell& cell = g.at({x, y, z});
        // A cell that is mostly part is one with an island in it; a rounded corner of a pocket takes little of its
        // cell.
        const bool island = cell.kind == CellKind::contoured && cell.part_mm3 > 0.5 * g.volume_mm3({x, y, z});
        if ((of != kPart && of != kFixture && !island) || g.plane_mm(2, z + 1) < p.min_mm.z() + kTouch_mm) continue;
        const Rect r = rect_of(g, x, y);
        if (r.distance(room) < radius_mm) obstacles.push_back(r);
        break;
      }
  const double dx = (room.x1 - room.x0) / kCentres, dy = (room.y1 - room.y0) / kCentres;
  const double half_step = 0.5 * std::hypot(dx, dy);
  std::vector<Vec2> centres;
  for (int i = 0; i <= kCentres; ++i)
    for (int j = 0; j <= kCentres; ++j) {
      const Vec2 c(room.x0 + i * dx, room.y0 + j * dy);
      if (std::ranges::all_of(obstacles,
                              [&](const Rect& o) { return o.distance(c.x(), c.y()) > radius_mm - half_step; }))
        centres.push_back(c);
    }
  const double reach = (radius_mm + half_step) * (radius_mm + half_step);
  int missed = 0;
  for (int i = 0; i < kPoints; ++i)
    for (int j = 0; j < kPoints; ++j) {
      const Vec2 at(own.x0 + (i + 0.5) * (own.x1 - own.x0) / kPoints, own.y0 + (j + 0.5) * (own.y1 - own.y0) / kPoints);
      if (std::ranges::any_of(obstacles, [&](const Rect& o) { return o.distance(at.x(), at.y()) <= 0; })) continue;
      if (std::ranges::none_of(centres, [&](const Vec2& c) { return (c - at).squaredNorm() < reach; })) ++missed;
    }
  const double area = (own.x1 - own.x0) * (own.y1 - own.y0);
  const double corners = 4 * (1 - kPi / 4) * radius_mm * radius_mm / area;
  constexpr double kCoarse = 0.02;  // the grid's own error
  return missed <= (std::min(corners, 0.25) + kCoarse) * kPoints * kPoints;
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
