#include "compensate/rounds.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compensate/judge.h"
#include "compensate/measure.h"
#include "compensate/row_form.h"
#include "compensate/safety.h"

namespace camber::compensate {
namespace {

constexpr double kLeast = 0.1;          // of a fitted step, after over-corrections
constexpr int kGuardRounds = 5;         // beyond max_rounds, to stay out of the part
constexpr int kGuardPatience = 2;       // of these, without the least depth so far falling by kGuardGain
constexpr double kGuardReach_mm = 2.0;  // a lift fades out over this length, or ...
constexpr double kGuardSmoothings = 8;  // ... so many smoothing lengths

constexpr int kCombinations = 2;      // rounds at most
constexpr double kAbout_mm = 1.0;     // errors so far along the path are judged together
constexpr double kBlend_mm = 0.5;     // along the path, from one round's shifts to another's
constexpr double kClearly = 0.9;      // of what the best round leaves there: less is taken from another round
constexpr double kWorse = 4;          // weight of the square of what exceeds a bound beside the error's own
constexpr double kFall = 0.05;        // of the 95th percentile: what a combination must be expected to bring, ...
constexpr double kWorseFall = 0.25;   // or of what is worse than given
constexpr double kWorseLeast_um = 1;  // and less of this is worth no round

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

/// One value for each round, at each point of the path.
using ByRound = std::vector<std::vector<double>>;

void distribute(const RoundPlaces::OfPoint& place, double value, std::vector<double>& to) {
  const auto upper = static_cast<double>(place.upper_fraction);
  to[place.lower] += (1 - upper) * value;
  to[place.lower + 1] += upper * value;
}

/// Rounds that may be combined: of the active version, with the feeds of the best round.
std::vector<std::size_t> alike_rounds(const State& state) {
  std::vector<std::size_t> out;
  for (std::size_t r = 0; r < state.places.size(); ++r)
    if (state.places[r].version == state.active->index && state.places[r].fractions == state.best.trial->fractions)
      out.push_back(r);
  return out;
}

/// What each round leaves about each point of the path: squares of errors, and more of what exceeds its bound. What one
/// place cuts in one round and another in the next counts at both of them.
ByRound costs(const Task& task, const State& state, const std::vector<std::size_t>& rounds) {
  const ShiftPath& path = state.active->path;
  const Observed& observed = state.best.trial->observed;
  ByRound out(rounds.size(), std::vector<double>(path.points().size(), 0.0));
  for (std::size_t i = 0; i < observed.points.size(); ++i) {
    if (!observed.judged(i)) continue;
    for (std::size_t k = 0; k < rounds.size(); ++k) {
      const auto error = std::abs(static_cast<double>(state.places[rounds[k]].points[i].error_mm));
      const double over = std::max(0.0, error - task.given.bound_mm[i]);
      const double cost = observed.points[i].area_mm2 * (error * error + kWorse * over * over);
      for (const std::size_t at : rounds)
        if (state.places[at].compensated[i]) distribute(state.places[at].points[i], cost, out[k]);
    }
  }
  for (auto& of_round : out) spread_along(of_round, path, kAbout_mm);
  return out;
}

/// Parts of the rounds at each point of the path; their sum is 1. `best`: of the rounds the one that stays where no
/// other leaves clearly less.
ByRound parts(const ShiftPath& path, const ByRound& cost, std::size_t best) {
  const std::size_t count = path.points().size();
  ByRound out(cost.size(), std::vector<double>(count, 0.0));
  std::vector<double> sum(count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t least = best;
    for (std::size_t k = 0; k < cost.size(); ++k)
      if (cost[k][i] < cost[least][i] * (least == best ? kClearly : 1)) least = k;
    out[least][i] = 1;
  }
  for (auto& of_round : out) spread_along(of_round, path, kBlend_mm);
  for (const auto& of_round : out)
    for (std::size_t i = 0; i < count; ++i) sum[i] += of_round[i];
  for (auto& of_round : out)
    for (std::size_t i = 0; i < count; ++i) of_round[i] /= sum[i];
  return out;
}

struct Combination {
  std::vector<Vec3> shifts;      ///< one per point of the path
  std::vector<double> error_mm;  ///< expected, one per point of the surface
};

Combination combination(const Task& task, const State& state, const std::vector<std::size_t>& rounds) {
  const ShiftPath& path = state.active->path;
  const auto kept = static_cast<std::size_t>(std::ranges::find(rounds, state.best.round) - rounds.begin());
  const ByRound part = parts(path, costs(task, state, rounds), kept);
  const RoundPlaces& best = state.places[state.best.round];
  Combination out;
  out.shifts.assign(path.points().size(), Vec3::Zero());
  out.error_mm.assign(best.points.size(), 0.0);
  for (std::size_t k = 0; k < rounds.size(); ++k) {
    const RoundPlaces& of = state.places[rounds[k]];
    for (std::size_t i = 0; i < out.shifts.size(); ++i) out.shifts[i] += part[k][i] * of.shifts[i];
    for (std::size_t i = 0; i < out.error_mm.size(); ++i) {
      const RoundPlaces::OfPoint& at = best.points[i];
      const auto upper = static_cast<double>(at.upper_fraction);
      const double taken = best.compensated[i] ? (1 - upper) * part[k][at.lower] + upper * part[k][at.lower + 1]
                                               : static_cast<double>(k == kept);
      out.error_mm[i] += taken * static_cast<double>(of.points[i].error_mm);
    }
  }
  return out;
}

/// Figures of errors that are expected at the points of the surface.
RoundFigures expected_figures(const Task& task, const Trial& trial, const std::vector<double>& error_mm) {
  std::vector<double> error_um, area_mm2;
  std::vector<removal::ValueOfArea> excess;
  double area = 0;
  for (std::size_t i = 0; i < error_mm.size(); ++i) {
    const Observation& o = trial.observed.points[i];
    if (!trial.observed.judged(i) || o.area_mm2 <= 0) continue;
    error_um.push_back(1000 * error_mm[i]);
    area_mm2.push_back(o.area_mm2);
    area += o.area_mm2;
    const double over_mm =
        std::abs(error_mm[i]) - not_worse_mm(task.given.trial->observed.points[i].error_mm, task.tolerance_mm());
    if (over_mm > 0) excess.push_back({1000 * over_mm, o.area_mm2});
  }
  const removal::ErrorFigures figures = removal::error_figures(error_um, area_mm2);
  return {.rms_um = figures.rms, .p95_um = figures.p95, .worse_um = depth_p999(std::move(excess), area)};
}

bool pays(const RoundFigures& expected, const RoundFigures& best) {
  const bool nearer = expected.p95_um <= (1 - kFall) * best.p95_um && expected.rms_um <= best.rms_um;
  const bool safer = best.worse_um > kWorseLeast_um && expected.worse_um <= (1 - kWorseFall) * best.worse_um &&
                     expected.p95_um <= best.p95_um && expected.rms_um <= best.rms_um;
  return nearer || safer;
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

void combine_rounds(const Task& task, State& state) {
  for (int i = 0; i < kCombinations; ++i) {
    const std::vector<std::size_t> rounds = alike_rounds(state);
    if (rounds.size() < 2) return;
    const Combination made = combination(task, state, rounds);
    const RoundFigures expected = expected_figures(task, *state.best.trial, made.error_mm);
    if (!pays(expected, state.figures[state.best.round])) return;
    state.last = state.best.trial;
    run_round(task, state, propose_shifts(task, state, made.shifts));
    const RoundFigures &now = state.figures.back(), &best = state.figures[state.best.round];
    if (now.out_of_question || now.p95_um > best.p95_um || now.rms_um > best.rms_um) return;
    take(state);
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
