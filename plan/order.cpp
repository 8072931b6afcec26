#include "plan/order.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace camber::plan {

std::string_view to_string(Feature feature) {
  constexpr std::array<std::string_view, kFeatures> kNames{"closed pocket", "open pocket", "closed slot",
                                                           "open slot",     "face",        "step",
                                                           "through hole",  "blind hole",  "free form"};
  return kNames[static_cast<std::size_t>(feature)];
}

bool comes_before(const Rank& a, const Rank& b) {
  // Meshes are exact to a few parts in ten million.
  constexpr double kEqual_mm = 1e-4, kEqualVolume = 1e-5;
  if (a.is_hole != b.is_hole) return b.is_hole;
  if (std::abs(a.top_mm - b.top_mm) > kEqual_mm) return a.top_mm > b.top_mm;
  if (std::abs(a.volume_mm3 - b.volume_mm3) > kEqualVolume * std::max(a.volume_mm3, b.volume_mm3))
    return a.volume_mm3 > b.volume_mm3;
  if (a.open_faces != b.open_faces) return a.open_faces > b.open_faces;
  return a.from_middle_mm < b.from_middle_mm - kEqual_mm;
}

MachinedSpace::MachinedSpace(const RemovalVolume& removal, const std::vector<VolumePrimitive>& primitives)
    : removal_(removal), primitives_(primitives), owners_(removal.grid.size(), kAir), removed_(primitives.size()) {
  const CellGrid& g = removal.grid;
  for (int x = 0; x < g.count(0); ++x)
    for (int y = 0; y < g.count(1); ++y)
      for (int z = 0; z < g.count(2); ++z) {
        const CellKind kind = g.at({x, y, z}).kind;
        if (kind == CellKind::part) owners_[g.place({x, y, z})] = kPart;
        if (kind == CellKind::fixture) owners_[g.place({x, y, z})] = kFixture;
      }
  for (std::size_t p = 0; p < primitives.size(); ++p)
    for (const CellIndex& c : primitives[p].cells) owners_[g.place(c)] = static_cast<int>(p);
}

bool MachinedSpace::is_air(const CellIndex& c) const {
  if (!removal_.grid.holds(c)) return true;
  const int of = owner(c);
  if (of == kMachined) return removal_.grid.at(c).part_mm3 < 0.5 * removal_.grid.volume_mm3(c);
  return of == kAir;
}

double MachinedSpace::open_share(const VolumePrimitive& p, int axis, int step) const {
  double all = 0, open = 0;
  for (const CellIndex& c : p.cells) {
    CellIndex next = c;
    (axis == 0 ? next.x : axis == 1 ? next.y : next.z) += step;
    if (std::ranges::binary_search(p.cells, next)) continue;
    const double area = removal_.grid.face_mm2(c, axis);
    all += area;
    if (is_air(next)) open += area;
  }
  return all > 0 ? open / all : 0;
}

OpenFaces MachinedSpace::open_faces(std::size_t primitive) const {
  const VolumePrimitive& p = primitives_[primitive];
  if (p.is_hole) return open_faces_of_hole(removal_.holes[p.hole], primitive);
  constexpr double kOpen = 0.98, kWhole = 1 - 1e-6;
  OpenFaces out;
  for (int side = 0; side < 4; ++side)
    out.side[static_cast<std::size_t>(side)] = open_share(p, side / 2, side % 2 == 0 ? -1 : 1) > kOpen;
  out.top = open_share(p, 2, 1) > kWhole;
  out.bottom = open_share(p, 2, -1) > kOpen;
  return out;
}

std::string MachinedSpace::blocked(std::size_t primitive) const {
  const VolumePrimitive& p = primitives_[primitive];
  if (p.is_hole) return blocked_hole(removal_.holes[p.hole], primitive);
  constexpr double kThin = 0.02;  // share of a cell that an overhang may take
  const CellGrid& g = removal_.grid;
  const auto stays = [&](const CellIndex& c) { return g.at(c).part_mm3 / g.volume_mm3(c); };
  for (const CellIndex& c : p.cells)
    for (CellIndex above{c.x, c.y, c.z + 1}; removal_.grid.holds(above); ++above.z) {
      const int of = owner(above);
      if (of == kFixture) return "a fixture is above it";
      if (of == kPart) return "the part is above it";
      if (of >= 0 && of != static_cast<int>(primitive)) return "other material is above it";
      if (of == kMachined && g.at(c).kind == CellKind::clear && stays(above) > stays(c) + kThin)
        return "the part is above it";
    }
  return {};
}

