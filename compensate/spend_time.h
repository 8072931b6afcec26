#pragma once
// What costs machine time: lower feeds and second cuts.
#include "compensate/state.h"

namespace camber::compensate {

/// Uses lower feeds and second cuts against the error that no shift removes, in steps of machine time, until the
/// tolerance is kept; with a budget until the error within it is least.
void spend_time(const Task& task, State& state);

}  // namespace camber::compensate
