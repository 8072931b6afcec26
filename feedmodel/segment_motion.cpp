#include "feedmodel/segment_motion.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

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

namespace {

/// Beyond this fraction of its time a delay would reverse the motion; the whole phase is slowed instead.
constexpr double kMaxDelay = 2.0 / 3.0;

double distance_along(const SegmentMotion& m, double t_s) {
  const Trapezoid& p = m.along;
  const double accelerate_s = p.accelerate_s + m.accelerate_extra_s, brake_s = p.brake_s + m.brake_extra_s;
  if (t_s < accelerate_s) return p.distance_at(planned_time(t_s, p.accelerate_s, m.accelerate_extra_s));
  if (t_s < accelerate_s + p.cruise_s) return p.distance_at(t_s - m.accelerate_extra_s);
  const double into_brake = std::min(t_s, m.duration_s) - (m.duration_s - brake_s);
  return p.distance_at(p.accelerate_s + p.cruise_s + planned_time(into_brake, p.brake_s, m.brake_extra_s));
}

/// The ramp as it is; where the segment ends in a stop, its last T1 + T2 (all of it, if it is shorter) are run ever
/// slower, so that the stop takes the T1 + T2 more that eqs. 4-5 have for it.
double distance_exponential(const SegmentMotion& m, double t_s, double length_mm) {
  if (t_s >= m.duration_s) return length_mm;
  const double extra_s = m.duration_s - m.ramp_s, slowed_s = std::min(m.ramp_s, extra_s);
  const double before_s = m.ramp_s - slowed_s;
  if (t_s <= before_s || slowed_s <= 0) return std::min(length_mm, m.ramp.distance_at(std::min(t_s, m.ramp_s)));
  const double left = 1.0 - (t_s - before_s) / (slowed_s + extra_s);
  const double t = before_s + slowed_s * (1.0 - std::pow(left, (slowed_s + extra_s) / slowed_s));
  return std::min(length_mm, m.ramp.distance_at(t));
}

}  // namespace

double planned_time(double t_s, double plain_s, double extra_s) {
  if (t_s <= 0) return 0;
  const double whole_s = plain_s + extra_s;
  if (t_s >= whole_s) return plain_s;
  const double x = t_s / whole_s, fraction = extra_s / whole_s;
  if (fraction > kMaxDelay) return plain_s * x;
  return whole_s * (x - fraction * x * x * (3 - 2 * x));
}

double SegmentMotion::distance_at(const Segment& segment, double t_s) const {
  switch (kind) {
    case Kind::along_path:
      return t_s >= duration_s ? segment.length_mm : distance_along(*this, std::max(0.0, t_s));
    case Kind::overlapping:
      return t_s >= duration_s ? segment.length_mm : along.distance_at(std::max(0.0, t_s) * time_scale);
    case Kind::exponential:
      return distance_exponential(*this, std::max(0.0, t_s), segment.length_mm);
    case Kind::axes_apart:
    case Kind::rest:
      break;
  }
  return 0;
}

Vec3 SegmentMotion::point_at(const Segment& segment, double t_s) const {
  switch (kind) {
    case Kind::along_path:
    case Kind::overlapping:
    case Kind::exponential:
      return segment.point_at(distance_at(segment, t_s));
    case Kind::axes_apart: {
      const double t = planned_time(t_s, axes_s, duration_s - axes_s);
      Vec3 point = segment.start_mm;
      for (int i = 0; i < 3; ++i) point[i] += std::copysign(axes[i].distance_at(t), segment.way_mm[i]);
      return t_s >= duration_s ? Vec3(segment.start_mm + segment.way_mm) : point;
    }
    case Kind::rest:
      break;
  }
  return segment.start_mm;
}

ProgramPose SegmentMotion::pose_at(const Segment& segment, double t_s) const {
  if (kind == Kind::axes_apart) return {point_at(segment, t_s), segment.turn->start_rad};
  return feedmodel::pose_at(segment, distance_at(segment, t_s));
}

SegmentMotion positioning_motion(const Segment& segment, double extra_s) {
  SegmentMotion m;
  m.kind = SegmentMotion::Kind::axes_apart;
  for (int i = 0; i < 3; ++i) {
    m.axes[i] = make_trapezoid(std::abs(segment.way_mm[i]), 0, 0, segment.axis_speed_mm_per_s[i],
                               segment.axis_acceleration_mm_per_s2[i]);
    m.axes_s = std::max(m.axes_s, m.axes[i].duration_s());
  }
  m.duration_s = m.axes_s + extra_s;
  return m;
}

}  // namespace camber::feedmodel
