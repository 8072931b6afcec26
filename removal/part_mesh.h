#pragma once
// The part as a closed mesh: how far a point lies from it.
#include <memory>
#include <string>

#include "base/geometry.h"
#include "base/triangle_mesh.h"

namespace camber::removal {

/// Reads an STL. Throws InputError [file-missing], [stl-format], [stl-empty], [stl-open] (an edge without a second
/// triangle: the mesh has no inside).
TriangleMesh read_closed_stl(const std::string& path);

/// Signed distances to a closed mesh, negative inside, exact to the rounding of its coordinates. Found through a tree
/// of boxes around the triangles; the sign is that of the angle-weighted normal at the nearest place (Baerentzen and
/// Aanaes, "Signed distance computation using the angle weighted pseudonormal", 2005).
class PartMesh {
 public:
  /// What read_closed_stl throws.
  explicit PartMesh(const std::string& stl_path);
  explicit PartMesh(const TriangleMesh& closed);
  ~PartMesh();
  PartMesh(PartMesh&&) noexcept;

  double distance_mm(const Vec3& point) const;  ///< thread safe
  const Vec3& min_mm() const { return min_mm_; }
  const Vec3& max_mm() const { return max_mm_; }

 private:
  class Tree;
  Vec3 min_mm_, max_mm_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace camber::removal
