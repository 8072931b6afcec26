#include "repath/primitive.h"

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

std::optional<double> line_deviation(std::span<const Vec2> points, std::uint32_t first, std::uint32_t last,
                                     double most_backwards_mm) {
  const Vec2 start = points[first], chord = points[last] - start;
  const double length = chord.norm();
  if (length == 0) return std::nullopt;
  const Vec2 along = chord / length;
  double worst = 0, farthest = 0;
  for (std::uint32_t k = first + 1; k < last; ++k) {
    const Vec2 p = points[k] - start;
    const double u = p.dot(along), across = std::abs(cross(along, p));
    if (u < farthest - most_backwards_mm) return std::nullopt;
    farthest = std::max(farthest, u);
    const double beyond = u < 0 ? -u : u > length ? u - length : 0;
    worst = std::max(worst, beyond > 0 ? std::hypot(across, beyond) : across);
  }
  if (farthest > length + most_backwards_mm) return std::nullopt;
  return worst;
}

ArcShape arc_shape(const Vec2& start, const Vec2& end, const Vec2& center_mm, int direction) {
  const double r0 = (start - center_mm).norm(), r1 = (end - center_mm).norm();
  return {center_mm, 0.5 * (r0 + r1), std::abs(r1 - r0), direction};
}

std::optional<ArcFit> arc_deviation(std::span<const Vec2> points, std::uint32_t first, std::uint32_t last,
                                    const ArcShape& arc, double most_mm, double most_backwards_mm) {
  const double room = most_mm - 0.5 * arc.radius_difference_mm;
  if (room < 0) return std::nullopt;
  const double backwards_rad = most_backwards_mm / arc.radius_mm;
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
