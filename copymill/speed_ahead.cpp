#include "copymill/speed_ahead.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace camber::copymill {
namespace {

/// The greatest speed v at the end of a tick from which a limit can be kept: v^2 <= u^2 + 2 a (D - (v0 + v) dt / 2).
/// Returns the speed for a limit that lies within the tick, where the speed must be u: u^2 >= v0^2 + 2 D (v - v0) / dt.
double greatest_speed(double v0, const SpeedLimit& limit, double a, double dt) {
  const double u2 = limit.speed_mm_per_s * limit.speed_mm_per_s, way = limit.distance_mm;
  const double right = u2 + 2 * a * way - a * v0 * dt;
  const double v = right <= 0 ? 0 : 0.5 * (std::sqrt(a * a * dt * dt + 4 * right) - a * dt);
  if (0.5 * (v0 + v) * dt <= way) return v;
  return way > 0 ? std::min(v, v0 + (u2 - v0 * v0) / (2 * way) * dt) : v;
}

}  // namespace

TickMotion next_tick(double v0, double wanted, std::span<const SpeedLimit> ahead, double a, double dt) {
  assert(v0 >= 0 && wanted >= 0 && a > 0 && dt > 0);
  double v = std::min(wanted, v0 + a * dt), stop = -1;
  for (const SpeedLimit& limit : ahead) {
    v = std::min(v, greatest_speed(v0, limit, a, dt));
    if (limit.speed_mm_per_s == 0 && (stop < 0 || limit.distance_mm < stop)) stop = limit.distance_mm;
  }
  v = std::max({v, v0 - a * dt, 0.0});
  TickMotion out{v, 0.5 * (v0 + v) * dt};
  // At rest before the tick is over, and where a stop is asked for there.
  if (v == 0) {
    const double least = stopping_distance_mm(v0, a);
    out.distance_mm = stop >= 0 && stop <= out.distance_mm ? std::max(stop, least) : least;
  }
  return out;
}

double stopping_distance_mm(double speed_mm_per_s, double acceleration_mm_per_s2) {
  return speed_mm_per_s * speed_mm_per_s / (2 * acceleration_mm_per_s2);
}

double acceleration_along(const machine::Machine& machine, const Vec3& direction) {
  double out = machine.control.path_acceleration_mm_per_s2;
  const double length = direction.norm();
  for (int axis = 0; axis < 3; ++axis)
    if (const double share = std::abs(direction[axis]) / length; share > 0)
      out = std::min(out, machine.axis[static_cast<std::size_t>(axis)].acceleration_mm_per_s2 / share);
  return out;
}

}  // namespace camber::copymill
