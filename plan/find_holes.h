#pragma once
// Upright round holes of a mesh.
#include <vector>

#include "plan/faces.h"
#include "plan/triangle_solid.h"

namespace camber::plan {

struct FoundHoles {
  std::vector<Hole> holes;
  std::vector<bool> of_hole;     ///< whether each triangle belongs to a hole
  std::vector<Triangle> caps;    ///< what closes the solid where the holes' triangles are taken away
  std::vector<Vec3> new_points;  ///< middles of the caps, numbered after those of the solid
};

/// See find_faces.
FoundHoles find_holes(const TriangleSolid& solid, const MeshEdges& edges, const FaceOptions& options);

/// Normal of a triangle, of length 1; zero where it has no area.
Vec3 unit_normal(const TriangleSolid& solid, std::size_t triangle);
bool is_upright(const Vec3& unit_normal);

}  // namespace camber::plan
