#include "copymill/slotting.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace camber::copymill {
namespace {

/// Between -pi and pi.
double wrapped(double angle) { return std::remainder(angle, 2 * kPi); }

/// Returns the engagement angle with the axis at angle t of `next`, the cutter moving counter-clockwise.
double engagement_at(double R, const Circle& before, const Circle& next, double t) {
  const Vec2 q = next.centre + next.radius_mm * Vec2(std::cos(t), std::sin(t)) - before.centre;
  const double rho = q.norm(), reach = R + before.radius_mm;
  if (rho + R <= reach) return 0;
  const double cosine = (reach * reach - rho * rho - R * R) / (2 * R * rho);
  const double half = cosine <= -1 ? kPi : std::acos(std::min(1.0, cosine));
  const double middle = wrapped(std::atan2(q.y(), q.x()) - t);
  return std::max(0.0, std::min(middle + half, kPi) - std::max(middle - half, 0.0));
}

Vec2 on(const Circle& circle, double angle) {
  return circle.centre + circle.radius_mm * Vec2(std::cos(angle), std::sin(angle));
}

/// Returns the angle of the place on both circles' right (left) side, seen along the way.
double leaving_angle(const Circle& from, const Circle& to, bool counter_clockwise) {
  const Vec2 way = to.centre - from.centre;
  return std::atan2(way.y(), way.x()) + (counter_clockwise ? -0.5 : 0.5) * kPi;
}

PathPiece arc(const Vec3& from, const Vec3& to, const Vec2& centre, bool counter_clockwise, double increment) {
  PathPiece out = line_piece(from, to);
  out.arc = true;
  const Vec2 spoke = centre - from.head<2>();
  out.centre = from.head<2>() + rounded({spoke.x(), spoke.y(), 0}, increment).head<2>();
  const Vec2 a = from.head<2>() - out.centre, b = to.head<2>() - out.centre;
  const double turn = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  out.sweep_rad = counter_clockwise ? (turn > 0 ? turn : turn + 2 * kPi) : (turn < 0 ? turn : turn - 2 * kPi);
  out.length_mm = std::abs(out.sweep_rad) * out.radius_mm();
  return out;
}

}  // namespace

double engagement_angle_rad(double R, double radial_depth) {
  return radial_depth >= 2 * R ? kPi : std::acos(1 - radial_depth / R);
}

double greatest_engagement_rad(double R, const Circle& before, const Circle& next) {
  constexpr int kSteps = 360;
  constexpr double kStep = 2 * kPi / kSteps;
  const auto at = [&](double t) { return engagement_at(R, before, next, t); };
  int best = 0;
  double most = -1;
  for (int k = 0; k < kSteps; ++k)
    if (const double e = at(k * kStep); e > most) most = e, best = k;
  double lo = (best - 1) * kStep, hi = (best + 1) * kStep;
  constexpr double kGolden = 0.6180339887498949;
  for (int i = 0; i < 20; ++i) {
    const double a = hi - kGolden * (hi - lo), b = lo + kGolden * (hi - lo);
    (at(a) > at(b) ? hi : lo) = at(a) > at(b) ? b : a;
  }
  return std::max(most, at(0.5 * (lo + hi)));
}

double outward_rad(const Circle& before, const Circle& next) {
  return std::max(0.0, std::atan2(next.radius_mm - before.radius_mm, (next.centre - before.centre).norm()));
}

double trochoid_step_mm(double R, double r, double limit) {
  assert(R > 0 && r > 0 && limit > 0 && limit < kPi);
  double fits = 0, exceeds = 2 * (R + r);
  for (int i = 0; i < 30; ++i) {
    const double p = 0.5 * (fits + exceeds);
    (greatest_engagement_rad(R, {Vec2::Zero(), r}, {Vec2(p, 0), r}) <= limit ? fits : exceeds) = p;
  }
  return fits;
}

Vec2 start_of(const std::vector<Circle>& circles, bool counter_clockwise) {
  assert(!circles.empty());
  const Circle& first = circles.front();
  return on(first, circles.size() > 1 ? leaving_angle(first, circles[1], counter_clockwise) : 0);
}

std::vector<PathPiece> trochoid(const std::vector<Circle>& circles, double z, bool ccw, double increment) {
  std::vector<PathPiece> out;
  if (circles.empty()) return out;
  const auto place = [&](const Vec2& p) { return rounded({p.x(), p.y(), z}, increment); };
  const Vec2 start = start_of(circles, ccw) - circles.front().centre;
  double in = std::atan2(start.y(), start.x());
  Vec3 at = place(start_of(circles, ccw));
  for (std::size_t k = 0; k < circles.size(); ++k) {
    const Circle& circle = circles[k];
    const bool last = k + 1 == circles.size();
    const double leave = last ? in : leaving_angle(circle, circles[k + 1], ccw);
    const Vec3 half = place(on(circle, in + kPi)), end = place(on(circle, leave));
    out.push_back(arc(at, half, circle.centre, ccw, increment));
    if ((end - half).norm() > 0) out.push_back(arc(half, end, circle.centre, ccw, increment));
    at = end;
    if (last) break;
    in = leave;
    const Vec3 next = place(on(circles[k + 1], in));
    if ((next - at).norm() > 0) out.push_back(line_piece(at, next));
    at = next;
  }
  return out;
}

}  // namespace camber::copymill
