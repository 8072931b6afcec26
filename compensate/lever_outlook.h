#pragma once
// What levers that a compensation has not used would bring, where the tolerance is missed on a part that yields.
#include <vector>

#include "compensate/state.h"

namespace camber::compensate {

/// Second cuts where no run is cut again, and lower feeds where no feed is changed, each for up to twice more machine
/// time and where it is expected to take a tenth or more off the 95th percentile of the best round. No prediction is
/// made: a cut once more leaves kLeftByCut, a lower feed what its model says.
std::vector<LeverOutlook> unused_levers(const Task& task, const State& state);

}  // namespace camber::compensate
