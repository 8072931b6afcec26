#pragma once
// Closed solids as triangles, with exact volumes and the neighbours of each triangle.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "base/triangle_mesh.h"
#include "machine/workpiece.h"

namespace camber::plan {

using Triangle = std::array<std::uint32_t, 3>;

struct SolidBounds {
  Vec3 min_mm = Vec3::Constant(1e300), max_mm = Vec3::Constant(-1e300);
  void add(const Vec3& point);
  void add(const SolidBounds& other);
  Vec3 middle() const { return 0.5 * (min_mm + max_mm); }
};

/// Triangles are counter-clockwise seen from outside. Where `heights_only`, only faces that look up or down are there:
/// enough for volumes and heights, not for the search for faces.
struct TriangleSolid {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  bool heights_only = false;

  Vec3 corner(const Triangle& t, std::size_t c) const { return points[t[c]]; }
  /// Twice the area, outward.
  Vec3 normal_by_area(const Triangle& t) const;
  SolidBounds bounds() const;
};

/// By the divergence theorem, exact for the polyhedron.
double volume_mm3(const TriangleSolid& solid);

TriangleSolid solid_of(const TriangleMesh& mesh);
TriangleSolid solid_of(const machine::Box& box);
/// A prism whose polygon has the cylinder's cross-section area.
TriangleSolid solid_of(const machine::Cylinder& cylinder);
/// Turned about the origin; `turn` is a rotation.
TriangleSolid turned(const TriangleSolid& solid, const Eigen::Matrix3d& turn);

/// Heights at which the vertical line through (x, y) passes the solid, in pairs from below: material lies between the
/// first and the second, the third and the fourth ... A line through an edge is moved by a few nanometres.
std::vector<double> material_along_z(const TriangleSolid& solid, double x_mm, double y_mm);
bool contains(const TriangleSolid& solid, const Vec3& point);

/// neighbours[3 t + e]: the triangle at the edge from corner e to corner e + 1 of triangle t; kNone where there is none
/// or more than one.
struct MeshEdges {
  static constexpr std::uint32_t kNone = 0xffffffffU;
  explicit MeshEdges(const TriangleSolid& solid);
  std::uint32_t across(std::size_t triangle, std::size_t edge) const { return neighbours[3 * triangle + edge]; }
  std::vector<std::uint32_t> neighbours;
};

}  // namespace camber::plan