void MachinedSpace::remove(std::size_t primitive) {
  removed_[primitive] = true;
  for (const CellIndex& c : primitives_[primitive].cells)
    owners_[removal_.grid.place(c)] = removal_.grid.at(c).kind == CellKind::clear ? kAir : kMachined;
}

std::vector<std::array<int, 2>> MachinedSpace::columns_of(const Hole& hole) const {
  const CellGrid& g = removal_.grid;
  constexpr double kTouch_mm = 1e-3;
  std::vector<std::array<int, 2>> out;
  for (int x = 0; x < g.count(0); ++x)
    for (int y = 0; y < g.count(1); ++y) {
      const double dx =
          std::max({g.plane_mm(0, x) - hole.centre_mm.x(), hole.centre_mm.x() - g.plane_mm(0, x + 1), 0.0});
      const double dy =
          std::max({g.plane_mm(1, y) - hole.centre_mm.y(), hole.centre_mm.y() - g.plane_mm(1, y + 1), 0.0});
      if (std::hypot(dx, dy) < hole.diameter_mm / 2 - kTouch_mm) out.push_back({x, y});
    }
  return out;
}

OpenFaces MachinedSpace::open_faces_of_hole(const Hole& hole, std::size_t primitive) const {
  const CellGrid& g = removal_.grid;
  constexpr double kTouch_mm = 1e-3;
  OpenFaces out;
  out.top = blocked_hole(hole, primitive).empty();
  out.bottom = true;
  for (const auto& [x, y] : columns_of(hole))
    for (int z = 0; z < g.count(2); ++z)
      if (g.plane_mm(2, z) < hole.tip_mm - kTouch_mm && g.plane_mm(2, z + 1) > hole.tip_mm - kTouch_mm)
        out.bottom = out.bottom && is_air({x, y, z});
  return out;
}

std::string MachinedSpace::blocked_hole(const Hole& hole, std::size_t primitive) const {
  const CellGrid& g = removal_.grid;
  constexpr double kTouch_mm = 1e-3;
  for (const auto& [x, y] : columns_of(hole))
    for (int z = 0; z < g.count(2); ++z) {
      if (g.plane_mm(2, z + 1) < hole.top_mm + kTouch_mm) continue;
      const int of = owner({x, y, z});
      if (of >= 0) return "other material is above it";
      if (of == kFixture) return "a fixture is above it";
      if (of == kPart && g.plane_mm(2, z) > hole.top_mm - kTouch_mm) return "the part is above it";
    }
  for (std::size_t p = 0; p < primitives_.size(); ++p) {
    if (!primitives_[p].is_hole || p == primitive || removed_[p]) continue;
    const Hole& other = removal_.holes[primitives_[p].hole];
    const double apart = (other.centre_mm - hole.centre_mm).norm();
    if (other.top_mm > hole.top_mm + kTouch_mm && apart < (other.diameter_mm + hole.diameter_mm) / 2 - kTouch_mm)
      return "another hole is above it";
  }
  return {};
}

Feature feature_of(const VolumePrimitive& primitive, const OpenFaces& open) {
  if (primitive.is_hole) return open.bottom ? Feature::through_hole : Feature::blind_hole;
  if (primitive.free_form) return Feature::free_form;
  const bool along_x = open.side[0] && open.side[1], along_y = open.side[2] && open.side[3];
  switch (open.sides()) {
    case 0:
      return Feature::closed_pocket;
    case 1:
      return Feature::closed_slot;
    case 2:
      return along_x || along_y ? Feature::open_slot : Feature::open_pocket;
    case 3:
      return Feature::step;
    default:
      return Feature::face;
  }
}

namespace {

Step step_of(const VolumePrimitive& p, std::size_t number, const OpenFaces& open) {
  Step step{.primitive = number, .open = open, .feature = feature_of(p, open), .width_mm = 0, .length_mm = 0};
  const Vec3 size = p.max_mm - p.min_mm;
  step.width_mm = std::min(size.x(), size.y());
  step.length_mm = std::max(size.x(), size.y());
  const bool slot = step.feature == Feature::closed_slot || step.feature == Feature::open_slot;
  if (slot) {
    const bool along_x = open.side[0] || open.side[1];
    step.width_mm = along_x ? size.y() : size.x();
    step.length_mm = along_x ? size.x() : size.y();
  }
  return step;
}

}  // namespace

