#include "copymill/path_piece.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "repath/compress/fit.h"

namespace camber::copymill {

Pass at_height(const FlatPass& pass, double z_mm) {
  Pass out{.points = {}, .closed = pass.closed};
  for (const Vec2& p : pass.points) out.points.emplace_back(p.x(), p.y(), z_mm);
  return out;
}

FlatPass reversed(FlatPass pass) {
  std::ranges::reverse(pass.points);
  return pass;
}

Pass reversed(Pass pass) {
  std::ranges::reverse(pass.points);
  return pass;
}

void start_near(Pass& pass, const Vec3& place) {
  if (!pass.closed) return;
  const auto nearest =
      std::ranges::min_element(pass.points, {}, [&](const Vec3& p) { return (p - place).head<2>().squaredNorm(); });
  std::ranges::rotate(pass.points, nearest);
}

double length_mm(const Pass& pass) {
  double out = 0;
  for (std::size_t k = 1; k < pass.points.size(); ++k) out += (pass.points[k] - pass.points[k - 1]).norm();
  if (pass.closed && !pass.points.empty()) out += (pass.points.front() - pass.points.back()).norm();
  return out;
}

std::vector<Vec3> dense(const Pass& pass, double step_mm) {
  std::vector<Vec3> out;
  const std::size_t n = pass.points.size(), legs = pass.closed ? n : n - 1;
  for (std::size_t k = 0; k < legs; ++k) {
    const Vec3 &a = pass.points[k], &b = pass.points[(k + 1) % n];
    const int parts = std::max(1, static_cast<int>(std::ceil((b - a).norm() / step_mm)));
    for (int i = 0; i < parts; ++i) out.push_back(a + static_cast<double>(i) / parts * (b - a));
  }
  if (!pass.closed && n > 0) out.push_back(pass.points.back());
  return out;
}

std::vector<Pass> stretches(const Pass& pass, double step, const std::function<bool(const Vec3&)>& wanted, double lead,
                            double join) {
  const std::vector<Vec3> points = dense(pass, step);
  const std::size_t n = points.size();
  std::vector<char> in(n);
  for (std::size_t k = 0; k < n; ++k) in[k] = wanted(points[k]) ? 1 : 0;
  if (std::ranges::find(in, 0) == in.end()) return {pass};
  if (std::ranges::find(in, 1) == in.end()) return {};
  // From a place that is not wanted on; an open pass from its beginning.
  const std::size_t first = pass.closed ? static_cast<std::size_t>(std::ranges::find(in, 0) - in.begin()) : 0;
  const auto leads = static_cast<std::ptrdiff_t>(std::ceil(lead / step));
  const auto joins = static_cast<std::ptrdiff_t>(std::ceil(join / step)) + 2 * leads;
  struct Range {
    std::ptrdiff_t from, to;
  };
  std::vector<Range> ranges;
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(n); ++i) {
    if (!in[(first + static_cast<std::size_t>(i)) % n]) continue;
    if (!ranges.empty() && i - ranges.back().to <= joins)
      ranges.back().to = i;
    else
      ranges.push_back({i, i});
  }
  std::vector<Pass> out;
  const auto last = static_cast<std::ptrdiff_t>(n) - 1;
  for (const Range& r : ranges) {
    Pass piece;
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, r.from - leads);
         i <= std::min(last + (pass.closed ? 1 : 0), r.to + leads); ++i)
      piece.points.push_back(points[(first + static_cast<std::size_t>(i)) % n]);
    if (piece.points.size() >= 2) out.push_back(std::move(piece));
  }
  if (pass.closed && out.size() == 1 && out[0].points.size() + static_cast<std::size_t>(joins) >= n) return {pass};
  return out;
}

double distance_mm(const std::vector<Vec3>& line, const Vec3& place) {
  double least2 = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < line.size(); ++k) {
    const Vec3 &a = line[k], way = line[std::min(k + 1, line.size() - 1)] - a;
    const double t = way.squaredNorm() > 0 ? std::clamp((place - a).dot(way) / way.squaredNorm(), 0.0, 1.0) : 0;
    least2 = std::min(least2, (a + t * way - place).squaredNorm());
  }
  return std::sqrt(least2);
}

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
