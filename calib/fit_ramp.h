#pragma once
// The ramp after interpolation: width of the moving average of an axis command.
#include <optional>
#include <vector>

#include "calib/fit_drive.h"
#include "feedmodel/timed_path.h"
#include "machine/machine.h"

namespace camber::calib {

struct FeedRun;

/// Width of the moving average that turns the commands of the plan into those of the traces, least squares over the
/// first 0.4 s of every part that starts from rest, on one axis. Its error: jackknife over five groups of parts.
/// Nothing where no average of 8 periods to 0.25 s makes the difference clearly smaller (a fifth of it at least).
/// `machine`: its limits are fitted; filters and lags are not used.
std::optional<FittedValue> ramp_time_s(const std::vector<FeedRun>& runs, const machine::Machine& machine, int axis);

}  // namespace camber::calib
