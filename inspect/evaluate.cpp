#include "inspect/evaluate.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/numbers.h"
#include "inspect/fits.h"
#include "inspect/probe.h"

namespace camber::inspect {
namespace {

using machine::Feature;
using machine::FeatureFilter;
using machine::FeatureKind;
using Places = std::vector<std::array<double, 2>>;

constexpr int kAngles = 72;      // of a circle, unless the instrument's are given
constexpr int kCircles = 9;      // along an axis
constexpr int kStations = 24;    // along a wall
constexpr double kMargin = 0.1;  // of a length, at either end: nobody measures at an edge
constexpr double kFar_mm2 = 1e12;

/// `count` places from `from` to `to`, both among them.
std::vector<double> spread(double from, double to, int count) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(count > 1 ? from + (to - from) * i / (count - 1) : (from + to) / 2);
  return out;
}

std::vector<double> within_margins(double length, int count) {
  return spread(kMargin * length, (1 - kMargin) * length, count);
}

struct Line {
  double at_zero = 0, slope = 0;
};
/// Least squares y = at_zero + slope x; level where there are fewer than two different x.
Line fit_line(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sx += x[i], sy += y[i], sxx += x[i] * x[i], sxy += x[i] * y[i];
  const double det = n * sxx - sx * sx;
  if (!(det > 1e-12 * n * sxx)) return {n > 0 ? sy / n : 0, 0};
  const double slope = (n * sxy - sx * sy) / det;
  return {(sy - slope * sx) / n, slope};
}

double spread_of(const std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto [least, greatest] = std::ranges::minmax(values);
  return greatest - least;
}

/// A feature being evaluated.
struct Evaluation {
  const Feature& feature;
  std::span<const removal::SurfacePoint> surface;
  double voxel_mm;
  FeatureResult& out;
  std::array<Vec3, 3> middle_mm{};  ///< of the feature as programmed, with contour error, and machined (Layer)
  std::vector<Vec3> constrained{};  ///< unit directions along which its place is known
  bool placed = false;

