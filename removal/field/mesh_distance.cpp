#include "removal/stock.h"

#include <algorithm>
#include <cmath>

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include "base/process_memory.h"
#include "base/triangle_mesh.h"
#include "removal/field/mesh_memory.h"
#include "removal/form_error.h"

#if OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER == 10  // its library has them: half the time to compile
extern template class openvdb::tree::Tree<openvdb::FloatTree::RootNodeType>;
extern template class openvdb::Grid<openvdb::FloatTree>;
#endif

namespace camber::removal {

struct MeshDistance::Impl {
  openvdb::FloatGrid::Ptr grid;
  double voxel_mm;
};

MeshDistance::MeshDistance(const std::string& path, double voxel_mm, double band_mm) {
  openvdb::initialize();
  const TriangleMesh mesh = closed_mesh(read_mesh(path), path);
  require_mesh_memory(path, mesh, voxel_mm, band_mm, free_memory_bytes());
  Eigen::Vector3f lo = mesh.points.front(), hi = lo;
  std::vector<openvdb::Vec3s> points;
  for (const auto& p : mesh.points) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
    points.emplace_back(p.x(), p.y(), p.z());
  }
  min_mm_ = lo.cast<double>();
  max_mm_ = hi.cast<double>();
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel_mm);
  impl_ = std::make_unique<Impl>(Impl{openvdb::tools::meshToSignedDistanceField<openvdb::FloatGrid>(
                                          *transform, points, triangles, {}, static_cast<float>(band_mm / voxel_mm),
                                          static_cast<float>(band_mm / voxel_mm)),
                                      voxel_mm});
}
MeshDistance::~MeshDistance() = default;
MeshDistance::MeshDistance(MeshDistance&&) noexcept = default;

double MeshDistance::distance_mm(const Vec3& p) const {
  const auto access = impl_->grid->getConstUnsafeAccessor();
  const Vec3 g = p / impl_->voxel_mm;
  openvdb::Coord base;
  for (int a = 0; a < 3; ++a) base[a] = static_cast<int>(std::floor(g[a]));
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    double w = 1;
    openvdb::Coord at = base;
    for (int a = 0; a < 3; ++a) {
      const double f = g[a] - base[a];
      w *= c >> a & 1 ? f : 1 - f;
      at[a] += c >> a & 1;
    }
    sum += w * access.getValue(at);
  }
  return sum;
}

}  // namespace camber::removal
