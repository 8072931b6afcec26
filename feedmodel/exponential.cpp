#include "feedmodel/exponential.h"

#include <algorithm>
#include <cmath>

namespace camber::feedmodel {
namespace {

constexpr double kApart = 1e-6;  // share by which equal time constants are set apart: the limit to nine digits
constexpr double kShort = 1e-9;  // s; shorter ones are none
constexpr int kNewtonSteps = 100;
constexpr double kTimeTolerance = 1e-12;  // s

double decay(double t_s, double constant_s) { return constant_s < kShort ? 0.0 : std::exp(-t_s / constant_s); }

/// T2, apart from T1.
double second(const Exponential& e) {
  const double apart = kApart * std::max(e.t1_s, kShort);
  return std::abs(e.t1_s - e.t2_s) < apart ? e.t1_s + apart : e.t2_s;
}

}  // namespace

double Exponential::speed_mm_per_s(double t_s) const {
  const double t2 = second(*this);
  return feed_mm_per_s +
         (start_mm_per_s - feed_mm_per_s) / (t1_s - t2) * (t1_s * decay(t_s, t1_s) - t2 * decay(t_s, t2));
}

double Exponential::distance_mm(double t_s) const {
  const double t2 = second(*this), both = t1_s + t2;
  return feed_mm_per_s * (t_s - both) + start_mm_per_s * both +
         (feed_mm_per_s - start_mm_per_s) / (t1_s - t2) * (t1_s * t1_s * decay(t_s, t1_s) - t2 * t2 * decay(t_s, t2));
}

double Exponential::time_s(double distance) const {
  // Bracketed Newton: the distance rises with time, so a root is unique.
  double low = 0, high = std::max(approximate_time_s(distance), kShort);
  while (distance_mm(high) < distance) high *= 2;
  double t = high;
  for (int i = 0; i < kNewtonSteps && high - low > kTimeTolerance; ++i) {
    const double error = distance_mm(t) - distance;
    (error > 0 ? high : low) = t;
    const double speed = speed_mm_per_s(t);
    const double next = speed > 0 ? t - error / speed : low;
    const double to = next > low && next < high ? next : 0.5 * (low + high);
    if (std::abs(to - t) < kTimeTolerance) return to;
    t = to;
  }
  return t;
}

double Exponential::approximate_time_s(double distance) const {
  return distance / feed_mm_per_s + (1 - start_mm_per_s / feed_mm_per_s) * (t1_s + t2_s);
}

}  // namespace camber::feedmodel
