// What is kept of each round, and when the rounds end.
#include "compensate/judge.h"

#include <algorithm>
#include <cmath>

#include "compensate/pass_before.h"
#include "compensate/propose.h"

namespace camber::compensate {
namespace {

constexpr double kMinGain = 0.05;       // a round that is expected to lower the rms by less is not worth a prediction
constexpr double kMinFall = 0.1;        // of the 95th percentile: a round that brings less is the last one
constexpr double kFinest_um = 0.1;      // a shift of less is below the last decimal of most programs
constexpr double kLeftOver = 0.25;      // of the tolerance: what a shift can still correct is not worth a round
constexpr double kAlike = 0.1;          // of the figure: rounds that differ by less are chosen by what they make worse
constexpr double kAlikeWorse_um = 0.1;  // and with less than this between them by the figure

bool keeps_limits(const RoundFigures& r, const RoundFigures& given, double depth_limit_um) {
  return !r.out_of_question && r.rms_um < given.rms_um && r.p95_um <= given.p95_um &&
         r.depth_um <= std::max(depth_limit_um, given.depth_um);
}

bool is_better(const RoundFigures& r, const RoundFigures& best, double depth_limit_um, bool by_p95) {
  const bool too_deep = r.depth_um > depth_limit_um, best_too_deep = best.depth_um > depth_limit_um;
  if (too_deep != best_too_deep) return best_too_deep;
  const double figure = by_p95 ? r.p95_um : r.rms_um, best_figure = by_p95 ? best.p95_um : best.rms_um;
  const bool alike = std::abs(figure - best_figure) <= kAlike * std::max(figure, best_figure);
  if (alike && std::abs(r.worse_um - best.worse_um) > kAlikeWorse_um) return r.worse_um < best.worse_um;
  return figure < best_figure;
}

/// Counts the places along the path where the feed fraction changes.
std::size_t count_feed_changes(const ShiftPath& path) {
  std::size_t out = 0;
  for (const ShiftChain& chain : path.chains()) {
    double now = 1;
    for (std::size_t i = chain.from + 1; i < chain.from + chain.count; ++i) {
      if (path.points()[i].feed_fraction != now) ++out;
      now = path.points()[i].feed_fraction;
    }
  }
  return out;
}

/// The best round, which is not within tolerance, is expected to come within it with the fraction `effect` of what
/// shifts can still take away taken away.
bool would_be_within(const Task& task, const State& state, double effect) {
  const Trial& best = *state.best.trial;
  if (effect <= 0 || within_tolerance(figures_of(task, best), task.job.compensation)) return false;
  const JudgedErrors expected = errors_after_shift(task, *state.active, best, effect);
  return within_tolerance(expected.error_um, expected.area_mm2, task.job.compensation);
}

/// Another round is expected to be worth its prediction, after the first one of a version.
bool worth_a_round(const Task& task, const State& state, const StepModel& model) {
  const Round& best = state.rounds[state.best.round];
  const double effect = model.effect(state.step_fraction);
  if (would_be_within(task, state, effect)) return true;
  if (task.job.compensation.goal == machine::Goal::best && state.last_gain)
    return *state.last_gain > kMinFall && shift_pays(task, *state.active, *state.best.trial, best.error_um.p95, effect);
  return model.expected_rms_um(best.error_um.rms, best.split, state.step_fraction) <=
         (1 - kMinGain) * best.error_um.rms;
}

/// Keeps of the last trial what combine_rounds needs.
void remember_places(State& state) {
  const Trial& trial = *state.last;
  RoundPlaces kept{.version = trial.version,
                   .shifts = trial.shifts,
                   .fractions = trial.fractions,
                   .compensated = trial.observed.compensated};
  kept.points.reserve(trial.observed.points.size());
  for (const Observation& o : trial.observed.points)
    kept.points.push_back({static_cast<float>(o.error_mm), static_cast<std::uint32_t>(o.place.lower),
                           static_cast<float>(o.place.upper_fraction)});
  state.places.push_back(std::move(kept));
}

}  // namespace

std::size_t choose_round(std::span<const RoundFigures> rounds, double depth_limit_um, bool by_p95) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < rounds.size(); ++i) {
    if (!keeps_limits(rounds[i], rounds[0], depth_limit_um)) continue;
    if (best == 0 || is_better(rounds[i], rounds[best], depth_limit_um, by_p95)) best = i;
  }
  return best;
}

void StepModel::learn(double rms_um, const ErrorSplit& split, double fraction, double new_rms_um) {
  const double correctable = split.correctable_um * split.correctable_um;
  if (correctable <= 0 || fraction <= 0) return;
  const double change = new_rms_um * new_rms_um - rms_um * rms_um;
  curvature_ = std::max(1.0, (change / correctable + 2 * fraction) / (fraction * fraction));
}

double StepModel::best_fraction(double greatest) const { return std::min(greatest, 1 / curvature_); }

