#pragma once
// Predicts the given program, and the programs of the rounds.
#include <string>

#include "compensate/state.h"

namespace camber::compensate {

/// Sets up the job and checks what is known before the long work begins. `job`, `options` and `diagnostics` are kept.
/// Throws InputError.
Task open_task(const machine::Job& job, const CompensateOptions& options, Diagnostics& diagnostics);

/// Predicts the given program: fills Task::given, the state before the first round, and of `out` what it says of the
/// given program. Throws InputError and BeyondModel.
State measure_given(Task& task, CompensationResult& out);

/// Predicts the program of a trial with the shifts and feeds of the version's path.
void measure(const Task& task, const Version& version, Trial& trial, const std::string& what);

}  // namespace camber::compensate
