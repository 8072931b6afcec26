#pragma once
// Signed distance to a triangle mesh (STL), negative inside.
#include <memory>
#include <string>

#include "base/geometry.h"

namespace camber::removal {

class MeshDistance {
 public:
  /// Reads a binary or ASCII STL (mm) and samples its distance on voxels within band_mm of its surface. Throws
  /// InputError [file-missing], [stl-format], [stl-empty], [stl-open] (an edge without a second triangle: the mesh
  /// has no inside).
  MeshDistance(const std::string& stl_path, double voxel_mm, double band_mm);
  ~MeshDistance();
  MeshDistance(MeshDistance&&) noexcept;

  /// Trilinear, clipped to +-band_mm.
  double distance_mm(const Vec3& point) const;
  const Vec3& min_mm() const { return min_mm_; }
  const Vec3& max_mm() const { return max_mm_; }

 private:
  struct Impl;
  Vec3 min_mm_, max_mm_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camber::removal
