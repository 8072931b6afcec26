#include "nc/plane_curves.h"

namespace camber::nc {
namespace {

constexpr double kSamePlaceMm = 1e-6;

std::vector<Vec2> of_line(const PlaneCurve& line, const PlaneCurve& circle) {
  const double along = (circle.centre - line.point).dot(line.direction);
  const Vec2 foot = line.point + along * line.direction;
  const double rest = circle.radius * circle.radius - (foot - circle.centre).squaredNorm();
  if (rest < 0) return {};
  const double half = std::sqrt(rest);
  return {foot - half * line.direction, foot + half * line.direction};
}

std::vector<Vec2> of_circles(const PlaneCurve& a, const PlaneCurve& b) {
  const Vec2 across = b.centre - a.centre;
  const double d = across.norm();
  if (d < kSamePlaceMm) return {};
  const double along = (d * d + a.radius * a.radius - b.radius * b.radius) / (2 * d);
  const double rest = a.radius * a.radius - along * along;
  if (rest < 0) return {};
  const Vec2 middle = a.centre + along / d * across, side = std::sqrt(rest) / d * left_of(across);
  return {middle - side, middle + side};
}

}  // namespace

double turn_from(const Vec2& a, const Vec2& b, double sense) {
  double turn = sense * angle_between(a, b);
  if (turn < -1e-9) turn += 2 * kPi;
  return turn;
}

std::vector<Vec2> meetings(const PlaneCurve& a, const PlaneCurve& b) {
  if (a.circle) return b.circle ? of_circles(a, b) : of_line(b, a);
  if (b.circle) return of_line(a, b);
  return {a.point + cross(b.point - a.point, b.direction) / cross(a.direction, b.direction) * a.direction};
}

}  // namespace camber::nc
