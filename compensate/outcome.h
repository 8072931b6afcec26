#pragma once
// The figures of the program that is written, and its text.
#include <span>

#include "base/diagnostics.h"
#include "compensate/state.h"
#include "nc/emit.h"

namespace camber::compensate {

/// Fills `out` with what the best round made. `better`: see choose(). Throws InputError where its axes leave their
/// travel.
void conclude(const Task& task, State& state, bool better, CompensationResult& out);

/// The other grids and the uncertainty; the text last, since its header may tell of them.
void check_outcome(const Task& task, const State& state, CompensationResult& out);

/// Adds one warning [not-emitted] for each kind of block, at its first line, with the lines (at most eight of them).
void warn_of_not_emitted(const nc::Program& program, const nc::Interpretation& moves,
                         std::span<const nc::EditNotMade> not_made, Diagnostics& diagnostics);

}  // namespace camber::compensate
