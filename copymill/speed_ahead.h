#pragma once
// Speed ahead: chooses the speed of each tick so that limits ahead can be kept by braking.
#include <span>

#include "base/geometry.h"
#include "machine/machine.h"

namespace camber::copymill {

/// A speed limit at a distance along the path from here; 0: a stop there.
struct SpeedLimit {
  double distance_mm = 0, speed_mm_per_s = 0;
};

/// Motion in one tick, with even acceleration; where it ends at rest, with an even one to rest and then none.
struct TickMotion {
  double speed_mm_per_s = 0;  ///< speed at its end
  double distance_mm = 0;
};

/// Returns the motion as near to `wanted_mm_per_s` as the acceleration allows, such that every limit can still be kept
/// by braking with that acceleration. Limits that could be kept at the tick's beginning, by this rule, can be kept at
/// its end; of limits nearer than braking allows it makes the best.
TickMotion next_tick(double speed_mm_per_s, double wanted_mm_per_s, std::span<const SpeedLimit> ahead,
                     double acceleration_mm_per_s2, double tick_s);

/// Returns the way from a speed to rest, v^2 / (2 a).
double stopping_distance_mm(double speed_mm_per_s, double acceleration_mm_per_s2);

/// The greatest acceleration along a direction that asks no axis for more than its own; the path's own limit counts
/// too.
double acceleration_along(const machine::Machine& machine, const Vec3& direction);

}  // namespace camber::copymill
