#pragma once
// Accelerations that the commands of servo traces show.
#include <array>
#include <vector>

#include "calib/control_laws.h"
#include "calib/fit_feed.h"
#include "calib/fit_limits.h"
#include "calib/trace.h"

namespace camber::calib {

/// What each axis was commanded at most, over windows of ten periods; the few highest are left out. `rotary`: the
/// traces with a, b, c in place of x, y, z (rotary_trace).
Accelerations traced_accelerations(const std::vector<const ServoTrace*>& traces,
                                   const std::vector<const ServoTrace*>& rotary);

/// Limits of acceleration that ramps on the exact path (G61) keep: the highest second difference of an axis over 2 x 60
/// ms that is the same 10 ms later (within 0.05 %; at least twenty samples), while every other axis stays below its own
/// highest: there the axis itself is what limits. Left out: rounding, under which overlapping blocks add up, and
/// tool-centre-point control, under which axes follow the tip. Value 0: none.
std::array<FittedValue, 6> held_accelerations(const std::vector<FeedRun>& runs);

}  // namespace camber::calib
