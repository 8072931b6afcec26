#include "plan/cell_grid.h"

#include <algorithm>
#include <cmath>

namespace camber::plan {
namespace {

/// A convex polygon with room for a triangle that is clipped by six planes.
struct Polygon {
  std::array<Vec3, 10> points;
  std::size_t count = 0;
  void add(const Vec3& p) { points[count++] = p; }
};

/// What lies on the side of greater (sign > 0) or less coordinates.
Polygon clipped(const Polygon& from, int axis, double at, double sign) {
  Polygon out;
  for (std::size_t i = 0; i < from.count; ++i) {
    const Vec3 &a = from.points[i], &b = from.points[(i + 1) % from.count];
    const double da = sign * (a[axis] - at), db = sign * (b[axis] - at);
    if (da >= 0) out.add(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) out.add(a + (b - a) * (da / (da - db)));
  }
  return out;
}

/// Signed area of the projection on xy, positive where the polygon looks up; `mean_z` of it.
double area_of(const Polygon& p, double& mean_z) {
  double area = 0, moment = 0;
  const Vec3& a = p.points[0];
  for (std::size_t i = 1; i + 1 < p.count; ++i) {
    const Vec3 &b = p.points[i], &c = p.points[i + 1];
    const double part = 0.5 * ((b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x()));
    area += part;
    moment += part * (a.z() + b.z() + c.z()) / 3;
  }
  mean_z = area != 0 ? moment / area : 0;
  return area;
}

/// First cell along an axis that reaches beyond `at`.
int first_cell(const std::vector<AxisPlane>& planes, double at) {
  const auto above =
      std::upper_bound(planes.begin(), planes.end(), at, [](double v, const AxisPlane& p) { return v < p.at_mm; });
  return std::max(0, static_cast<int>(above - planes.begin()) - 1);
}

}  // namespace

CellGrid::CellGrid(std::array<std::vector<AxisPlane>, 3> planes) : planes_(std::move(planes)) {
  cells_.resize(static_cast<std::size_t>(count(0)) * static_cast<std::size_t>(count(1)) *
                static_cast<std::size_t>(count(2)));
}

bool CellGrid::holds(const CellIndex& c) const {
  return c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x < count(0) && c.y < count(1) && c.z < count(2);
}

std::size_t CellGrid::place(const CellIndex& c) const {
  return (static_cast<std::size_t>(c.x) * static_cast<std::size_t>(count(1)) + static_cast<std::size_t>(c.y)) *
             static_cast<std::size_t>(count(2)) +
         static_cast<std::size_t>(c.z);
}

double CellGrid::volume_mm3(const CellIndex& c) const { return (high_mm(c) - low_mm(c)).prod(); }

int CellGrid::cell_of(int axis, double at_mm) const {
  const std::vector<AxisPlane>& planes = planes_[static_cast<std::size_t>(axis)];
  return static_cast<int>(std::ranges::upper_bound(planes, at_mm, {}, &AxisPlane::at_mm) - planes.begin()) - 1;
}

double CellGrid::face_mm2(const CellIndex& c, int axis) const {
  const Vec3 size = high_mm(c) - low_mm(c);
  return size.prod() / size[axis];
}

template <class Function>
void CellGrid::each(Function f) {
  for (int x = 0; x < count(0); ++x)
    for (int y = 0; y < count(1); ++y)
      for (int z = 0; z < count(2); ++z) f(CellIndex{x, y, z});
}

void CellGrid::add(const Solid& solid, double Cell::*field, double Cell::*free_form_area, double Cell::*overhang_area) {
  constexpr double kUpright = 0.01, kLevel = 1 - 1.5e-6;
  for (const Triangle& t : solid.triangles) {
    Polygon whole;
    for (std::size_t c = 0; c < 3; ++c) whole.add(solid.corner(t, c));
    const Vec3 n = solid.normal_by_area(t);
    const double slope = n.norm() > 0 ? n.z() / n.norm() : 0;
    if (slope == 0) continue;
    const bool free_form = free_form_area != nullptr && std::abs(slope) > kUpright && std::abs(slope) < kLevel;
    Vec3 low = whole.points[0], high = low;
    for (std::size_t c = 1; c < 3; ++c) low = low.cwiseMin(whole.points[c]), high = high.cwiseMax(whole.points[c]);
    for (int x = first_cell(planes_[0], low.x()); x < count(0) && plane_mm(0, x) < high.x(); ++x) {
      const Polygon slab = clipped(clipped(whole, 0, plane_mm(0, x), 1), 0, plane_mm(0, x + 1), -1);
      if (slab.count < 3) continue;
      for (int y = first_cell(planes_[1], low.y()); y < count(1) && plane_mm(1, y) < high.y(); ++y) {
        const Polygon column = clipped(clipped(slab, 1, plane_mm(1, y), 1), 1, plane_mm(1, y + 1), -1);
        if (column.count < 3) continue;
        double mean_z = 0;
        const double area = area_of(column, mean_z);
        for (int z = 0; z < count(2) && plane_mm(2, z) < high.z(); ++z) {
          Cell& cell = at({x, y, z});
          const double from = plane_mm(2, z), to = plane_mm(2, z + 1);
          if (low.z() >= to) {
            cell.*field += area * (to - from);
            continue;
          }
          double above_z = 0;
          const Polygon over = clipped(column, 2, from, 1), in = clipped(over, 2, to, -1),
                        above = clipped(over, 2, to, 1);
          const double in_area = in.count < 3 ? 0 : area_of(in, mean_z);
          if (in.count >= 3) cell.*field += in_area * (mean_z - from);
          if (above.count >= 3) cell.*field += area_of(above, above_z) * (to - from);
          if (!free_form || in_area == 0) continue;
          cell.*free_form_area += std::abs(in_area / slope);
          if (overhang_area != nullptr && slope < 0) cell.*overhang_area += std::abs(in_area / slope);
        }
      }
    }
  }
}

/// Of a cell's faces: less free-form face is none.
constexpr double kFreeForm = 1e-4;

void CellGrid::classify(double tolerance_mm) {
  each([&](const CellIndex& c) {
    Cell& cell = at(c);
    const double faces = faces_mm2(c), of_part = cell.free_form_mm2, of_both = of_part + cell.blank_free_form_mm2;
    const auto counts = [&](double volume, double free_form) {
      return volume > tolerance_mm * faces || (free_form > kFreeForm * faces && volume > tolerance_mm * free_form);
    };
    const bool stays = counts(cell.part_mm3, of_part), goes = counts(cell.removal_mm3(), of_both);
    if (cell.fixture_mm3 > tolerance_mm * faces)
      cell.kind = CellKind::fixture;
    else if (!goes)
      cell.kind = stays ? CellKind::part : CellKind::air;
    else if (!stays)
      cell.kind = CellKind::clear;
    else
      cell.kind = of_part > kFreeForm * faces ? CellKind::free_form : CellKind::contoured;
  });
  join_skins();
}

/// A skin over a free-form surface ends in cells in which nothing of the part is: they go with it.
void CellGrid::join_skins() {
  std::vector<CellIndex> skins;
  each([&](const CellIndex& c) {
    if (at(c).kind == CellKind::clear && at(c).blank_free_form_mm2 > kFreeForm * faces_mm2(c)) skins.push_back(c);
  });
  const auto beside = [&](const CellIndex& c) {
    for (const CellIndex& n :
         {CellIndex{c.x - 1, c.y, c.z}, CellIndex{c.x + 1, c.y, c.z}, CellIndex{c.x, c.y - 1, c.z},
          CellIndex{c.x, c.y + 1, c.z}, CellIndex{c.x, c.y, c.z - 1}, CellIndex{c.x, c.y, c.z + 1}})
      if (holds(n) && at(n).kind == CellKind::free_form) return true;
    return false;
  };
  for (bool any = true; any;) {
    any = false;
    std::erase_if(skins, [&](const CellIndex& c) {
      if (!beside(c)) return false;
      at(c).kind = CellKind::free_form;
      return any = true;
    });
  }
}

}  // namespace camber::plan
