#include "inspect/probe.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace camber::inspect {
namespace {

constexpr double kWindow_mm = 0.25;   // between nominal and programmed surface
constexpr double kFacing = 0.9;       // cosine between the normals
constexpr double kReachVoxels = 1.5;  // of a reading

double window_of(const Face& face) {
  return face.radius_mm > 0 ? std::min(kWindow_mm, face.radius_mm / 4) : kWindow_mm;
}

void add_cylinder_point(SurfaceChart& chart, const Face& face, const removal::SurfacePoint& p) {
  const Vec3 r = p.place_mm - face.origin_mm;
  const double along = face.w.dot(r), x = face.u.dot(r), y = face.v.dot(r), distance = std::hypot(x, y);
  if (std::abs(distance - face.radius_mm) > window_of(face) || distance <= 0) return;
  const Vec3 radial = (x * face.u + y * face.v) / distance;
  const double facing = radial.dot(p.normal) * (face.hollow ? -1 : 1);
  if (facing < kFacing) return;
  const double sign = face.hollow ? -facing : facing;  // of an error, which is along the normal
  chart.add({face.radius_mm * std::atan2(y, x), along, distance - face.radius_mm, sign * p.contour_mm,
             sign * (p.error_mm - p.contour_mm), p.area_mm2, p.valid});
}

void add_plane_point(SurfaceChart& chart, const Face& face, const removal::SurfacePoint& p) {
  const Vec3 r = p.place_mm - face.origin_mm;
  const double height = face.w.dot(r), facing = face.w.dot(p.normal);
  if (std::abs(height) > window_of(face) || facing < kFacing) return;
  const double u = face.u.dot(r), v = face.v.dot(r);
  if (face.reach_mm > 0 && std::hypot(u, v) > face.reach_mm) return;
  chart.add({u, v, height, facing * p.contour_mm, facing * (p.error_mm - p.contour_mm), p.area_mm2, p.valid});
}

}  // namespace

double height_of(const Reading& r, Layer layer) {
  if (layer == Layer::nominal) return r.nominal_mm;
  return layer == Layer::contour ? r.nominal_mm + r.contour_mm : r.machined_mm();
}

Face cylinder_face(const machine::Feature& feature) {
  Face face;
  face.origin_mm = feature.axis_mm[0];
  face.w = (feature.axis_mm[1] - feature.axis_mm[0]).normalized();
  const Vec3 up = face.w.z() < 0 ? Vec3(-face.w) : face.w;
  const Vec3 x = Vec3::UnitX() - up.x() * up;
  face.u = x.norm() > 0.1 ? Vec3(x.normalized()) : up.unitOrthogonal();
  face.v = up.cross(face.u);
  face.radius_mm = feature.nominal_mm / 2;
  face.hollow = feature.kind == machine::FeatureKind::bore;
  return face;
}

Face plane_face(const Vec3& point, const Vec3& outward, double reach_mm) {
  Face face;
  face.origin_mm = point;
  face.w = outward.normalized();
  const Vec3 level = Vec3::UnitZ().cross(face.w);
  face.u = level.norm() > 0.1 ? Vec3(level.normalized()) : Vec3(Vec3::UnitX() - face.w.x() * face.w).normalized();
  face.v = face.w.cross(face.u);
  face.reach_mm = reach_mm;
  return face;
}

SurfaceChart chart_of(const Face& face, std::span<const removal::SurfacePoint> surface, double voxel_mm) {
  SurfaceChart chart(kReachVoxels * voxel_mm, 2 * kPi * face.radius_mm);
  for (const removal::SurfacePoint& p : surface)
    face.radius_mm > 0 ? add_cylinder_point(chart, face, p) : add_plane_point(chart, face, p);
  return chart;
}

Probing probe(const SurfaceChart& chart, const std::vector<std::array<double, 2>>& places) {
  Probing out;
  for (const auto& [u, v] : places) {
    if (const auto reading = chart.at(u, v))
      out.readings.push_back({u, v, *reading});
    else
      ++out.missed;
  }
  return out;
}

Vec3 place_on(const Face& face, const Probed& p, Layer layer) {
  const double height = height_of(p.reading, layer);
  if (face.radius_mm == 0) return face.origin_mm + p.u_mm * face.u + p.v_mm * face.v + height * face.w;
  const double angle = p.u_mm / face.radius_mm, radius = face.radius_mm + height;
  return face.origin_mm + radius * (std::cos(angle) * face.u + std::sin(angle) * face.v) + p.v_mm * face.w;
}

}  // namespace camber::inspect
