#include "inspect/fits.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace camber::inspect {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kSteps = 200;
constexpr double kStill_mm = 1e-13;

/// Distances of the points from a shape's axis (or plane), with their derivatives by the shape's parameters.
struct Distances {
  VectorXd value;
  MatrixXd slope;  ///< points x parameters
};
using DistancesAt = std::function<Distances(const VectorXd& parameters)>;

struct Range {
  double least = 0, greatest = 0;
  double zone() const { return greatest - least; }
};

Range range_of(const VectorXd& d) { return {d.minCoeff(), d.maxCoeff()}; }

/// Gauss-Newton for the least sum of (d - r)^2 over the parameters and, with_radius, r. Returns whether it came to
/// rest.
bool least_squares(const DistancesAt& at, bool with_radius, VectorXd& p, double& radius) {
  for (int step = 0; step < kSteps; ++step) {
    const Distances d = at(p);
    const Eigen::Index m = d.value.size(), n = p.size();
    if (!with_radius) radius = 0;
    MatrixXd a(m, n + (with_radius ? 1 : 0));
    a.leftCols(n) = d.slope;
    if (with_radius) a.col(n).setConstant(-1);
    const auto qr = a.colPivHouseholderQr();
    if (qr.rank() < a.cols()) return false;
    const VectorXd dx = qr.solve((VectorXd::Constant(m, radius) - d.value).eval());
    p += dx.head(n);
    if (with_radius) radius += dx[n];
    if (dx.norm() < kStill_mm * std::max(1.0, std::abs(radius))) return true;
  }
  return true;  // at the rounding of the numbers
}

/// Returns what a Chebyshev fit minimizes over the distances: half the zone, minus the least, or the greatest.
double goal(const VectorXd& d, FeatureFilter filter) {
  const Range r = range_of(d);
  switch (filter) {
    case FeatureFilter::max_inscribed:
      return -r.least;
    case FeatureFilter::min_circumscribed:
      return r.greatest;
    default:
      return r.zone() / 2;
  }
}

/// Inequalities of the linearized distances over the step, the radius' change and the goal t.
std::vector<Inequality> linearized(const Distances& d, FeatureFilter filter, double middle) {
  std::vector<Inequality> out;
  const Eigen::Index n = d.slope.cols();
  const auto add = [&](const VectorXd& slope, double r, double t, double bound) {
    Inequality q{VectorXd(n + 2), bound};
    q.row << slope, r, t;
    out.push_back(std::move(q));
  };
  for (Eigen::Index i = 0; i < d.value.size(); ++i) {
    const VectorXd slope = d.slope.row(i);
    const double v = d.value[i] - middle;
    if (filter != FeatureFilter::max_inscribed)  // v + slope dx - dr <= t, without dr for the outer circle
      add(slope, filter == FeatureFilter::min_zone ? -1 : 0, -1, -v);
    if (filter != FeatureFilter::min_circumscribed) add(-slope, filter == FeatureFilter::min_zone ? 1 : 0, -1, v);
  }
  return out;
}

/// Sequential linear programs with a trust region.
bool chebyshev(const DistancesAt& at, FeatureFilter filter, VectorXd& p) {
  Distances d = at(p);
  const double scale = std::max(d.value.cwiseAbs().maxCoeff(), 1e-6);
  double trust = std::max(2 * range_of(d.value).zone(), 1e-9 * scale), best = goal(d.value, filter);
  for (int step = 0; step < kSteps; ++step) {
    const Range r = range_of(d.value);
    const double middle = (r.least + r.greatest) / 2;
    const Eigen::Index n = p.size();
    VectorXd cost = VectorXd::Zero(n + 2), box = VectorXd::Constant(n + 2, trust);
    cost[n + 1] = 1;
    box[n] = box[n + 1] = 4 * (trust * (1 + d.slope.rowwise().norm().maxCoeff()) + r.zone()) + 1e-9 * scale;
    const LinearOptimum step_to = minimize(cost, linearized(d, filter, middle), box);
    if (!step_to.optimal) return false;
    const VectorXd next = p + step_to.x.head(n);
    const Distances there = at(next);
    const double reached = goal(there.value, filter);
    const double way = step_to.x.head(n).norm();
    if (reached < best) {
      const bool at_rest = best - reached < 1e-15 * scale || way < kStill_mm * scale;
      p = next, d = there, best = reached;
      if (at_rest) return true;
      trust *= 2;
    } else {
      if (way < kStill_mm * scale || trust < kStill_mm * scale) return true;
      trust = way / 4;
    }
  }
  return true;
}

