#pragma once
// Jerk limit of a control, from the rise time of its commanded acceleration after rest.
#include <optional>
#include <vector>

#include "calib/fit_drive.h"
#include "calib/trace.h"

namespace camber::calib {

/// Width of the moving average after interpolation that makes a step of acceleration rise as the commanded path does,
/// from every start out of a rest of 20 ms: time between 10 and 90 % of the first greatest acceleration, over 0.8.
/// Starts whose acceleration does not stay at its greatest for that long tell nothing. The upper quartile of the
/// starts, with their scatter as its error. Nothing where fewer than three starts tell, or where the rise is no longer
/// than the speeds are taken over (8 periods).
std::optional<FittedValue> smoothing_time_s(const std::vector<const ServoTrace*>& traces);

}  // namespace camber::calib
