#pragma once
// Versions of the program in which runs are cut twice or more.
#include <memory>
#include <vector>

#include "compensate/passes.h"
#include "compensate/state.h"

namespace camber::compensate {

/// Returns the runs with the error that the best shifts leave of each. `given`: the version of the given program, whose
/// path has those shifts afterwards.
std::vector<PassRun> runs_after_shifts(const Task& task, Version& given);

/// Makes a version from the given program. `program`: the program of the version, with the cuts of `repeated`.
std::unique_ptr<Version> taken_over(const Task& task, const Version& given, const machine::Job& job,
                                    simulate::SimulatedProgram program, EarlierCuts repeated);

struct SecondCutVersion {
  std::unique_ptr<Version> version{};  ///< null: none of the runs can be cut again
  bool too_slow = false;               ///< runs were left out because they would take too much time
};

/// Makes the given program with the chosen runs cut again, as often as they are chosen, within `allowed_s` of machine
/// time. The path of `given` has the shifts of the first cuts afterwards.
SecondCutVersion version_with(const Task& task, Version& given, const std::vector<PassRun>& runs,
                              std::vector<std::size_t> chosen, double allowed_s);

/// The best round's observations, and what the best shifts leave of them.
struct LeftByShifts {
  ShiftPath path;
  std::vector<Observation> of_path;
  std::vector<double> mm, area_mm2;
};
LeftByShifts left_by_shifts(const Task& task, const State& state);

/// Returns lower feeds, and where the part yields and no run is cut again second cuts, each with up to 200 % more
/// machine time than given, if it is expected to take a tenth or more off the 95th percentile of the best round. No
/// prediction is made: one more cut leaves kLeftByCut, a lower feed what its model says.
std::vector<LeverOutlook> unused_levers(const Task& task, const State& state);

}  // namespace camber::compensate
