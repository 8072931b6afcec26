#include "copymill/path_piece.h"

#include <algorithm>
#include <cmath>

#include "repath/fit.h"

namespace camber::copymill {
namespace {

constexpr double kSteep = 5;  ///< rise over run, above which points in X and Y lie too close for a fit

bool steep(const Vec3& a, const Vec3& b, double increment) {
  const double run = (b - a).head<2>().norm();
  return run < 0.5 * increment || std::abs(b.z() - a.z()) > kSteep * run;
}

void fit_run(const std::vector<Vec3>& points, std::size_t first, std::size_t last, const PieceOptions& options,
             std::vector<PathPiece>& out) {
  std::vector<Vec2> flat;
  std::vector<double> heights;
  bool level = true;
  for (std::size_t k = first; k <= last; ++k) {
    flat.emplace_back(points[k].head<2>());
    heights.push_back(points[k].z());
    level = level && points[k].z() == points[first].z();
  }
  if (level) heights.clear();
  repath::FitOptions fit{.tolerance_mm = options.tolerance_mm, .increment_mm = options.increment_mm};
  for (const repath::Primitive& p : repath::fit({.points = flat, .heights = heights}, fit)) {
    PathPiece piece = line_piece(points[first + p.first], points[first + p.last]);
    if (p.arc) {
      piece.arc = true;
      piece.centre = piece.from.head<2>() + p.center_from_start_mm;
      piece.sweep_rad = p.sweep_rad;
      piece.length_mm = std::abs(p.sweep_rad) * piece.radius_mm();
    }
    out.push_back(piece);
  }
}

}  // namespace

Vec3 PathPiece::at(double along) const {
  const double t = length_mm > 0 ? std::clamp(along / length_mm, 0.0, 1.0) : 1;
  if (!arc) return from + t * (to - from);
  const Vec2 start = from.head<2>() - centre, end = to.head<2>() - centre;
  const double a = t * sweep_rad, c = std::cos(a), s = std::sin(a);
  const Vec2 spoke(c * start.x() - s * start.y(), s * start.x() + c * start.y());
  const double radius = start.norm() + t * (end.norm() - start.norm());  // rounded ends differ by little
  const Vec2 p = centre + radius / start.norm() * spoke;
  return {p.x(), p.y(), from.z() + t * (to.z() - from.z())};
}

Vec3 PathPiece::direction(double along) const {
  if (!arc) return (to - from).normalized();
  const Vec2 spoke = (at(along).head<2>() - centre).normalized();
  const double sign = sweep_rad > 0 ? 1 : -1;
  return {-sign * spoke.y(), sign * spoke.x(), 0};
}

PathPiece line_piece(const Vec3& from, const Vec3& to) {
  return {.from = from, .to = to, .length_mm = (to - from).norm()};
}

PathPiece part_of(const PathPiece& piece, double from_mm, double to_mm, double increment) {
  if (from_mm <= 0 && to_mm >= piece.length_mm) return piece;
  const Vec3 from = from_mm <= 0 ? piece.from : rounded(piece.at(from_mm), increment);
  const Vec3 to = to_mm >= piece.length_mm ? piece.to : rounded(piece.at(to_mm), increment);
  PathPiece out = line_piece(from, to);
  const double sweep = piece.sweep_rad * (to_mm - from_mm) / piece.length_mm;
  constexpr double kShortArc_mm = 0.05;  // rounded ends would bend it
  if (!piece.arc || std::abs(sweep) * piece.radius_mm() < kShortArc_mm) return out;
  out.arc = true;
  out.centre =
      from.head<2>() + rounded({piece.centre.x() - from.x(), piece.centre.y() - from.y(), 0}, increment).head<2>();
  out.sweep_rad = sweep;
  out.length_mm = std::abs(sweep) * out.radius_mm();
  return out;
}

Vec3 rounded(const Vec3& p, double increment) { return ((p / increment).array().round() * increment).matrix(); }

std::vector<PathPiece> pieces_of(const std::vector<Vec3>& given, bool closed, const PieceOptions& options) {
  std::vector<Vec3> points;
  const auto add = [&](const Vec3& p) {
    const Vec3 r = rounded(p, options.increment_mm);
    if (points.empty() || (r - points.back()).norm() > 0.5 * options.increment_mm) points.push_back(r);
  };
  for (const Vec3& p : given) add(p);
  if (closed && !given.empty()) add(given.front());
  std::vector<PathPiece> out;
  std::size_t first = 0;
  for (std::size_t k = 1; k < points.size(); ++k) {
    const bool now = steep(points[k - 1], points[k], options.increment_mm);
    if (now && k - 1 > first) fit_run(points, first, k - 1, options, out);
    if (now) out.push_back(line_piece(points[k - 1], points[k])), first = k;
  }
  if (!points.empty() && points.size() - 1 > first) fit_run(points, first, points.size() - 1, options, out);
  return out;
}

}  // namespace camber::copymill
