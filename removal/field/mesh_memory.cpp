#include "removal/field/mesh_memory.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

namespace camber::removal {

double surface_mm2(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]].cast<double>(), b = mesh.points[t[1]].cast<double>();
    const Vec3 c = mesh.points[t[2]].cast<double>();
    sum += 0.5 * (b - a).cross(c - a).norm();
  }
  return sum;
}

double mesh_field_bytes(double surface, double voxel_mm, double band_mm) {
  constexpr double kBytesPerVoxel = 12, kLeaf = 8;
  return kBytesPerVoxel * surface / (voxel_mm * voxel_mm) * (2 * band_mm / voxel_mm + kLeaf);
}

void require_mesh_memory(const std::string& path, const TriangleMesh& mesh, double voxel_mm, double band_mm,
                         double free_bytes) {
  const double surface = surface_mm2(mesh), needed = mesh_field_bytes(surface, voxel_mm, band_mm);
  if (needed <= free_bytes) return;
  // The band is a number of voxels.
  double enough = voxel_mm;
  while (mesh_field_bytes(surface, enough, band_mm * enough / voxel_mm) > free_bytes / 2) enough *= 1.25;
  fail_on_file(
      path,
      fmt::format("voxel_mm = {:g} needs about {:.1f} GB for a mesh with a surface of {:.0f} mm2, but {:.1f} GB "
                  "are free; voxel_mm = {:.2g} or a smaller mesh was expected",
                  voxel_mm, needed / 1e9, surface, free_bytes / 1e9, enough),
      "voxel-memory");
}

}  // namespace camber::removal
