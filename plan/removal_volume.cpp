#include "plan/removal_volume.h"

#include <algorithm>
#include <cmath>

namespace camber::plan {
namespace {

/// Share of a hole that is material of the blank, at points in it.
double material_in(const Hole& hole, const Solid& blank) {
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

CellGrid make_grid(const RemovalInput& input, const Faces& part, const Bounds& space) {
  const auto of_blank = input.blank.heights_only ? input.blank_planes : find_planes(input.blank, input.faces);
  std::array<std::vector<AxisPlane>, 3> planes;
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<AxisPlane> all = part.planes[a];
    all.insert(all.end(), of_blank[a].begin(), of_blank[a].end());
    all.insert(all.end(), input.machined_planes[a].begin(), input.machined_planes[a].end());
    for (const Solid& f : input.fixtures) {
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

void append(Solid& to, const Solid& from) {
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
        const Cell& cell = g.at(c);
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
  Bounds space = input.blank.bounds();
  const Bounds blank_bounds = space;
  space.add(part.plugged.bounds());
  for (const Solid& f : input.fixtures) space.add(f.bounds());
  RemovalVolume out{make_grid(input, part, space)};
  out.corners = part.corners;
  out.blank_bounds = blank_bounds;
  out.blank_mm3 = volume_mm3(input.blank);
  out.part_mm3 = volume_mm3(input.part);
  for (const Hole& h : input.part_holes) out.part_mm3 -= h.volume_mm3;
  out.free_form_mm2 = part.free_form_mm2;
  out.grid.add(input.blank, &Cell::blank_mm3, &Cell::blank_free_form_mm2);
  out.grid.add(part.plugged, &Cell::part_mm3, &Cell::free_form_mm2, &Cell::overhang_mm2);
  for (const Solid& f : input.fixtures) out.grid.add(f, &Cell::fixture_mm3);
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
  for (const Solid& f : input.fixtures) append(out.stays, f);
  out.outside_mm3 = std::max(0.0, out.outside_mm3 - 1.01 * done_mm3);
  return out;
}

}  // namespace camber::plan
