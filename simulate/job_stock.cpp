#include "simulate/job_stock.h"

#include <cmath>

#include "base/diagnostics.h"
#include "base/triangle_mesh.h"
#include "checks/setup_checks.h"

namespace camber::simulate {
namespace {

using Distance = std::function<double(const Vec3&)>;

/// Out of the region, and a tile around it, all counts as far from any surface.
Distance within_region(Distance distance, const removal::Region* region, double voxel_mm) {
  if (!region) return distance;
  constexpr double kFar_mm = 1e9;
  return [distance = std::move(distance), near = region->wider(removal::kTileVoxels * voxel_mm)](const Vec3& p) {
    const double d = distance(p);
    return near.contains(p) ? d : std::copysign(kFar_mm, d);
  };
}

}  // namespace

removal::Stock job_stock(const machine::Job& job, double band,
                         const std::function<void(const Vec3&, const Vec3&)>& about_to, const removal::Region* within) {
  const double voxel = job.simulation.voxel_mm;
  if (job.stock.box) {
    const Vec3 lo = job.stock.box->min_mm, hi = job.stock.box->max_mm;
    about_to(lo, hi);
    return {within_region([=](const Vec3& p) { return removal::box_distance_mm(p, lo, hi); }, within, voxel), lo, hi,
            voxel, band};
  }
  if (job.stock.cylinder) {
    const machine::Cylinder c = *job.stock.cylinder;
    const double r = c.diameter_mm / 2;
    const Vec3 lo = c.base_mm - Vec3(r, r, 0), hi = c.base_mm + Vec3(r, r, c.height_mm);
    about_to(lo, hi);
    const auto distance = [=](const Vec3& p) { return removal::cylinder_distance_mm(p, c.base_mm, r, c.height_mm); };
    return {within_region(distance, within, voxel), lo, hi, voxel, band};
  }
  if (!job.stock.vdb.empty()) {
    removal::Stock stock = removal::Stock::load(job.stock.vdb, voxel, band);
    about_to(stock.min_mm(), stock.max_mm());
    return stock;
  }
  if (job.stock.mesh.empty())
    fail_on_file(job.path, "has no stock; [stock] with box_mm, cylinder, mesh or vdb was expected", "stock-missing");
  // What the stock alone needs is asked before the mesh takes its part.
  const machine::Box box = checks::box_of(read_mesh(job.stock.mesh));
  about_to(box.min_mm, box.max_mm);
  // A leaf of voxels is skipped by the distance at its centre, so the mesh's band must hold a leaf's half diagonal.
  const removal::MeshDistance mesh(job.stock.mesh, voxel, (band + 8) * voxel);
  return {within_region([&](const Vec3& p) { return mesh.distance_mm(p); }, within, voxel), mesh.min_mm(),
          mesh.max_mm(), voxel, band};
}

}  // namespace camber::simulate
