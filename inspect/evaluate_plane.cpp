// Planes.
#include <algorithm>
#include <cmath>

#include "inspect/evaluation.h"
#include "inspect/fits.h"

namespace camber::inspect {
namespace {

constexpr double kMargin = 0.05;  // of a face's width, at either end

/// Places of a grid over the reach of a face, or over all of its points.
Places grid_of(const Face& face, const SurfaceChart& chart, int points) {
  double lo_u = -face.reach_mm, hi_u = face.reach_mm, lo_v = lo_u, hi_v = hi_u;
  if (face.reach_mm == 0) {
    lo_u = lo_v = 1e300, hi_u = hi_v = -1e300;
    for (const ChartPoint& p : chart.points()) {
      lo_u = std::min(lo_u, p.u_mm), hi_u = std::max(hi_u, p.u_mm);
      lo_v = std::min(lo_v, p.v_mm), hi_v = std::max(hi_v, p.v_mm);
    }
    const double mu = kMargin * (hi_u - lo_u), mv = kMargin * (hi_v - lo_v);
    lo_u += mu, hi_u -= mu, lo_v += mv, hi_v -= mv;
  }
  constexpr int kGrid = 13;
  const int side = points > 0 ? std::max(2, static_cast<int>(std::lround(std::sqrt(points)))) : kGrid;
  Places out;
  for (const double u : spread(lo_u, hi_u, side))
    for (const double v : spread(lo_v, hi_v, side))
      if (face.reach_mm == 0 || std::hypot(u, v) <= face.reach_mm) out.push_back({u, v});
  return out;
}

/// Readings of a plane; a face that is no rectangle has places without surface, which count for nothing where the whole
/// face is probed.
Probing probe_plane(const Face& face, Evaluation& e, int points) {
  const SurfaceChart chart = chart_of(face, e.surface, e.voxel_mm);
  if (chart.empty()) return {};
  Probing probing = probe(chart, grid_of(face, chart, points));
  bool valid = false;
  for (const ChartPoint& p : chart.points()) valid = valid || p.valid;
  if (face.reach_mm == 0 && valid) probing.missed = 0;
  return probing;
}

PlaneFit plane_of(const Face& face, const std::vector<Probed>& readings, Layer layer, FeatureFilter filter) {
  std::vector<Vec3> points;
  for (const Probed& p : readings) points.push_back(place_on(face, p, layer));
  return fit_plane(points, filter);
}

}  // namespace

void evaluate_plane(Evaluation& e) {
  const Feature& f = e.feature;
  const Vec3 along = (f.axis_mm[1] - f.axis_mm[0]).normalized();
  const Face face = plane_face(f.axis_mm[0] + f.nominal_mm * along, along, f.extent_mm);
  const Probing probing = probe_plane(face, e, f.points);
  if (e.failed(probing)) return;
  std::array<double, 3> size{};
  for (const Layer layer : {Layer::nominal, Layer::contour, Layer::machined}) {
    const PlaneFit plane = plane_of(face, probing.readings, layer, f.filter);
    if (!plane.converged) {
      e.out.reason = "the readings do not determine a plane";
      return;
    }
    const double steep = plane.normal.dot(along);
    const auto k = static_cast<std::size_t>(layer);
    size[k] = plane.normal.dot(plane.point_mm - f.axis_mm[0]) / steep;
    e.middle_mm[k] = f.axis_mm[0] + size[k] * along;
    e.out.form_um = 1000 * plane.zone_mm;
  }
  e.set_sizes(size[0], size[1], size[2]);
  e.placed = true;
  e.constrained = {along};
  for (const Probed& p : probing.readings) e.out.deviations_um.push_back(1000 * height_of(p.reading, Layer::machined));
}

}  // namespace camber::inspect