Vec3 centroid(std::span<const Vec3> points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

/// Two unit vectors across.
std::array<Vec3, 2> across(const Vec3& axis) {
  const Vec3 u = axis.unitOrthogonal();
  return {u, axis.cross(u)};
}

PlaneFit least_squares_plane(std::span<const Vec3> points) {
  PlaneFit out;
  out.point_mm = centroid(points);
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points) moments += (p - out.point_mm) * (p - out.point_mm).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
  out.normal = solver.eigenvectors().col(0);
  out.converged = solver.eigenvalues()[1] > 1e-12 * solver.eigenvalues()[2];
  return out;
}

VectorXd plane_distances(std::span<const Vec3> points, const PlaneFit& plane) {
  VectorXd d(static_cast<Eigen::Index>(points.size()));
  for (Eigen::Index i = 0; i < d.size(); ++i)
    d[i] = plane.normal.dot(points[static_cast<std::size_t>(i)] - plane.point_mm);
  return d;
}

/// The plane turned by two small angles about directions in it; the distances are exact for any angles.
DistancesAt tilted_plane(std::span<const Vec3> points, const PlaneFit& plane) {
  return [points, plane, uv = across(plane.normal)](const VectorXd& p) {
    Distances out{VectorXd(static_cast<Eigen::Index>(points.size())),
                  MatrixXd(static_cast<Eigen::Index>(points.size()), 2)};
    const Vec3 raw = plane.normal + p[0] * uv[0] + p[1] * uv[1];
    const double length = raw.norm();
    for (Eigen::Index i = 0; i < out.value.size(); ++i) {
      const Vec3 r = points[static_cast<std::size_t>(i)] - plane.point_mm;
      out.value[i] = raw.dot(r) / length;
      for (int k = 0; k < 2; ++k)
        out.slope(i, k) = uv[static_cast<std::size_t>(k)].dot(r) / length - out.value[i] * p[k] / (length * length);
    }
    return out;
  };
}

DistancesAt from_centre(std::span<const Vec2> points) {
  return [points](const VectorXd& p) {
    Distances out{VectorXd(static_cast<Eigen::Index>(points.size())),
                  MatrixXd(static_cast<Eigen::Index>(points.size()), 2)};
    for (Eigen::Index i = 0; i < out.value.size(); ++i) {
      const Vec2 r = points[static_cast<std::size_t>(i)] - Vec2(p[0], p[1]);
      out.value[i] = r.norm();
      out.slope.row(i) = -r.transpose() / std::max(out.value[i], std::numeric_limits<double>::min());
    }
    return out;
  };
}

/// Axis through point + p0 u + p1 v along axis + p2 u + p3 v, the tilts in mm at the half length of the points, so that
/// all four are alike.
DistancesAt from_axis(std::span<const Vec3> points, const CylinderFit& start, double half_length_mm) {
  return [points, start, half_length_mm, uv = across(start.axis)](const VectorXd& p) {
    Distances out{VectorXd(static_cast<Eigen::Index>(points.size())),
                  MatrixXd(static_cast<Eigen::Index>(points.size()), 4)};
    const Vec3 raw = start.axis + (p[2] * uv[0] + p[3] * uv[1]) / half_length_mm;
    const double length = raw.norm();
    const Vec3 axis = raw / length, point = start.point_mm + p[0] * uv[0] + p[1] * uv[1];
    for (Eigen::Index i = 0; i < out.value.size(); ++i) {
      const Vec3 r = points[static_cast<std::size_t>(i)] - point;
      const double along = axis.dot(r);
      const Vec3 out_of = r - along * axis;
      out.value[i] = out_of.norm();
      const Vec3 n = out_of / std::max(out.value[i], std::numeric_limits<double>::min());
      for (int k = 0; k < 2; ++k) {
        const double towards = n.dot(uv[static_cast<std::size_t>(k)]);
        out.slope(i, k) = -towards;
        out.slope(i, 2 + k) = -along * towards / (length * half_length_mm);
      }
    }
    return out;
  };
}

double mean_distance(std::span<const Vec2> points, const Vec2& from) {
  double sum = 0;
  for (const Vec2& p : points) sum += (p - from).norm();
  return sum / static_cast<double>(points.size());
}

