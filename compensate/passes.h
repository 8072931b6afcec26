#pragma once
// Cutting a run of moves twice or more as a third lever: the cuts before the last leave an allowance, the last one
// takes a thin chip.
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "compensate/fit_shift.h"
#include "compensate/shift_path.h"
#include "nc/repeat.h"
#include "simulate/predict_path.h"

namespace camber::compensate {

/// A run, the machine time of a second cut, and the error that the cut could remove.
struct PassRun {
  nc::CutRun run;
  double time_s = 0;   ///< time of the run and the way back
  double left_mm = 0;  ///< 95th percentile of what the best shift leaves of the error on the surface that it makes
};

/// Errors: [lever-unusable] where no run of the moves to compensate can be cut twice. Warning [not-repeatable] where
/// some cannot. `selected`: one per move.
void check_passes(const simulate::SimulatedProgram& program, const std::vector<bool>& selected,
                  Diagnostics& diagnostics);

/// The runs that can be cut twice. `left_mm`: what the best shift would leave of each observation.
std::vector<PassRun> pass_runs(const simulate::SimulatedProgram& given, const std::vector<bool>& selected,
                               const ShiftPath& path, std::span<const Observation> observations,
                               std::span<const double> left_mm);

/// Fraction that one more cut is expected to leave of the error that no shift removes. The edges of a thinner chip are
/// in the cut over a shorter way, so that a yielding part springs back less: on samples/22-thin-wall the foot of a
/// level, which the flutes pass again, keeps a quarter.
inline constexpr double kLeftByCut = 0.25;

/// Largest number of cuts of a run before its last one: a rigid part needs no more than two cuts in all.
inline int most_passes(const machine::Job& job) { return job.workpiece ? 3 : 1; }

/// Returns the indices of the runs to cut again, ascending, each as often as it is cut before its last cut, at most
/// `most` times: that with the greatest error first, while it fits into `budget_s` and leaves more than `wanted_mm`.
std::vector<std::size_t> choose_passes(std::span<const PassRun> runs, double budget_s, double wanted_mm, int most = 1);

/// Returns the error that is expected to remain at each observation once the chosen runs are cut again, mm.
std::vector<double> left_after_passes_mm(std::span<const PassRun> runs, std::span<const std::size_t> chosen,
                                         const ShiftPath& path, std::span<const Observation> observations,
                                         std::span<const double> left_mm);

/// Returns the allowance of the first of two cuts, mm, where the job gives none: the depth by which the best single cut
/// undercuts the surface and half of its tolerance on top, so that the second one cuts everywhere; at least 20 um, a
/// chip that an edge cuts rather than rubs.
double pass_allowance_mm(double gouge_depth_mm, double tolerance_mm);

/// The given program with the chosen runs' lines of `first_cuts` (an emission of the given program) before them, as
/// often as a run is chosen.
nc::RepeatedText with_first_cuts(const simulate::SimulatedProgram& given, std::span<const PassRun> runs,
                                 std::span<const std::size_t> chosen, const nc::Emission& first_cuts);

/// Returns, for each move of the given program, the move of the repeated one that its line makes; nothing where some of
/// them is another move there (start, end, feed, modal state), `wrong` then the first one.
std::optional<std::vector<std::uint32_t>> moves_in_repeated(const nc::Interpretation& given,
                                                            const nc::Interpretation& repeated,
                                                            const nc::RepeatedText& text, std::uint32_t& wrong);

}  // namespace camber::compensate
