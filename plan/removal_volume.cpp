#include "plan/removal_volume.h"

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

/// The material on the side of greater (sign > 0) or less coordinates.
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

void CellGrid::add(const TriangleSolid& solid, double GridCell::*field, double GridCell::*free_form_area,
                   double GridCell::*overhang_area) {
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
          GridCell& cell = at({x, y, z});
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

/// Fraction of a cell's faces below which its free-form face counts as none.
constexpr double kFreeForm = 1e-4;

void CellGrid::classify(double tolerance_mm) {
  each([&](const CellIndex& c) {
    GridCell& cell = at(c);
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

namespace {

/// Share of a hole that is material of the blank, at points in it.
double material_in(const Hole& hole, const TriangleSolid& blank) {
  constexpr int kRings = 3, kAround = 8;
  double filled = 0, height = 0;
  for (int ring = 0; ring < kRings; ++ring)
    for (int i = 0; i < kAround; ++i) {
      // Rings of equal area; no point on a line of symmetry.
      const double r = 0.5 * hole.diameter_mm * std::sqrt((ring + 0.5) / kRings), a = 2 * kPi * (i + 0.37) / kAround;
      const auto z =
          material_along_z(blank, hole.centre_mm.x() + r * std::cos(a), hole.centre_mm.y() + r * std::sin(a));
      height += hole.top_mm - hole.bottom_mm;
      for (std::size_t k = 0; k + 1 < z.size(); k += 2)
        filled += std::max(0.0, std::min(z[k + 1], hole.top_mm) - std::max(z[k], hole.bottom_mm));
    }
  return height > 0 ? filled / height : 0;
}

/// Planes of an axis from those of all solids, from one end of the space to the other.
std::vector<AxisPlane> planes_within(std::vector<AxisPlane> planes, double low, double high, double tolerance) {
  std::erase_if(planes, [&](const AxisPlane& p) { return p.at_mm < low - tolerance || p.at_mm > high + tolerance; });
  constexpr double kHeavy = 1e12;  // the ends stay where they are
  planes.push_back({low, kHeavy, true});
  planes.push_back({high, kHeavy, true});
  return joined(std::move(planes), tolerance);
}

CellGrid make_grid(const RemovalInput& input, const Faces& part, const SolidBounds& space) {
  const auto of_blank = input.blank.heights_only ? input.blank_planes : find_planes(input.blank, input.faces);
  std::array<std::vector<AxisPlane>, 3> planes;
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<AxisPlane> all = part.planes[a];
    all.insert(all.end(), of_blank[a].begin(), of_blank[a].end());
    all.insert(all.end(), input.machined_planes[a].begin(), input.machined_planes[a].end());
    for (const TriangleSolid& f : input.fixtures) {
      const auto of_fixture = find_planes(f, input.faces)[a];
      all.insert(all.end(), of_fixture.begin(), of_fixture.end());
    }
    planes[a] = planes_within(std::move(all), space.min_mm[static_cast<int>(a)], space.max_mm[static_cast<int>(a)],
                              input.faces.plane_tolerance_mm);
    if (a < 2) planes[a] = without_slivers(planes[a], input.narrowest_mm);
  }
  return CellGrid(std::move(planes));
}

void take_machined(const RemovalInput& input, CellGrid& g) {
  if (!input.machined) return;
  for (int x = 0; x < g.count(0); ++x)
    for (int y = 0; y < g.count(1); ++y)
      for (int z = 0; z < g.count(2); ++z) {
        const CellIndex c{x, y, z};
        if (input.machined(0.5 * (g.low_mm(c) + g.high_mm(c))))
          g.at(c).blank_mm3 = std::min(g.at(c).blank_mm3, g.at(c).part_mm3);
      }
}

void append(TriangleSolid& to, const TriangleSolid& from) {
  const auto first = static_cast<std::uint32_t>(to.points.size());
  to.points.insert(to.points.end(), from.points.begin(), from.points.end());
  for (const Triangle& t : from.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

void sum_up(RemovalVolume& out, double tolerance_mm) {
  const CellGrid& g = out.grid;
  for (int x = 0; x < g.count(0); ++x)
    for (int y = 0; y < g.count(1); ++y)
      for (int z = 0; z < g.count(2); ++z) {
        const CellIndex c{x, y, z};
        const GridCell& cell = g.at(c);
        if (cell.kind == CellKind::clear || cell.kind == CellKind::contoured || cell.kind == CellKind::free_form)
          out.cells_mm3 += cell.removal_mm3();
        double thin = 0;
        for (int a = 0; a < 3; ++a) thin += tolerance_mm * g.face_mm2(c, a);
        if (cell.part_mm3 - cell.blank_mm3 > thin) out.outside_mm3 += cell.part_mm3 - cell.blank_mm3;
      }
  for (const Hole& h : out.holes) out.holes_mm3 += h.volume_mm3;
}

}  // namespace

double RemovalVolume::balance() const { return removal_mm3() > 0 ? (cells_mm3 + holes_mm3) / removal_mm3() - 1 : 0; }

RemovalVolume removal_volume(const RemovalInput& input) {
  Faces part = find_faces(input.part, input.faces);
  part.holes.insert(part.holes.end(), input.part_holes.begin(), input.part_holes.end());
  SolidBounds space = input.blank.bounds();
  const SolidBounds blank_bounds = space;
  space.add(part.plugged.bounds());
  for (const TriangleSolid& f : input.fixtures) space.add(f.bounds());
  RemovalVolume out{make_grid(input, part, space)};
  out.corners = part.corners;
  out.blank_bounds = blank_bounds;
  out.blank_mm3 = volume_mm3(input.blank);
  out.part_mm3 = volume_mm3(input.part);
  for (const Hole& h : input.part_holes) out.part_mm3 -= h.volume_mm3;
  out.free_form_mm2 = part.free_form_mm2;
  out.grid.add(input.blank, &GridCell::blank_mm3, &GridCell::blank_free_form_mm2);
  out.grid.add(part.plugged, &GridCell::part_mm3, &GridCell::free_form_mm2, &GridCell::overhang_mm2);
  for (const TriangleSolid& f : input.fixtures) out.grid.add(f, &GridCell::fixture_mm3);
  take_machined(input, out.grid);
  const double tolerance = std::max(input.tolerance_mm, input.faces.plane_tolerance_mm);
  out.grid.classify(tolerance);
  constexpr double kThere = 0.01;
  double done_mm3 = 0;  // of holes that the blank has
  for (Hole hole : part.holes) {
    const double share = std::min(material_in(hole, input.blank), 1.0);
    done_mm3 += (1 - share) * hole.volume_mm3;
    hole.volume_mm3 *= share;
    const Vec3 middle(hole.centre_mm.x(), hole.centre_mm.y(), 0.5 * (hole.top_mm + hole.bottom_mm));
    if (share > kThere && !(input.machined && input.machined(middle))) out.holes.push_back(hole);
  }
  sum_up(out, tolerance);
  out.narrowest_mm = input.narrowest_mm;
  out.stays = std::move(part.plugged);
  for (const TriangleSolid& f : input.fixtures) append(out.stays, f);
  out.outside_mm3 = std::max(0.0, out.outside_mm3 - 1.01 * done_mm3);
  return out;
}

}  // namespace camber::plan
