#pragma once
// How a control accelerates: the ramp after interpolation, its jerk limit, and the accelerations that traces show.
#include <array>
#include <optional>
#include <vector>

#include "calib/control_laws.h"
#include "calib/fit_drive.h"
#include "calib/fit_feed_model.h"
#include "calib/fit_limits.h"
#include "calib/trace.h"
#include "feedmodel/timed_path.h"
#include "machine/machine_model.h"

namespace camber::calib {

struct FeedRun;

/// Width of the moving average that turns the commands of the plan into those of the traces, least squares over the
/// first 0.4 s of every part that starts from rest, on one axis. Its error: jackknife over five groups of parts.
/// Nothing where no average of 8 periods to 0.25 s makes the difference clearly smaller (a fifth of it at least).
/// `machine`: its limits are fitted; filters and lags are not used.
std::optional<FittedValue> ramp_time_s(const std::vector<FeedRun>& runs, const machine::Machine& machine, int axis);

/// Width of the moving average after interpolation that makes a step of acceleration rise as the commanded path does,
/// from every start out of a rest of 20 ms: time between 10 and 90 % of the first greatest acceleration, over 0.8.
/// Starts whose acceleration does not stay at its greatest for that long tell nothing. The upper quartile of the
/// starts, with their scatter as its error. Nothing where fewer than three starts tell, or where the rise is no longer
/// than the speeds are taken over (8 periods).
std::optional<FittedValue> smoothing_time_s(const std::vector<const ServoTrace*>& traces);

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
