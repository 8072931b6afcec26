#pragma once
// Judges trials: their figures, what is kept of each, and whether another round is worth its prediction.
#include <cstddef>
#include <span>
#include <vector>

#include "compensate/state.h"

namespace camber::compensate {

/// Returns the index of the best round that keeps the limits; 0, the given program, where none does. A round keeps them
/// if its rms is less and its 95th percentile no more than the given program's, and its depth no more than the limit or
/// the given program's, within the time allowed. Of these the ones within the limit come first, then the one of least
/// rms, or of the least 95th percentile where `by_p95` (the feed lever works on that). Of two that differ by less
/// than a tenth in it the one that makes less worse than given (worse_um).
std::size_t choose_round(std::span<const RoundFigures> rounds, double depth_limit_um, bool by_p95 = false);

/// Expected gain of another round of shifts: the mean square m of the error against the fraction t of a fitted step,
///
///   m(t) = m - (2 t - c t^2) R
///
/// with R the mean square that shifts can correct (ErrorSplit::correctable_um, squared). With c = 1 the errors follow
/// the shifts as the fit has it; a round shows the c that they have in truth. The slope at t = 0 is that of the fit.
class StepModel {
 public:
  /// Fits c to a step of `fraction` that changed an error of `rms_um`, correctable as `split` says, to `new_rms_um`.
  /// Where nothing could be corrected, c stays.
  void learn(double rms_um, const ErrorSplit& split, double fraction, double new_rms_um);

  /// Returns the fraction at which m(t) is least, at most `greatest`.
  double best_fraction(double greatest) const;
  /// Returns 2 t - c t^2, the fraction of R that a step removes, from 0 to 1.
  double effect(double fraction) const;
  /// sqrt(m(t)).
  double expected_rms_um(double rms_um, const ErrorSplit& split, double fraction) const;

 private:
  double curvature_ = 1;
};

/// Judged errors, each of an area.
struct JudgedErrors {
  std::vector<double> error_um, area_mm2;
};

PlainFigures figures_of(const Task& task, const Trial& trial);
WorsePlaces worse_of(const Task& task, const Trial& trial);

/// The judged errors of a trial once the fraction `effect` of what shifts can still take away is taken away.
/// The path of `version` has the shifts of the trial afterwards.
JudgedErrors errors_after_shift(const Task& task, Version& version, const Trial& trial, double effect);

/// The fraction `effect` of what shifts can still take away is more than a tenth of a trial's 95th percentile.
bool shift_pays(const Task& task, Version& version, const Trial& trial, double p95_um, double effect);

/// Adds the last trial to the rounds; `round` has what is known of it before its prediction.
void record(const Task& task, State& state, Round round);

/// The last trial becomes the best.
void take(State& state);

/// The best round is within tolerance and depth limit.
bool met(const Task& task, const State& state);

/// The rounds of the active version end; State::ended says why.
bool done(const Task& task, State& state, const StepModel& model);

/// Takes the best round that keeps the limits; the given program where none is better. Returns whether the round is
/// better than the given program, or that is good.
bool choose(const Task& task, State& state);

}  // namespace camber::compensate
