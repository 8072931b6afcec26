#include "plan/triangle_solid.h"

#include <algorithm>
#include <cmath>

namespace camber::plan {

void SolidBounds::add(const Vec3& point) {
  min_mm = min_mm.cwiseMin(point);
  max_mm = max_mm.cwiseMax(point);
}

void SolidBounds::add(const SolidBounds& other) {
  min_mm = min_mm.cwiseMin(other.min_mm);
  max_mm = max_mm.cwiseMax(other.max_mm);
}

Vec3 TriangleSolid::normal_by_area(const Triangle& t) const {
  const Vec3 u = corner(t, 1) - corner(t, 0), v = corner(t, 2) - corner(t, 0);
  return {u.y() * v.z() - u.z() * v.y(), u.z() * v.x() - u.x() * v.z(), u.x() * v.y() - u.y() * v.x()};
}

SolidBounds TriangleSolid::bounds() const {
  SolidBounds out;
  for (const Vec3& p : points) out.add(p);
  return out;
}

double volume_mm3(const TriangleSolid& solid) {
  if (solid.points.empty()) return 0;
  const Vec3 origin = solid.points.front();
  double sum = 0;
  for (const Triangle& t : solid.triangles) {
    const Vec3 n = solid.normal_by_area(t);
    // The flux of (0, 0, z): right for solids without upright faces as well.
    const double z = (solid.corner(t, 0).z() + solid.corner(t, 1).z() + solid.corner(t, 2).z()) / 3 - origin.z();
    sum += z * n.z() / 2;
  }
  return sum;
}

TriangleSolid solid_of(const TriangleMesh& mesh) {
  TriangleSolid out;
  out.points.reserve(mesh.points.size());
  for (const auto& p : mesh.points) out.points.push_back(p.cast<double>());
  out.triangles = mesh.triangles;
  return out;
}

namespace {

/// The prism over a polygon that runs counter-clockwise.
TriangleSolid prism(const std::vector<Vec2>& outline, double bottom, double top) {
  TriangleSolid out;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const Vec2& p : outline) out.points.emplace_back(p.x(), p.y(), bottom);
  for (const Vec2& p : outline) out.points.emplace_back(p.x(), p.y(), top);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    out.triangles.push_back({i, next, n + next});
    out.triangles.push_back({i, n + next, n + i});
  }
  for (std::uint32_t i = 1; i + 1 < n; ++i) {
    out.triangles.push_back({0, i + 1, i});
    out.triangles.push_back({n, n + i, n + i + 1});
  }
  return out;
}

}  // namespace

TriangleSolid solid_of(const machine::Box& box) {
  const Vec3 &a = box.min_mm, &b = box.max_mm;
  return prism({{a.x(), a.y()}, {b.x(), a.y()}, {b.x(), b.y()}, {a.x(), b.y()}}, a.z(), b.z());
}

TriangleSolid solid_of(const machine::Cylinder& cylinder) {
  constexpr int kSides = 180;
  const double step = 2 * kPi / kSides;
  const double radius = cylinder.diameter_mm / 2 * std::sqrt(step / std::sin(step));
  std::vector<Vec2> outline;
  for (int i = 0; i < kSides; ++i)
    outline.emplace_back(cylinder.base_mm.x() + radius * std::cos(i * step),
                         cylinder.base_mm.y() + radius * std::sin(i * step));
  return prism(outline, cylinder.base_mm.z(), cylinder.base_mm.z() + cylinder.height_mm);
}

TriangleSolid turned(const TriangleSolid& solid, const Eigen::Matrix3d& turn) {
  TriangleSolid out = solid;
  for (Vec3& p : out.points) p = turn * p;
  return out;
}

namespace {

double cross2(const Vec3& a, const Vec3& b, double x, double y) {
  return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
}

bool upright_edge(const Vec3& a, const Vec3& b) { return a.x() == b.x() && a.y() == b.y(); }

/// False where the line passes an edge. Upright triangles do not count, though rounding may leave them an area.
bool cross_all(const TriangleSolid& solid, double x, double y, std::vector<std::pair<double, int>>& crossings) {
  crossings.clear();
  for (const Triangle& t : solid.triangles) {
    const Vec3 &a = solid.points[t[0]], &b = solid.points[t[1]], &c = solid.points[t[2]];
    if (x < std::min({a.x(), b.x(), c.x()}) || x > std::max({a.x(), b.x(), c.x()}) ||
        y < std::min({a.y(), b.y(), c.y()}) || y > std::max({a.y(), b.y(), c.y()}))
      continue;
    const double u = cross2(b, c, x, y), v = cross2(c, a, x, y), w = cross2(a, b, x, y), all = u + v + w;
    if (all == 0 || upright_edge(a, b) || upright_edge(b, c) || upright_edge(c, a)) continue;
    if (u == 0 || v == 0 || w == 0) return false;
    if ((u > 0) != (v > 0) || (v > 0) != (w > 0)) continue;
    crossings.emplace_back((u * a.z() + v * b.z() + w * c.z()) / all, all > 0 ? -1 : 1);
  }
  return true;
}

}  // namespace

std::vector<double> material_along_z(const TriangleSolid& solid, double x_mm, double y_mm) {
  std::vector<std::pair<double, int>> crossings;
  double move = 0;
  while (!cross_all(solid, x_mm + move, y_mm + 0.618 * move, crossings)) move += 3.7e-6;
  // Downward faces (where material begins) before upward ones of the same height.
  std::ranges::sort(crossings, [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.second > b.second;
  });
  std::vector<double> out;
  int inside = 0;
  for (const auto& [z, change] : crossings) {
    const int before = inside;
    inside += change;
    if ((before > 0) == (inside > 0)) continue;
    constexpr double kRounding_mm = 1e-9;  // of heights on triangles of different shape
    if (inside > 0 && !out.empty() && z - out.back() < kRounding_mm)
      out.pop_back();
    else
      out.push_back(z);
  }
  if (out.size() % 2 != 0) out.pop_back();
  return out;
}

bool contains(const TriangleSolid& solid, const Vec3& point) {
  const std::vector<double> z = material_along_z(solid, point.x(), point.y());
  for (std::size_t i = 0; i + 1 < z.size(); i += 2)
    if (point.z() > z[i] && point.z() < z[i + 1]) return true;
  return false;
}

MeshEdges::MeshEdges(const TriangleSolid& solid) : neighbours(3 * solid.triangles.size(), kNone) {
  struct Edge {
    std::uint32_t low, high, place;
    bool operator<(const Edge& o) const {
      return low != o.low ? low < o.low : high != o.high ? high < o.high : place < o.place;
    }
  };
  std::vector<Edge> edges;
  edges.reserve(neighbours.size());
  for (std::size_t t = 0; t < solid.triangles.size(); ++t)
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t a = solid.triangles[t][e], b = solid.triangles[t][(e + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(3 * t + e)});
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    if (end == i + 2) {
      neighbours[edges[i].place] = edges[i + 1].place / 3;
      neighbours[edges[i + 1].place] = edges[i].place / 3;
    }
    i = end;
  }
}

}  // namespace camber::plan