double StepModel::effect(double fraction) const {
  return std::clamp(2 * fraction - curvature_ * fraction * fraction, 0.0, 1.0);
}

double StepModel::expected_rms_um(double rms_um, const ErrorSplit& split, double fraction) const {
  const double correctable = split.correctable_um * split.correctable_um;
  return std::sqrt(std::max(0.0, rms_um * rms_um - effect(fraction) * correctable));
}

PlainFigures figures_of(const Task& task, const Trial& trial) {
  return plain_figures(trial.surface, trial.total_mm, trial.observed, task.job.compensation);
}

WorsePlaces worse_of(const Task& task, const Trial& trial) {
  return worse_places(task.given.trial->surface, trial.surface, trial.observed, task.job.compensation);
}

JudgedErrors errors_after_shift(const Task& task, Version& version, const Trial& trial, double effect) {
  const Observed& observed = trial.observed;
  std::vector<Observation> judged;
  JudgedErrors out;
  for (std::size_t i = 0; i < observed.points.size(); ++i) {
    if (!observed.judged(i)) continue;
    if (observed.compensated[i]) {
      judged.push_back(observed.points[i]);
      continue;
    }
    out.error_um.push_back(1000 * observed.points[i].error_mm);
    out.area_mm2.push_back(observed.points[i].area_mm2);
  }
  version.path.set_shifts(trial.shifts);
  const std::vector<double> left = left_by_shift_mm(version.path, judged, fit_options(task, version));
  for (std::size_t i = 0; i < judged.size(); ++i) {
    out.error_um.push_back(1000 * (judged[i].error_mm + effect * (left[i] - judged[i].error_mm)));
    out.area_mm2.push_back(judged[i].area_mm2);
  }
  return out;
}

bool shift_pays(const Task& task, Version& version, const Trial& trial, double p95_um, double effect) {
  const JudgedErrors expected = errors_after_shift(task, version, trial, effect);
  return p95_of(expected.error_um, expected.area_mm2) < (1 - kMinFall) * p95_um;
}

void record(const Task& task, State& state, Round round) {
  const Trial& trial = *state.last;
  const Version& version = *state.active;
  const double limit_um = task.given.depth_limit_um;
  round.error_um = judged_of(figures_of(task, trial), task.job.compensation.reference);
  round.split = split_error(version.path, trial.observed, fit_options(task, version));
  if (round.guard) round.split.give_to_guard(state.free.correctable_um);
  round.deepest_um = depth_of(trial.surface, trial.observed, limit_um, true).gouge_depth_p999_um;
  round.static_rounds = trial.static_rounds;
  round.unsettled = trial.unsettled;
  round.machine_time_s = (trial.emitted ? trial.emitted->program : *version.source.program).feed.time_s;
  round.slowed = count_feed_changes(version.path);
  round.repeated = version.passes().size();
  state.rounds.push_back(round);
  remember_places(state);
  const bool spoilt = version.repeated && version.repeated->pass_before && cuts_into_part(task, trial);
  state.figures.push_back({round.error_um.rms, round.error_um.p95, round.deepest_um,
                           round.machine_time_s > state.allowed_s || spoilt, worse_of(task, trial).p999_um});
  const bool by_p95 = !task.only_shifts();
  const std::size_t allowed = choose_round(state.figures, limit_um, by_p95);
  // Only the newest round can take the place of another.
  if (allowed != state.allowed.round) state.allowed = {state.last, allowed};
}

void take(State& state) { state.best = {state.last, state.rounds.size() - 1}; }

bool met(const Task& task, const State& state) {
  return within_tolerance(figures_of(task, *state.best.trial), task.job.compensation) &&
         state.rounds[state.best.round].deepest_um <= task.given.depth_limit_um;
}

bool done(const Task& task, State& state, const StepModel& model) {
  const auto& c = task.job.compensation;
  const Round& best = state.rounds[state.best.round];
  const std::size_t made = state.rounds.size() - state.first_round;  // the first one is that of the version as given
  const bool ready = state.best.round > 0 || within_tolerance(task.given.plain, c);
  const double left_um = c.goal == machine::Goal::best ? std::max(kMinFall * best.error_um.p95, kFinest_um)
                                                       : kLeftOver * c.half_width_um();
  const bool nothing_left = best.split.correctable_p95_um <= left_um;
  const bool stalled = (ready && nothing_left) || (made > 1 && !worth_a_round(task, state, model));
  state.ended = stalled ? Stop::stalled : Stop::rounds;
  return stalled || static_cast<int>(made) > c.max_rounds;
}

bool choose(const Task& task, State& state) {
  const bool given_is_good = within_tolerance(task.given.plain, task.job.compensation) &&
                             state.rounds[0].deepest_um <= task.given.depth_limit_um;
  const bool better = state.allowed.round > 0 || state.rounds.size() == 1 || given_is_good;
  if (!better && task.options.keep_anyway) return better;
  state.best = state.allowed;
  state.activate(state.best.trial->version);
  return better;
}

}  // namespace camber::compensate
