#include "repath/compress/fit.h"

#include <algorithm>
#include <cmath>

namespace camber::repath {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Signed angle from a to b, both of about the same length.
double angle_between(const Vec2& a, const Vec2& b) {
  const double s = cross(a, b), c = a.dot(b);
  const double t = s / c;
  if (c > 0 && std::abs(t) < 0.05) {  // atan's series: the error is below t^7 / 7
    const double u = t * t;
    return t * (1 - u * (1.0 / 3 - u / 5));
  }
  return std::atan2(s, c);
}

}  // namespace

namespace {

/// Points as `at` tells them, two coordinates or three.
template <class Point, class At>
std::optional<double> deviation_of_line(std::uint32_t first, std::uint32_t last, double max_backwards_mm, At at) {
  const Point start = at(first), chord = at(last) - start;
  const double length = chord.norm();
  if (length == 0) return std::nullopt;
  const Point along = chord / length;
  double worst = 0, farthest = 0;
  for (std::uint32_t k = first + 1; k < last; ++k) {
    const Point p = at(k) - start;
    const double u = p.dot(along);
    if (u < farthest - max_backwards_mm) return std::nullopt;
    farthest = std::max(farthest, u);
    worst = std::max(worst, (p - std::clamp(u, 0.0, length) * along).norm());
  }
  if (farthest > length + max_backwards_mm) return std::nullopt;
  return worst;
}

}  // namespace

std::optional<double> line_deviation(std::span<const Vec2> points, std::uint32_t first, std::uint32_t last,
                                     double max_backwards_mm) {
  return deviation_of_line<Vec2>(first, last, max_backwards_mm,
                                 [&](std::uint32_t k) -> const Vec2& { return points[k]; });
}

std::optional<double> line_deviation(std::span<const Vec2> points, std::span<const double> heights, std::uint32_t first,
                                     std::uint32_t last, double max_backwards_mm) {
  return deviation_of_line<Vec3>(first, last, max_backwards_mm,
                                 [&](std::uint32_t k) { return Vec3(points[k].x(), points[k].y(), heights[k]); });
}

double helix_deviation(std::span<const Vec2> points, std::span<const double> heights, std::uint32_t first,
                       std::uint32_t last, const Vec2& center_mm, double sweep_rad) {
  const double pitch = (heights[last] - heights[first]) / sweep_rad;  // mm a radian, with the sweep's sign
  const double low = std::min(0.0, sweep_rad), high = std::max(0.0, sweep_rad);
  double worst = 0, angle = 0;
  Vec2 from = points[first] - center_mm;
  for (std::uint32_t k = first; k < last; ++k) {
    const Vec2 to = points[k + 1] - center_mm, edge = to - from;
    const double rise = heights[k + 1] - heights[k], turn = cross(from, to);
    const auto away = [&](double at_angle, double height) {
      return std::abs(height - heights[first] - pitch * std::clamp(at_angle, low, high));
    };
    // |from + t edge|^2 = pitch turn / rise
    const double a = edge.squaredNorm(), b = from.dot(edge), wanted = rise != 0 ? pitch * turn / rise : 0;
    const double root = b * b - a * (from.squaredNorm() - wanted);
    if (a > 0 && wanted > 0 && root >= 0)
      for (const double t : {(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a})
        if (t > 0 && t < 1)
          worst = std::max(worst, away(angle + angle_between(from, from + t * edge), heights[k] + t * rise));
    angle += angle_between(from, to);
    if (k + 1 < last) worst = std::max(worst, away(angle, heights[k + 1]));
    from = to;
  }
  return worst;
}

ArcShape arc_shape(const Vec2& start, const Vec2& end, const Vec2& center_mm, int direction) {
  const double r0 = (start - center_mm).norm(), r1 = (end - center_mm).norm();
  return {center_mm, 0.5 * (r0 + r1), std::abs(r1 - r0), direction};
}

std::optional<ArcFit> arc_deviation(std::span<const Vec2> points, std::uint32_t first, std::uint32_t last,
                                    const ArcShape& arc, double max_mm, double max_backwards_mm) {
  const double room = max_mm - 0.5 * arc.radius_difference_mm;
  if (room < 0) return std::nullopt;
  const double backwards_rad = max_backwards_mm / arc.radius_mm;
  Vec2 from = points[first] - arc.center_mm;
  double worst = 0, angle = 0, farthest = 0, least = 0;
  for (std::uint32_t k = first + 1; k <= last; ++k) {
    const Vec2 to = points[k] - arc.center_mm;
    const Vec2 edge = to - from;
    const double away = std::abs(to.norm() - arc.radius_mm);
    if (k < last) worst = std::max(worst, away);
    // The foot of the perpendicular from the centre, where it lies on the edge.
    const double length2 = edge.squaredNorm(), u = -from.dot(edge);
    if (u > 0 && u < length2) {
      const double c = cross(from, edge);
      worst = std::max(worst, std::abs(arc.radius_mm - std::sqrt(c * c / length2)));
    }
    if (worst > room) return std::nullopt;
    if (from.dot(to) <= 0) return std::nullopt;  // a quarter turn in one edge: too coarse to be an arc
    angle += arc.direction * angle_between(from, to);
    if (angle < farthest - backwards_rad) return std::nullopt;
    farthest = std::max(farthest, angle);
    least = std::min(least, angle);
    from = to;
  }
  const double end_slack = 1e-6;  // of a full turn, summed up
  if (angle <= 0 || angle > 2 * kPi + end_slack || farthest > angle + backwards_rad) return std::nullopt;
  // Past an end of the arc the nearest point is that end.
  const double past_mm = arc.radius_mm * std::max(farthest - angle, -least);
  if (past_mm > 0) worst = std::hypot(worst, past_mm);
  if (worst > room) return std::nullopt;
  return ArcFit{worst + 0.5 * arc.radius_difference_mm, arc.direction * std::min(angle, 2 * kPi)};
}

}  // namespace camber::repath