/// A first circle without iteration: |x|^2 = 2 c x + k (Kasa). Partial arcs need it; their centroid is no centre.
CircleFit algebraic_circle(std::span<const Vec2> points) {
  CircleFit out;
  Vec2 middle = Vec2::Zero();
  for (const Vec2& p : points) middle += p / static_cast<double>(points.size());
  MatrixXd a(static_cast<Eigen::Index>(points.size()), 3);
  VectorXd b(a.rows());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const Vec2 r = points[static_cast<std::size_t>(i)] - middle;
    a.row(i) << 2 * r[0], 2 * r[1], 1;
    b[i] = r.squaredNorm();
  }
  const auto qr = a.colPivHouseholderQr();
  out.converged = qr.rank() == 3;
  const VectorXd x = qr.solve(b);
  out.centre_mm = middle + Vec2(x[0], x[1]);
  out.radius_mm = mean_distance(points, out.centre_mm);
  return out;
}

double radius_by(const VectorXd& d, FeatureFilter filter) {
  const Range r = range_of(d);
  if (filter == FeatureFilter::max_inscribed) return r.least;
  return filter == FeatureFilter::min_circumscribed ? r.greatest : (r.least + r.greatest) / 2;
}

/// A first axis point: the circle through the points as seen along the axis.
CylinderFit seen_along(std::span<const Vec3> points, const Vec3& axis) {
  CylinderFit out;
  out.axis = axis.normalized();
  const auto uv = across(out.axis);
  const Vec3 c = centroid(points);
  std::vector<Vec2> seen;
  for (const Vec3& p : points) seen.emplace_back(uv[0].dot(p - c), uv[1].dot(p - c));
  const CircleFit circle = fit_circle(seen, FeatureFilter::least_squares);
  out.converged = circle.converged;
  out.point_mm = c + circle.centre_mm[0] * uv[0] + circle.centre_mm[1] * uv[1];
  out.radius_mm = circle.radius_mm;
  return out;
}

double half_length(std::span<const Vec3> points, const CylinderFit& c) {
  double most = 1e-6;
  for (const Vec3& p : points) most = std::max(most, std::abs(c.axis.dot(p - c.point_mm)));
  return most;
}

}  // namespace

PlaneFit fit_plane(std::span<const Vec3> points, FeatureFilter filter) {
  PlaneFit out;
  if (points.size() < 3) return out;
  out = least_squares_plane(points);
  if (!out.converged) return out;
  if (filter == FeatureFilter::min_zone) {
    VectorXd p = VectorXd::Zero(2);
    out.converged = chebyshev(tilted_plane(points, out), FeatureFilter::min_zone, p);
    const auto uv = across(out.normal);
    out.normal = (out.normal + p[0] * uv[0] + p[1] * uv[1]).normalized();
    const Range r = range_of(plane_distances(points, out));
    out.point_mm += (r.least + r.greatest) / 2 * out.normal;
  }
  out.zone_mm = range_of(plane_distances(points, out)).zone();
  return out;
}

CircleFit fit_circle(std::span<const Vec2> points, FeatureFilter filter) {
  CircleFit out;
  if (points.size() < 3) return out;
  out = algebraic_circle(points);
  if (!out.converged) return out;
  const DistancesAt at = from_centre(points);
  VectorXd p(2);
  p << out.centre_mm[0], out.centre_mm[1];
  out.converged = least_squares(at, true, p, out.radius_mm);
  if (out.converged && filter != FeatureFilter::least_squares) {
    out.converged = chebyshev(at, filter, p);
    out.radius_mm = radius_by(at(p).value, filter);
  }
  out.centre_mm = {p[0], p[1]};
  out.zone_mm = range_of(at(p).value).zone();
  return out;
}

CylinderFit fit_cylinder(std::span<const Vec3> points, const Vec3& axis, FeatureFilter filter) {
  CylinderFit out;
  if (points.size() < 5) return out;
  out = seen_along(points, axis);
  if (!out.converged) return out;
  const double half = half_length(points, out);
  const DistancesAt at = from_axis(points, out, half);
  VectorXd p = VectorXd::Zero(4);
  out.converged = least_squares(at, true, p, out.radius_mm);
  if (out.converged && filter != FeatureFilter::least_squares) {
    out.converged = chebyshev(at, filter, p);
    out.radius_mm = radius_by(at(p).value, filter);
  }
  const auto uv = across(out.axis);
  const Vec3 through = out.point_mm + p[0] * uv[0] + p[1] * uv[1];
  out.axis = (out.axis + (p[2] * uv[0] + p[3] * uv[1]) / half).normalized();
  out.point_mm = through + out.axis.dot(centroid(points) - through) * out.axis;
  out.zone_mm = range_of(at(p).value).zone();
  return out;
}

}  // namespace camber::inspect
