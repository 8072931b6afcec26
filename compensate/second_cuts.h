#pragma once
// Versions of the program in which runs are cut twice or more.
#include <memory>
#include <vector>

#include "compensate/passes.h"
#include "compensate/state.h"

namespace camber::compensate {

/// The runs with what the best shifts leave of each. `given`: the version of the given program; its path has those
/// shifts afterwards.
std::vector<PassRun> runs_after_shifts(const Task& task, Version& given);

/// A version that takes over from the given program what stays. `program`: its own, with the cuts of `repeated`.
std::unique_ptr<Version> taken_over(const Task& task, const Version& given, const machine::Job& job,
                                    simulate::SimulatedProgram program, EarlierCuts repeated);

struct SecondCutVersion {
  std::unique_ptr<Version> version{};  ///< null: none of the runs can be cut again
  bool too_slow = false;               ///< runs were left out for want of time
};

/// The given program with the chosen runs cut again, as often as they are chosen, within `allowed_s` of machine time.
/// The path of `given` has the shifts of the first cuts afterwards.
SecondCutVersion version_with(const Task& task, Version& given, const std::vector<PassRun>& runs,
                              std::vector<std::size_t> chosen, double allowed_s);

// Levers that a compensation has not used, where the tolerance is missed on a part that yields

/// Second cuts where no run is cut again, and lower feeds where no feed is changed, each for up to twice more machine
/// time and where it is expected to take a tenth or more off the 95th percentile of the best round. No prediction is
/// made: a cut once more leaves kLeftByCut, a lower feed what its model says.
std::vector<LeverOutlook> unused_levers(const Task& task, const State& state);

}  // namespace camber::compensate
