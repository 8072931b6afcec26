#include "compensate/rounds.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compensate/judge.h"
#include "compensate/measure.h"

namespace camber::compensate {
namespace {

constexpr double kLeast = 0.1;          // of a fitted step, after over-corrections
constexpr int kGuardRounds = 5;         // beyond max_rounds, to stay out of the part
constexpr int kGuardPatience = 2;       // of these, without the least depth so far falling by kGuardGain
constexpr double kGuardReach_mm = 2.0;  // a lift fades out over this length, or ...
constexpr double kGuardSmoothings = 8;  // ... so many smoothing lengths

/// Fraction of the area whose error changed its sign and is still over the tolerance.
double overcorrected_fraction(const Observed& before, const Observed& now, double tolerance_mm) {
  double over = 0, area = 0;
  for (std::size_t i = 0; i < now.points.size(); ++i) {
    const double a = before.points[i].error_mm, b = now.points[i].error_mm;
    area += now.points[i].area_mm2;
    if (now.compensated[i] && a * b < 0 && std::abs(a) > tolerance_mm && std::abs(b) > tolerance_mm)
      over += now.points[i].area_mm2;
  }
  return area > 0 ? over / area : 0;
}

/// Points of the compensated surface that lie deeper than the limit.
std::size_t points_below(const Trial& trial, double limit_um) {
  std::size_t out = 0;
  for (std::size_t i = 0; i < trial.surface.size(); ++i)
    if (trial.observed.compensated[i] && trial.surface[i].valid && -1000 * trial.observed.points[i].error_mm > limit_um)
      ++out;
  return out;
}

}  // namespace

void converge(const Task& task, State& state) {
  StepModel model;
  state.last_gain.reset();
  while (!done(task, state, model)) {
    const Round from = state.rounds[state.best.round];
    const bool by_expectation = !state.expected.empty();
    if (!step(task, state, state.step_fraction, nullptr)) {
      state.ended = Stop::stalled;
      break;
    }
    const removal::ErrorFigures& now = state.rounds.back().error_um;
    if (!by_expectation) model.learn(from.error_um.rms, from.split, state.step_fraction, now.rms);
    if (now.rms < from.error_um.rms) {
      state.last_gain = 1 - now.p95 / std::max(from.error_um.p95, 1e-9);
      take(state);
    } else {
      state.last = state.best.trial;
      state.last_gain.reset();
      state.step_fraction = std::max(kLeast, model.best_fraction(state.step_fraction));
    }
  }
  state.active->best_shifted = state.best.trial;
}

void stay_out_of_part(const Task& task, State& state) {
  const double limit_um = task.given.depth_limit_um;
  const std::size_t before = state.best.round;
  if (before == 0 || state.rounds[before].deepest_um <= limit_um) return;
  const Version& version = *state.active;
  const double reach = std::max(kGuardReach_mm, kGuardSmoothings * fit_options(task, version).smoothing_mm);
  Guard guard(version.path, limit_um / 1000, reach);
  state.last = state.best.trial;
  const Trial& free = *state.best.trial;
  state.free = {state.rounds[before].split.correctable_um, before, free.emitted, points_below(free, limit_um),
                depth_of(free.surface, free.observed, limit_um, true).stamp};
  double deepest_um = state.rounds[before].deepest_um, least_um = deepest_um;
  int without_gain = 0;
  for (int i = 0; i < kGuardRounds && without_gain < kGuardPatience && deepest_um > limit_um; ++i) {
    if (!ask_for_lifts(task, state, guard, deepest_um)) return;
    if (!step(task, state, 1, &guard)) return;
    deepest_um = state.rounds.back().deepest_um;
    const bool gain = deepest_um - limit_um < (1 - kGuardGain) * (least_um - limit_um);
    without_gain = gain ? 0 : without_gain + 1;
    least_um = std::min(least_um, deepest_um);
  }
}

bool step(const Task& task, State& state, double fraction, const Guard* guard) {
  PlannedRound planned = propose(task, state, fraction, guard);
  const Emitted* before = planned.from->version == state.active->index ? planned.from->emitted.get() : nullptr;
  if (before && planned.made->emitted->emission.text == before->emission.text) return false;
  run_round(task, state, std::move(planned));
  return true;
}

void run_round(const Task& task, State& state, PlannedRound planned) {
  Version& version = *state.active;
  measure(task, version, *planned.made, fmt::format("round {}", state.rounds.size()));
  state.last = planned.made;
  const Observed &before = planned.from->observed, &now = state.last->observed;
  if (planned.shows_gain) version.sensitivity.learn(version.path, planned.from->shifts, before, now);
  planned.round.overcorrected_fraction = overcorrected_fraction(before, now, task.tolerance_mm());
  record(task, state, planned.round);
}

}  // namespace camber::compensate
