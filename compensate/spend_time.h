#pragma once
// What costs machine time: lower feeds and second cuts.
#include "compensate/state.h"

namespace camber::compensate {

/// Uses lower feeds and second cuts for what no shift removes, step by step of machine time, until the tolerance is
/// kept; with a budget its least error.
void spend_time(const Task& task, State& state);

}  // namespace camber::compensate
