#pragma once
// Rounds: shifts are proposed, predicted and judged.
#include "compensate/propose.h"
#include "compensate/state.h"

namespace camber::compensate {

/// Rounds of shifts from the last trial on.
void converge(const Task& task, State& state);

/// Rounds of the shifts of those rounds of the active version that have the feeds of the best one, each where it leaves
/// the least error, while that is expected to lower the 95th percentile or what is worse than given.
void combine_rounds(const Task& task, State& state);

/// Rounds that lift the path where the best round's surface lies deeper than the limit.
void stay_out_of_part(const Task& task, State& state);

/// New shifts from the last trial's error, and their prediction. False: their text is the last trial's, and nothing is
/// predicted.
bool step(const Task& task, State& state, double fraction, const Guard* guard);

/// Predicts a round; the path must have its shifts and feeds.
void run_round(const Task& task, State& state, PlannedRound planned);

}  // namespace camber::compensate