  const Vec3& machined_middle_mm() const { return middle_mm[2]; }
  bool failed(const Probing& probing) {
    out.readings += probing.readings.size();
    out.missed += probing.missed;
    if (probing.enough()) return false;
    out.reason = probing.readings.empty() && probing.missed == 0
                     ? "there is no surface of the job's operations"
                     : fmt::format("{} of {} places have no surface of the job's operations, or are beyond the model",
                                   probing.missed, probing.missed + probing.readings.size());
    return true;
  }
  void set_sizes(double nominal, double contour, double machined) {
    out.commanded_mm = nominal;
    out.contour_um = 1000 * (contour - nominal);
    out.deflection_um = 1000 * (machined - contour);
    out.predicted_mm = machined;
  }
};

// --- bores and bosses

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

// --- planes and walls

/// Places of a grid over the reach of a face, or over all of its points.
Places grid_of(const Face& face, const SurfaceChart& chart, int points) {
  double lo_u = -face.reach_mm, hi_u = face.reach_mm, lo_v = lo_u, hi_v = hi_u;
  if (face.reach_mm == 0) {
    lo_u = lo_v = 1e300, hi_u = hi_v = -1e300;
    for (const ChartPoint& p : chart.points()) {
      lo_u = std::min(lo_u, p.u_mm), hi_u = std::max(hi_u, p.u_mm);
      lo_v = std::min(lo_v, p.v_mm), hi_v = std::max(hi_v, p.v_mm);
    }
    const double mu = kMargin / 2 * (hi_u - lo_u), mv = kMargin / 2 * (hi_v - lo_v);
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

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double size_by(const std::vector<double>& sizes, FeatureFilter filter) {
  return filter == FeatureFilter::min_zone ? *std::ranges::min_element(sizes) : mean_of(sizes);
}

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

// --- points

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

// --- distances

/// Of two surfaces that face along the line through the two points.
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

/// Of the middles of two other features, along the line between their nominal places and across their axes.
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

void evaluate_alone(Evaluation& e) {
  switch (e.feature.kind) {
    case FeatureKind::plane:
      return evaluate_plane(e);
    case FeatureKind::bore:
    case FeatureKind::boss:
      return evaluate_cylinder(e);
    case FeatureKind::slot_width:
      return evaluate_slot(e);
    case FeatureKind::wall:
      return evaluate_wall(e);
    case FeatureKind::points:
      return evaluate_points(e);
    case FeatureKind::distance:
      if (e.feature.of[0].empty()) evaluate_point_distance(e);
      return;
  }
}

// --- alignment

/// Where a feature's middle should be, of those that tell positions.
Vec3 nominal_middle(const Evaluation& e) {
  const Feature& f = e.feature;
  const Vec3 axis = (f.axis_mm[1] - f.axis_mm[0]).normalized();
  if (f.kind == FeatureKind::plane) return f.axis_mm[0] + f.nominal_mm * axis;
  if (e.constrained.size() == 2) return f.axis_mm[0] + axis.dot(e.machined_middle_mm() - f.axis_mm[0]) * axis;
  const Vec3 m = (f.axis_mm[0] + f.axis_mm[1]) / 2;
  return f.kind == FeatureKind::slot_width ? Vec3(m.x(), m.y(), e.machined_middle_mm().z()) : m;
}

/// Shift and small turn (about the origin) that bring the features of the alignment nearest to their places.
Eigen::Matrix<double, 6, 1> alignment(const std::vector<Evaluation>& all) {
  std::vector<Eigen::Matrix<double, 1, 6>> rows;
  std::vector<double> off;
  for (const Evaluation& e : all) {
    if (!e.feature.align || !e.placed) continue;
    const Vec3 place = nominal_middle(e);
    for (const Vec3& n : e.constrained) {
      Eigen::Matrix<double, 1, 6> row;
      row << n.transpose(), place.cross(n).transpose();
      rows.push_back(row);
      off.push_back(n.dot(e.machined_middle_mm() - place));
    }
  }
  if (rows.empty()) return Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::MatrixXd a(static_cast<Eigen::Index>(rows.size()), 6);
  for (std::size_t i = 0; i < rows.size(); ++i) a.row(static_cast<Eigen::Index>(i)) = rows[i];
  return a.completeOrthogonalDecomposition().solve(
      Eigen::Map<const Eigen::VectorXd>(off.data(), static_cast<Eigen::Index>(off.size())));
}

void set_positions(std::vector<Evaluation>& all) {
  const Eigen::Matrix<double, 6, 1> motion = alignment(all);
  for (Evaluation& e : all) {
    if (!e.placed) continue;
    const Vec3 place = nominal_middle(e);
    const Vec3 moved = motion.head<3>() + motion.tail<3>().cross(place);
    Vec3 off = Vec3::Zero();
    for (const Vec3& n : e.constrained) off += n.dot(e.machined_middle_mm() - place - moved) * n;
    e.out.position_um = 1000 * off;
  }
}

void set_given(FeatureResult& r, const Feature& f, const ModelError& error) {
  r.feature = f.name;
  r.kind = f.kind;
  r.nominal_mm = f.nominal_mm;
  r.measured_mm = machine::measured_mean_mm(f);
  if (f.tol_mm) r.lower_mm = f.nominal_mm + (*f.tol_mm)[0], r.upper_mm = f.nominal_mm + (*f.tol_mm)[1];
  if (!r.predicted_mm) return;
  const double of_size = std::abs(f.size_per_diameter()) * error.size_mm;
  r.std_mm = std::hypot(error.deflection * r.deflection_um / 1000, error.contour * r.contour_um / 1000, of_size);
}

std::string cell(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value + 0.0, decimals) : std::string();
}

/// A name with a comma or a quote stands in quotes.
std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"\n") == std::string::npos) return name;
  std::string out = "\"";
  for (const char c : name) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

}  // namespace

std::vector<FeatureResult> evaluate(const std::vector<Feature>& features,
                                    std::span<const removal::SurfacePoint> surface, double voxel_mm,
                                    const ModelError& error) {
  std::vector<FeatureResult> out(features.size());
  std::vector<Evaluation> all;
  all.reserve(features.size());
  for (std::size_t i = 0; i < features.size(); ++i)
    evaluate_alone(all.emplace_back(Evaluation{features[i], surface, voxel_mm, out[i]}));
  const auto named = [&](const std::string& name) -> const Evaluation& {
    return *std::ranges::find(all, name, [](const Evaluation& e) { return e.feature.name; });
  };
  for (Evaluation& e : all)
    if (!e.feature.of[0].empty()) evaluate_distance_of(e, named(e.feature.of[0]), named(e.feature.of[1]));
  set_positions(all);
  for (std::size_t i = 0; i < features.size(); ++i) set_given(out[i], features[i], error);
  return out;
}

std::string features_csv(const std::vector<FeatureResult>& results) {
  std::string out =
      "feature,kind,nominal_mm,predicted_mm,std_mm,measured_mm,difference_um,form_um,taper_um,lower_mm,upper_mm,"
      "within\n";
  for (const FeatureResult& r : results) {
    const auto within = r.within();
    out +=
        fmt::format("{},{},{:.6f},{},{},{},{},{},{},{},{},{}\n", quoted(r.feature),
                    machine::kFeatureKindWords[static_cast<std::size_t>(r.kind)], r.nominal_mm, cell(r.predicted_mm, 6),
                    cell(r.std_mm, 6), cell(r.measured_mm, 6), cell(r.difference_um(), 3), cell(r.form_um, 3),
                    cell(r.taper_um, 3), cell(r.lower_mm, 6), cell(r.upper_mm, 6), within ? (*within ? "1" : "0") : "");
  }
  return out;
}

}  // namespace camber::inspect
