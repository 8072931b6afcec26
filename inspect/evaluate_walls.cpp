// Slot widths and walls: two opposite faces.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "inspect/evaluation.h"

namespace camber::inspect {
namespace {

constexpr int kStations = 24;  // along a slot

/// Two opposite faces read at the same places; each face's height is along its own outward direction from the nominal
/// place at half the nominal size. `across`: from the first face to the second.
struct Pair {
  std::array<Face, 2> face;
  Vec3 middle_mm = Vec3::Zero(), across = Vec3::UnitX();
  double sign = 1;  ///< of heights in the size: +1 material between the faces, -1 a gap
};

struct LocalSizes {
  std::vector<double> depth;
  std::array<std::vector<double>, 3> size, shift;  ///< by Layer: size, and the middle's shift along `across`
  std::size_t missed = 0;
};

/// `places`: (along, depth) of both faces as points in space.
LocalSizes local_sizes(const Pair& pair, Evaluation& e, const std::vector<Vec3>& places) {
  const std::array<SurfaceChart, 2> chart{chart_of(pair.face[0], e.surface, e.voxel_mm),
                                          chart_of(pair.face[1], e.surface, e.voxel_mm)};
  LocalSizes out;
  for (const Vec3& place : places) {
    std::array<std::optional<Reading>, 2> r;
    for (std::size_t k = 0; k < 2; ++k) {
      const Vec3 d = place - pair.face[k].origin_mm;
      r[k] = chart[k].at(pair.face[k].u.dot(d), pair.face[k].v.dot(d));
    }
    if (!r[0] || !r[1]) {
      ++out.missed;
      continue;
    }
    for (const Layer layer : {Layer::nominal, Layer::contour, Layer::machined}) {
      const auto k = static_cast<std::size_t>(layer);
      const double first = height_of(*r[0], layer), second = height_of(*r[1], layer);
      out.size[k].push_back(e.feature.nominal_mm + pair.sign * (first + second));
      out.shift[k].push_back(pair.sign * (second - first) / 2);
    }
    out.depth.push_back(-place.z());
  }
  return out;
}

double mean_of(const std::vector<double>& values) { return size_by(values, FeatureFilter::least_squares); }

void evaluate_pair(Evaluation& e, const Pair& pair, const std::vector<Vec3>& places) {
  const LocalSizes local = local_sizes(pair, e, places);
  const std::vector<double>& machined = local.size[2];
  e.out.readings = 2 * machined.size(), e.out.missed = 2 * local.missed;
  if (machined.size() <= local.missed) {
    e.out.reason = fmt::format("{} of {} places have no surface of the job's operations, or are beyond the model",
                               local.missed, places.size());
    return;
  }
  std::array<double, 3> size{};
  for (std::size_t k = 0; k < 3; ++k) {
    size[k] = size_by(local.size[k], e.feature.filter);
    e.middle_mm[k] = pair.middle_mm + mean_of(local.shift[k]) * pair.across;
  }
  e.set_sizes(size[0], size[1], size[2]);
  e.out.form_um = 1000 * spread_of(machined);
  if (const double deep = spread_of(local.depth); deep > 1e-6)
    e.out.taper_um = -1000 * fit_line(local.depth, machined).slope * deep;
  e.placed = true;
  e.constrained = {pair.across};
  for (const double s : machined) e.out.deviations_um.push_back(1000 * (s - e.feature.nominal_mm));
}

}  // namespace

void evaluate_slot(Evaluation& e) {
  const Feature& f = e.feature;
  const Vec3 way = f.axis_mm[1] - f.axis_mm[0], along = way.normalized();
  Vec3 across = Vec3::UnitZ().cross(along);
  if (across.norm() < 1e-6) {
    e.out.reason = "the slot's middle line is along the tool; a line across it was expected";
    return;
  }
  across.normalize();
  Pair pair;
  pair.middle_mm = (f.axis_mm[0] + f.axis_mm[1]) / 2 - f.depth_mm.value_or(0) * Vec3::UnitZ();
  pair.across = across;
  pair.sign = -1;
  pair.face = {plane_face(f.axis_mm[0] - f.nominal_mm / 2 * across, across, 0),
               plane_face(f.axis_mm[0] + f.nominal_mm / 2 * across, -across, 0)};
  // Without a depth: over all depths that both walls have, which is what their points tell.
  std::vector<double> depths{f.depth_mm.value_or(0)};
  if (!f.depth_mm) {
    double top = -1e300, bottom = 1e300;
    for (const Face& face : pair.face) {
      const SurfaceChart chart = chart_of(face, e.surface, e.voxel_mm);
      for (const ChartPoint& p : chart.points()) {
        const double u = along.dot(p.u_mm * face.u);
        if (u < 0 || u > way.norm()) continue;
        const double z = p.v_mm * face.v.z();
        top = std::max(top, z), bottom = std::min(bottom, z);
      }
    }
    if (top > bottom) {
      depths.clear();
      for (const double d : within_margins(top - bottom, kCircles)) depths.push_back(-top + d);
    }
  }
  std::vector<Vec3> places;
  for (const double depth : depths)
    for (const double s : within_margins(way.norm(), f.points > 0 ? f.points : kStations))
      places.push_back(f.axis_mm[0] + s * along - depth * Vec3::UnitZ());
  evaluate_pair(e, pair, places);
}

void evaluate_wall(Evaluation& e) {
  const Feature& f = e.feature;
  const Vec3 across = (f.axis_mm[1] - f.axis_mm[0]).normalized();
  const Vec3 middle = (f.axis_mm[0] + f.axis_mm[1]) / 2;
  Pair pair;
  pair.middle_mm = middle;
  pair.across = across;
  pair.sign = 1;
  pair.face = {plane_face(middle - f.nominal_mm / 2 * across, -across, 0),
               plane_face(middle + f.nominal_mm / 2 * across, across, 0)};
  const Face& face = pair.face[1];
  std::vector<Vec3> places{middle};
  constexpr int kGrid = 7;
  if (f.extent_mm > 0)
    for (const double u : spread(-f.extent_mm, f.extent_mm, kGrid))
      for (const double v : spread(-f.extent_mm, f.extent_mm, kGrid))
        if (std::hypot(u, v) <= f.extent_mm && std::hypot(u, v) > 0) places.push_back(middle + u * face.u + v * face.v);
  evaluate_pair(e, pair, places);
}

}  // namespace camber::inspect
