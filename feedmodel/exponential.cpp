#include "feedmodel/exponential.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace camber::feedmodel {
namespace {

constexpr double kSameFraction = 1e-6;  // T1 and T2 closer than this count as equal: the difference would lose digits

double decay(double t_s, double lag_s) { return lag_s > 0 ? std::exp(-t_s / lag_s) : 0.0; }

bool equal_lags(double t1, double t2) { return std::abs(t1 - t2) <= kSameFraction * std::max(t1, t2); }

}  // namespace

double ExponentialRamp::speed_at(double t_s) const {
  const double change = start_mm_per_s - command_mm_per_s;
  if (t_s <= 0) return t1_s + t2_s > 0 ? start_mm_per_s : command_mm_per_s;
  if (equal_lags(t1_s, t2_s)) {
    const double lag = (t1_s + t2_s) / 2.0;
    return lag > 0 ? command_mm_per_s + change * (1.0 + t_s / lag) * decay(t_s, lag) : command_mm_per_s;
  }
  return command_mm_per_s + change / (t1_s - t2_s) * (t1_s * decay(t_s, t1_s) - t2_s * decay(t_s, t2_s));
}

double ExponentialRamp::distance_at(double t_s) const {
  const double lags = t1_s + t2_s, change = command_mm_per_s - start_mm_per_s;
  const double steady = command_mm_per_s * (t_s - lags) + start_mm_per_s * lags;
  if (t_s <= 0) return 0;
  if (equal_lags(t1_s, t2_s)) return steady + change * (lags + t_s) * decay(t_s, lags / 2.0);
  return steady + change / (t1_s - t2_s) * (t1_s * t1_s * decay(t_s, t1_s) - t2_s * t2_s * decay(t_s, t2_s));
}

double ExponentialRamp::time_of(double distance_mm) const {
  if (distance_mm <= 0) return 0;
  const double lags = t1_s + t2_s;
  if (command_mm_per_s <= 0 && distance_mm >= start_mm_per_s * lags) return std::numeric_limits<double>::infinity();
  // d(t) rises all the way, and after the lags have died out it runs at F: the root lies below this.
  double low = 0, high = command_mm_per_s > 0 ? distance_mm / command_mm_per_s + lags : lags;
  while (distance_at(high) < distance_mm) high *= 2;
  double t = high;
  for (int i = 0; i < 100 && high - low > 1e-13; ++i) {
    const double error = distance_at(t) - distance_mm;
    (error > 0 ? high : low) = t;
    const double speed = speed_at(t);
    const double newton = speed > 0 ? t - error / speed : low;
    const double next = newton > low && newton < high ? newton : (low + high) / 2.0;
    if (std::abs(next - t) < 1e-14) break;
    t = next;
  }
  return t;
}

double ExponentialRamp::approximate_time_of(double distance_mm) const {
  return distance_mm / command_mm_per_s + (1 - start_mm_per_s / command_mm_per_s) * (t1_s + t2_s);
}

double exponential_rest_to_rest_s(double distance_mm, double feed_mm_per_s, double t1_s, double t2_s) {
  return ExponentialRamp{0, feed_mm_per_s, t1_s, t2_s}.time_of(distance_mm) + t1_s + t2_s;
}

}  // namespace camber::feedmodel
