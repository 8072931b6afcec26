// Bores and bosses.
#include <algorithm>
#include <cmath>

#include "inspect/evaluation.h"
#include "inspect/fits.h"

namespace camber::inspect {
namespace {

constexpr int kAngles = 72;  // of a circle, unless the instrument's are given

std::vector<double> angles_of(const Feature& f) {
  const int count = f.points > 0 ? f.points : kAngles;
  if (f.arc_rad) {
    const double length = (*f.arc_rad)[1] - (*f.arc_rad)[0];
    std::vector<double> out = within_margins(length, count);
    for (double& a : out) a += (*f.arc_rad)[0];
    return out;
  }
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(2 * kPi * i / count);
  return out;
}

Places circle_places(const Feature& f, const std::vector<double>& depths) {
  Places out;
  for (const double v : depths)
    for (const double a : angles_of(f)) out.push_back({f.nominal_mm / 2 * a, v});
  return out;
}

CircleFit circle_of(const Face& face, const std::vector<Probed>& readings, Layer layer, FeatureFilter filter) {
  std::vector<Vec2> points;
  for (const Probed& p : readings) {
    const Vec3 r = place_on(face, p, layer) - face.origin_mm;
    points.emplace_back(face.u.dot(r), face.v.dot(r));
  }
  return fit_circle(points, filter);
}

CylinderFit cylinder_of(const Face& face, const std::vector<Probed>& readings, Layer layer, FeatureFilter filter) {
  std::vector<Vec3> points;
  for (const Probed& p : readings) points.push_back(place_on(face, p, layer));
  return fit_cylinder(points, face.w, filter);
}

/// Roundness, straightness of the axis and taper from circles along the axis.
void add_circles(Evaluation& e, const Face& face, const SurfaceChart& chart, double length) {
  std::vector<double> depth, diameter;
  std::vector<Vec2> centre;
  double roundness = 0;
  for (const double v : within_margins(length, kCircles)) {
    const Probing ring = probe(chart, circle_places(e.feature, {v}));
    if (!ring.enough()) continue;
    const CircleFit c = circle_of(face, ring.readings, Layer::machined, FeatureFilter::least_squares);
    if (!c.converged) continue;
    depth.push_back(v);
    diameter.push_back(2 * c.radius_mm);
    centre.push_back(c.centre_mm);
    roundness = std::max(roundness, c.zone_mm);
  }
  if (depth.size() < 2) return;
  e.out.roundness_um = 1000 * roundness;
  e.out.taper_um = -1000 * fit_line(depth, diameter).slope * length;
  std::vector<double> x, y;
  for (const Vec2& c : centre) x.push_back(c.x()), y.push_back(c.y());
  const Line lx = fit_line(depth, x), ly = fit_line(depth, y);
  double off = 0;
  for (std::size_t i = 0; i < depth.size(); ++i)
    off = std::max(off, std::hypot(x[i] - lx.at_zero - lx.slope * depth[i], y[i] - ly.at_zero - ly.slope * depth[i]));
  e.out.straightness_um = 2000 * off;
}

}  // namespace

void evaluate_cylinder(Evaluation& e) {
  const Feature& f = e.feature;
  const Face face = cylinder_face(f);
  const SurfaceChart chart = chart_of(face, e.surface, e.voxel_mm);
  const double length = (f.axis_mm[1] - f.axis_mm[0]).norm();
  const Probing probing =
      probe(chart, circle_places(f, f.depth_mm ? std::vector{*f.depth_mm} : within_margins(length, kCircles)));
  if (e.failed(probing)) return;
  std::array<double, 3> size{};
  bool converged = true;
  for (const Layer layer : {Layer::nominal, Layer::contour, Layer::machined}) {
    const auto k = static_cast<std::size_t>(layer);
    if (f.depth_mm) {
      const CircleFit c = circle_of(face, probing.readings, layer, f.filter);
      size[k] = 2 * c.radius_mm, converged = converged && c.converged;
      e.out.form_um = 1000 * c.zone_mm;
      e.middle_mm[k] = face.origin_mm + c.centre_mm[0] * face.u + c.centre_mm[1] * face.v + *f.depth_mm * face.w;
    } else {
      const CylinderFit c = cylinder_of(face, probing.readings, layer, f.filter);
      size[k] = 2 * c.radius_mm, converged = converged && c.converged;
      e.out.form_um = 1000 * c.zone_mm;
      e.middle_mm[k] = c.point_mm;
    }
  }
  if (!converged) {
    e.out.form_um.reset();
    e.out.reason = "the readings do not determine a circle";
    return;
  }
  e.set_sizes(size[0], size[1], size[2]);
  e.placed = true;
  e.constrained = {face.u, face.v};
  for (const Probed& p : probing.readings) e.out.deviations_um.push_back(1000 * height_of(p.reading, Layer::machined));
  if (length > 0) add_circles(e, face, chart, length);
}

}  // namespace camber::inspect
