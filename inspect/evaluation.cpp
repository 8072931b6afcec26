#include "inspect/evaluation.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace camber::inspect {
namespace {

constexpr std::int64_t kRow = std::int64_t{1} << 32;

/// `d` brought into -period / 2 ... period / 2.
double wrapped(double d, double period) { return period > 0 ? d - period * std::round(d / period) : d; }

}  // namespace

SurfaceChart::SurfaceChart(double reach_mm, double period_mm) : reach_mm_(reach_mm), period_mm_(period_mm) {}

std::int64_t SurfaceChart::cell(double u, double v) const {
  const double w = period_mm_ > 0 ? u - period_mm_ * std::floor(u / period_mm_) : u;
  return static_cast<std::int64_t>(std::floor(w / reach_mm_)) * kRow +
         static_cast<std::int64_t>(std::floor(v / reach_mm_));
}

void SurfaceChart::add(const ChartPoint& point) {
  cells_[cell(point.u_mm, point.v_mm)].push_back(static_cast<std::uint32_t>(points_.size()));
  points_.push_back(point);
}

std::optional<Reading> SurfaceChart::within(double u, double v, double reach) const {
  const int cells = static_cast<int>(std::ceil(reach / reach_mm_));
  Reading sum;
  double weight = 0, invalid = 0;
  std::vector<std::int64_t> seen;  // a small circle meets a cell twice
  for (int i = -cells; i <= cells; ++i)
    for (int j = -cells; j <= cells; ++j) seen.push_back(cell(u + i * reach_mm_, v + j * reach_mm_));
  std::ranges::sort(seen);
  seen.erase(std::ranges::unique(seen).begin(), seen.end());
  for (const std::int64_t key : seen) {
    const auto at = cells_.find(key);
    if (at == cells_.end()) continue;
    for (const std::uint32_t k : at->second) {
      const ChartPoint& p = points_[k];
      const double du = std::abs(wrapped(p.u_mm - u, period_mm_)), dv = std::abs(p.v_mm - v);
      if (du >= reach || dv >= reach) continue;
      const double w = p.area_mm2 * (1 - du / reach) * (1 - dv / reach);
      if (!p.valid) {
        invalid += w;
        continue;
      }
      weight += w;
      sum.nominal_mm += w * p.nominal_mm;
      sum.contour_mm += w * p.contour_mm;
      sum.deflection_mm += w * p.deflection_mm;
    }
  }
  if (weight <= invalid || weight <= 0) return std::nullopt;
  return Reading{sum.nominal_mm / weight, sum.contour_mm / weight, sum.deflection_mm / weight};
}

std::optional<Reading> SurfaceChart::at(double u_mm, double v_mm) const {
  if (auto near = within(u_mm, v_mm, reach_mm_)) return near;
  return within(u_mm, v_mm, 2 * reach_mm_);
}

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
