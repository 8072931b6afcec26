// Points of the surface, and distances.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "inspect/evaluation.h"

namespace camber::inspect {
namespace {

constexpr double kFar_mm2 = 1e12;

/// The surface's height at a place: mean over the points nearby that face as the nearest one does.
std::optional<Reading> read_place(const Vec3& place, std::span<const removal::SurfacePoint> surface, double voxel_mm) {
  const removal::SurfacePoint* nearest = nullptr;
  double least = kFar_mm2;
  for (const removal::SurfacePoint& p : surface) {
    const double d = (p.place_mm - place).squaredNorm();
    if (d < least) least = d, nearest = &p;
  }
  if (!nearest || std::sqrt(least) > 4 * voxel_mm) return std::nullopt;
  const Face face = plane_face(place, nearest->normal, 4 * voxel_mm);
  return chart_of(face, surface, voxel_mm).at(0, 0);
}

}  // namespace

void evaluate_points(Evaluation& e) {
  Probing probing;
  for (const Vec3& place : e.feature.points_mm) {
    if (const auto reading = read_place(place, e.surface, e.voxel_mm))
      probing.readings.push_back({0, 0, *reading});
    else
      ++probing.missed;
  }
  if (e.failed(probing)) return;
  std::array<std::vector<double>, 3> heights;
  for (const Probed& p : probing.readings)
    for (const Layer layer : {Layer::nominal, Layer::contour, Layer::machined})
      heights[static_cast<std::size_t>(layer)].push_back(height_of(p.reading, layer));
  const auto size = [&](const std::vector<double>& h) {
    if (e.feature.filter == FeatureFilter::min_zone)
      return (*std::ranges::min_element(h) + *std::ranges::max_element(h)) / 2;
    return size_by(h, FeatureFilter::least_squares);
  };
  e.set_sizes(size(heights[0]), size(heights[1]), size(heights[2]));
  e.out.form_um = 1000 * spread_of(heights[2]);
  for (const double h : heights[2]) e.out.deviations_um.push_back(1000 * h);
}

/// Distance of two surfaces that face along the line through the two points.
void evaluate_point_distance(Evaluation& e) {
  const Feature& f = e.feature;
  const Vec3 along = (f.axis_mm[1] - f.axis_mm[0]).normalized();
  std::array<Reading, 2> r;
  std::array<double, 2> facing{};
  for (std::size_t k = 0; k < 2; ++k) {
    for (const double sign : {1.0, -1.0}) {
      const Face face = plane_face(f.axis_mm[k], sign * along, f.extent_mm > 0 ? f.extent_mm : 4 * e.voxel_mm);
      const auto reading = chart_of(face, e.surface, e.voxel_mm).at(0, 0);
      if (reading) r[k] = *reading, facing[k] = sign;
    }
    if (facing[k] == 0) {
      e.out.missed = 1;
      e.out.reason = fmt::format("no surface faces along the line at its {} point", k == 0 ? "first" : "second");
      return;
    }
  }
  e.out.readings = 2;
  const double length = (f.axis_mm[1] - f.axis_mm[0]).norm();
  const auto size = [&](Layer layer) {
    return length + facing[1] * height_of(r[1], layer) - facing[0] * height_of(r[0], layer);
  };
  e.set_sizes(size(Layer::nominal), size(Layer::contour), size(Layer::machined));
}

/// Distance of the middles of two other features, along the line between their nominal places and across their axes.
void evaluate_distance_of(Evaluation& e, const Evaluation& a, const Evaluation& b) {
  for (const Evaluation* other : {&a, &b})
    if (!other->placed) {
      e.out.reason = fmt::format("\"{}\" has no prediction", other->feature.name);
      return;
    }
  const auto nominal = [](const Evaluation& x) {
    const Feature& f = x.feature;
    const bool round = f.kind == FeatureKind::bore || f.kind == FeatureKind::boss;
    if (!round) return f.kind == FeatureKind::plane ? f.axis_mm[1] : Vec3((f.axis_mm[0] + f.axis_mm[1]) / 2);
    return f.axis_mm[0];
  };
  Vec3 along = nominal(b) - nominal(a);
  const bool round = a.constrained.size() == 2;
  if (round) {
    const Vec3 axis = a.constrained[0].cross(a.constrained[1]);
    along -= axis.dot(along) * axis;
  } else {
    along = a.constrained[0] * a.constrained[0].dot(along);
  }
  const double length = along.norm();
  if (length < 1e-6) {
    e.out.reason = "the two features have one place; two different places were expected";
    return;
  }
  along /= length;
  std::array<double, 3> size{};
  for (std::size_t k = 0; k < 3; ++k)
    size[k] = length + along.dot((b.middle_mm[k] - nominal(b)) - (a.middle_mm[k] - nominal(a)));
  e.set_sizes(size[0], size[1], size[2]);
  e.out.readings = a.out.readings + b.out.readings;
}

}  // namespace camber::inspect