Order put_in_order(const RemovalVolume& removal, const std::vector<VolumePrimitive>& primitives) {
  MachinedSpace work(removal, primitives);
  SolidBounds all;
  for (const VolumePrimitive& p : primitives) all.add(p.min_mm), all.add(p.max_mm);
  Order out;
  while (true) {
    std::size_t best = primitives.size();
    Rank best_rank;
    OpenFaces best_open;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      if (work.is_removed(p) || !work.blocked(p).empty()) continue;
      const VolumePrimitive& of = primitives[p];
      const OpenFaces open = work.open_faces(p);
      const Rank rank{of.is_hole, of.max_mm.z(), of.volume_mm3, open.count(), (of.middle() - all.middle()).norm()};
      if (best < primitives.size() && !comes_before(rank, best_rank)) continue;
      best = p, best_rank = rank, best_open = open;
    }
    if (best == primitives.size()) break;
    out.steps.push_back(step_of(primitives[best], best, best_open));
    work.remove(best);
  }
  for (std::size_t p = 0; p < primitives.size(); ++p)
    if (!work.is_removed(p)) out.unreachable.push_back({p, work.blocked(p)});
  return out;
}

namespace {

Rect rect_of(const CellGrid& g, int x, int y) {
  return {g.plane_mm(0, x), g.plane_mm(0, x + 1), g.plane_mm(1, y), g.plane_mm(1, y + 1)};
}

Rect rect_of(const VolumePrimitive& p) { return {p.min_mm.x(), p.max_mm.x(), p.min_mm.y(), p.max_mm.y()}; }

constexpr double kTouch_mm = 1e-3, kFloor_mm = 0.02;

}  // namespace

double sharp_corners_mm2(double radius_mm) { return (4 - kPi) * radius_mm * radius_mm; }

double MachinedSpace::highest_near_mm(std::size_t primitive, double distance_mm) const {
  const VolumePrimitive& p = primitives_[primitive];
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

double MachinedSpace::unreached_mm2(std::size_t primitive, const OpenFaces& open, double radius_mm) const {
  const VolumePrimitive& p = primitives_[primitive];
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

double MachinedSpace::stands_within_mm2(std::size_t primitive) const {
  const VolumePrimitive& p = primitives_[primitive];
  const Rect own = rect_of(p);
  constexpr double kFine_mm = 1;  // the grid's radius
  return Room(removal_.stays, own, kFine_mm, p.min_mm.z() + kFloor_mm).standing_mm2([&](double x, double y) {
    return own.holds(x, y);
  });
}

bool MachinedSpace::has_room(std::size_t primitive, const OpenFaces& open, double radius_mm) const {
  const VolumePrimitive& p = primitives_[primitive];
  const double area = (p.max_mm.x() - p.min_mm.x()) * (p.max_mm.y() - p.min_mm.y());
  constexpr double kCoarse = 0.005;  // the grid's own error
  int inner = 0;                     // corners between sides that are not open
  for (const auto& [x, y] : {std::pair(0, 2), std::pair(0, 3), std::pair(1, 2), std::pair(1, 3)})
    inner += !open.side[static_cast<std::size_t>(x)] && !open.side[static_cast<std::size_t>(y)];
  const double corners = std::min(inner * sharp_corners_mm2(radius_mm) / 4, 0.25 * area);
  return unreached_mm2(primitive, open, radius_mm) <= corners + kCoarse * area;
}

double MachinedSpace::part_area_mm2(const VolumePrimitive& p, int axis, int step) const {
  double sum = 0;
  for (const CellIndex& c : p.cells) {
    CellIndex next = c;
    (axis == 0 ? next.x : axis == 1 ? next.y : next.z) += step;
    if (removal_.grid.holds(next) && owner(next) == kPart) sum += removal_.grid.face_mm2(c, axis);
  }
  return sum;
}

double MachinedSpace::wall_mm2(std::size_t primitive) const {
  double sum = 0;
  for (const int axis : {0, 1})
    for (const int step : {-1, 1}) sum += part_area_mm2(primitives_[primitive], axis, step);
  return sum;
}

double MachinedSpace::floor_mm2(std::size_t primitive) const { return part_area_mm2(primitives_[primitive], 2, -1); }

}  // namespace camber::plan
