#include "feedmodel/profile.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace camber::feedmodel {
namespace {

double time_to(double from, double to, double acceleration) {
  return std::isinf(acceleration) ? 0.0 : std::abs(to - from) / acceleration;
}

/// NaN, the difference of two infinite speeds, counts as reachable.
[[maybe_unused]] bool reachable(double entry, double exit, double limit, double gain) {
  constexpr double kRounding = 1e-6;
  const double most = std::max(entry, exit);
  return !(most > limit * (1 + kRounding)) &&
         !(std::abs(exit * exit - entry * entry) > gain + kRounding * (1 + most * most));
}

}  // namespace

Trapezoid make_trapezoid(double length_mm, double entry_mm_per_s, double exit_mm_per_s, double limit_mm_per_s,
                         double acceleration_mm_per_s2) {
  Trapezoid p;
  p.length = length_mm;
  p.acceleration = acceleration_mm_per_s2;
  p.entry = entry_mm_per_s;
  p.exit = exit_mm_per_s;
  if (length_mm <= 0) return p;
  assert(reachable(p.entry, p.exit, limit_mm_per_s, 2 * p.acceleration * length_mm));
  const double mean_square = (p.entry * p.entry + p.exit * p.exit) / 2.0;
  p.peak = std::min(limit_mm_per_s, std::sqrt(mean_square + p.acceleration * length_mm));
  p.peak = std::max({p.peak, p.entry, p.exit});
  p.accelerate_s = time_to(p.entry, p.peak, p.acceleration);
  p.brake_s = time_to(p.peak, p.exit, p.acceleration);
  const double ramps = (p.entry + p.peak) / 2.0 * p.accelerate_s + (p.peak + p.exit) / 2.0 * p.brake_s;
  p.cruise_s = p.peak > 0 && !std::isinf(p.peak) ? std::max(0.0, length_mm - ramps) / p.peak : 0.0;
  return p;
}

double Trapezoid::distance_at(double t_s) const {
  if (t_s <= 0) return 0;
  if (t_s >= duration_s()) return length;
  if (t_s < accelerate_s) return std::min(length, (entry + 0.5 * acceleration * t_s) * t_s);
  const double after_ramp = (entry + peak) / 2.0 * accelerate_s;
  if (t_s < accelerate_s + cruise_s) return std::min(length, after_ramp + peak * (t_s - accelerate_s));
  const double left = duration_s() - t_s;
  return std::clamp(length - (exit + 0.5 * acceleration * left) * left, 0.0, length);
}

double Trapezoid::speed_at(double t_s) const {
  if (t_s < accelerate_s) return entry + acceleration * std::max(0.0, t_s);
  if (t_s <= accelerate_s + cruise_s) return peak;
  if (t_s >= duration_s()) return exit;
  return exit + acceleration * (duration_s() - t_s);
}

}  // namespace camber::feedmodel
