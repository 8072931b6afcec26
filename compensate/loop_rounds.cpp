// Rounds of shifts, and what is kept of each.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compensate/fit_shift.h"
#include "compensate/loop.h"

namespace camber::compensate {

namespace {

constexpr double kMinGain = 0.05;   // a round that is expected to lower the rms by less is not worth a prediction
constexpr double kLeast = 0.1;      // of a fitted step, after over-corrections
constexpr int kGuardRounds = 5;     // beyond max_rounds, to stay out of the part
constexpr int kGuardPatience = 2;   // of these, without the least depth so far falling by ...
constexpr double kGuardGain = 0.1;  // ... this part of what it is over the limit
constexpr int kLiftings = 5;        // of the path before a round of the guard, by what they are expected to bring
constexpr int kStiffenings = 12;    // of the path where its angles grow by more than the bound
constexpr double kStiffer = 2.5;
constexpr double kGuardReach_mm = 2.0;   // a lift fades out over this length, or ...
constexpr double kGuardSmoothings = 8;   // ... so many smoothing lengths
constexpr double kMinFall = 0.1;         // of the 95th percentile: a round that brings less is the last one
constexpr double kFinest_um = 0.1;       // a shift of less is below the last decimal of most programs
constexpr double kLeftOver = 0.25;       // of the tolerance: what a shift can still correct is not worth a round
constexpr double kSplit_mm = 0.0005;     // a split of a line in the first round must be worth this, ...
constexpr double kLateSplit_mm = 0.002;  // ... a later one this

/// Counts the places along the path where the feed fraction changes.
std::size_t count_feed_changes(const ShiftPath& path) {
  std::size_t out = 0;
  for (const Chain& chain : path.chains()) {
    double now = 1;
    for (std::size_t i = chain.from + 1; i < chain.from + chain.count; ++i) {
      if (path.points()[i].feed_fraction != now) ++out;
      now = path.points()[i].feed_fraction;
    }
  }
  return out;
}

/// Share of the area whose error changed its sign and is still over the tolerance.
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

}  // namespace

FitShiftOptions Loop::fit_options(std::span<const double> stiffness, std::span<const RowLink> links,
                                  std::span<const double> link_stiffness) const {
  return {.smoothing_mm = smoothing_mm(job_.simulation.voxel_mm),
          .max_shift_mm = job_.compensation.max_shift_mm,
          .stiffness = stiffness,
          .links = links,
          .link_stiffness = link_stiffness,
          .bounded = true};
}

FitShiftOptions Loop::fit_options() const { return fit_options(now_->stiffness, now_->links, {}); }

void Loop::converge(CompensationResult& out) {
  StepModel model;
  last_gain_.reset();
  while (!done(out, model)) {
    const Round from = out.rounds[out.best];
    const bool by_expectation = !expected_.empty();
    if (!step(out, share_, nullptr)) {
      ended_ = Stop::stalled;
      break;
    }
    const double now = out.rounds.back().error_um.rms;
    if (!by_expectation) model.learn(from.error_um.rms, from.split, share_, now);
    if (now < from.error_um.rms) {
      last_gain_ = 1 - out.rounds.back().error_um.p95 / std::max(from.error_um.p95, 1e-9);
      take(out);
    } else {
      last_ = best_;
      last_gain_.reset();
      share_ = std::max(kLeast, model.best_fraction(share_));
    }
  }
  now_->best_shifted = best_;
}

void Loop::stay_out_of_part(CompensationResult& out) {
  if (out.best == 0 || out.rounds[out.best].deepest_um <= depth_limit_um_) return;
  const double reach = std::max(kGuardReach_mm, kGuardSmoothings * fit_options().smoothing_mm);
  Guard guard(*now_->path, depth_limit_um_ / 1000, reach);
  last_ = best_;
  free_correctable_um_ = out.rounds[out.best].split.correctable_um;
  free_ = best_->emitted;
  free_round_ = out.best;
  double deepest_um = out.rounds[out.best].deepest_um, least_um = deepest_um;
  int without_gain = 0;
  for (int i = 0; i < kGuardRounds && without_gain < kGuardPatience && deepest_um > depth_limit_um_; ++i) {
    if (!ask_for_lifts(guard, deepest_um)) return;
    if (!step(out, 1, &guard)) return;
    deepest_um = out.rounds.back().deepest_um;
    const bool gain = deepest_um - depth_limit_um_ < (1 - kGuardGain) * (least_um - depth_limit_um_);
    without_gain = gain ? 0 : without_gain + 1;
    least_um = std::min(least_um, deepest_um);
  }
}

/// Asks for lifts until the shifts that follow are expected to keep the limit. Returns false if no shift brings the
/// surface nearer to it, as where the shifts are at the largest one.
bool Loop::ask_for_lifts(Guard& guard, double deepest_um) {
  const Observed& observed = last_->observed;
  std::vector<Observation> gains = observed.points;
  now_->sensitivity->apply_to(gains);
  Observed expected = observed;
  double expected_um = deepest_um;
  now_->path->set_shifts(last_->shifts);
  ShiftPath path = *now_->path;
  ThinPath thin(path, now_->splits->kept());
  const std::vector<RowLink> links = row_links(thin.path(), kRowReach_mm);
  const std::vector<double> stiffness = thin.greatest_of(now_->stiffness);
  guard.clear();
  for (int i = 0; i < kLiftings && expected_um > depth_limit_um_; ++i) {
    guard.learn(expected, expected_um / 1000);
    thin.take_shifts(*now_->path);
    fit_lifts(thin.path(), thin.places_of(wanted_of(observed, &guard)), fit_options(stiffness, links, {}));
    thin.give_shifts(path);
    for (std::size_t p = 0; p < gains.size(); ++p) {
      const Observation& o = gains[p];
      if (!observed.compensated[p] || !o.own) continue;
      const Vec3 change = path.shift_at(o.place) - now_->path->shift_at(o.place);
      expected.points[p].error_mm = o.error_mm + o.gain * o.normal.dot(change);
    }
    expected_um = depth_of(last_->surface, expected, depth_limit_um_, true).gouge_depth_p999_um;
  }
  return expected_um - depth_limit_um_ < (1 - kGuardGain) * (deepest_um - depth_limit_um_);
}

void Loop::choose(CompensationResult& out) {
  const bool given_is_good =
      within_tolerance(out.figures.plain_before, job_.compensation) && out.rounds[0].deepest_um <= depth_limit_um_;
  out.verdict.better = allowed_index_ > 0 || out.rounds.size() == 1 || given_is_good;
  if (!out.verdict.better && options_.keep_anyway) return;
  out.best = allowed_index_;
  best_ = allowed_;
  activate(best_->version);
}

bool Loop::step(CompensationResult& out, double fraction, const Guard* guard) {
  PlannedRound planned = plan_round(fraction, guard);
  const Emitted* before = planned.from->version == active_ ? planned.from->emitted.get() : nullptr;
  if (before && planned.made->emitted->emission.text == before->emission.text) return false;
  run_round(out, std::move(planned));
  return true;
}

Loop::PlannedRound Loop::plan_round(double fraction, const Guard* guard, const Prepare& prepare) {
  PlannedRound out{.from = last_, .made = std::make_shared<Trial>()};
  const bool by_expectation = !expected_.empty() && !guard;
  std::vector<Observation> observations = by_expectation ? expected_ : wanted_of(last_->observed, guard);
  expected_.clear();
  // What rows do that come out of the shadow of others says nothing of their gain, nor what another feed does.
  out.shows_gain = !by_expectation && !prepare;
  out.round.gain = now_->sensitivity->mean();
  out.round.step_fraction = fraction;
  out.round.guard = guard != nullptr;
  now_->path->set_shifts(last_->shifts);
  FeedLever::set_fractions(*now_->path, last_->fractions);
  if (prepare) prepare(observations);
  Fit* fit = guard ? &fit_lifts : &fit_shift;
  choose_splits(observations, fit);
  fit_and_emit(observations, fraction, fit, out.round, *out.made);
  return out;
}

void Loop::run_round(CompensationResult& out, PlannedRound planned) {
  predict_trial(*planned.made, fmt::format("round {}", out.rounds.size()));
  last_ = planned.made;
  const Observed& before = planned.from->observed;
  if (planned.shows_gain) now_->sensitivity->learn(*now_->path, planned.from->shifts, before, last_->observed);
  planned.round.overcorrected_fraction = overcorrected_fraction(before, last_->observed, tolerance_mm());
  record(out, planned.round);
}

/// Emits the path's shifts, and again with a stiffer path where it turns by more than the bound.
void Loop::fit_and_emit(const std::vector<Observation>& observations, double fraction, Fit* fit, Round& round,
                        Trial& next) {
  ShiftPath& path = *now_->path;
  const std::vector<Vec3> from = path.shifts();
  ThinPath thin(path, now_->splits->kept());
  const std::vector<Observation> asked = thin.places_of(observations);
  const std::vector<RowLink> links = row_links(thin.path(), kRowReach_mm);
  auto& link_stiffness = now_->link_stiffness;
  if (link_stiffness.size() != links.size()) link_stiffness.assign(links.size(), 1.0);
  for (int i = 0; i <= kStiffenings; ++i) {
    path.set_shifts(from);
    thin.take_shifts(path);
    const std::vector<double> stiffness = thin.greatest_of(now_->stiffness);
    round.limited_points = fit(thin.path(), asked, fit_options(stiffness, links, link_stiffness));
    thin.give_shifts(path);
    for (std::size_t p = 0; p < from.size(); ++p) {
      Vec3& shift = path.points()[p].shift_mm;
      shift = from[p] + fraction * (shift - from[p]);
    }
    next.emitted = trials_.emit(path, now_->splits->kept(), now_->compensated);
    thin.take_shifts(path);
    const RowTurn turn = row_turn(thin.path(), links, job_.compensation.max_angle_growth_rad);
    if (i == 0) {
      double& free_growth = now_->free_angle_growth_rad;
      free_growth = std::max({free_growth, next.emitted->quality.angle_growth_rad, turn.max_rad});
      round.free_angle_growth_rad = free_growth;
    }
    if (next.emitted->quality.over.empty() && turn.over.empty()) break;
    stiffen(next.emitted->quality.over);
    for (const std::size_t link : turn.over) link_stiffness[link] *= kStiffer;
  }
  round.largest_shift_mm = path.largest_shift_mm();
}

/// Predicts the program with the path's shifts and feeds.
void Loop::predict_trial(Trial& trial, const std::string& what) {
  trial.version = active_;
  trial.shifts = now_->path->shifts();
  trial.fractions = FeedLever::fractions(*now_->path);
  trial.keep(trials_.predict(trial.emitted ? trial.emitted->program : setup_.program, progress(what)));
  trial.observed = trials_.observe(*now_->path, trial.emitted.get(), trial.surface);
  trial.observed.reach = reach_;
  trial.observed.set_bounds(bound_mm_);
}

/// The errors that the next shifts are to take away.
std::vector<Observation> Loop::wanted_of(const Observed& observed, const Guard* guard) {
  std::vector<Observation> out = observed.of_path();
  if (guard)
    guard->apply_to(out);
  else
    out = without_row_form(*now_->path, out, fit_options());
  now_->sensitivity->apply_to(out);
  return out;
}

/// Splits lines where the shifts of the unrestricted path ask for it; a late split must be worth more.
void Loop::choose_splits(const std::vector<Observation>& observations, Fit* fit) {
  ShiftPath free = *now_->path;
  fit(free, observations, fit_options());
  if (now_->splits->add_strays(free, now_->split_once ? kLateSplit_mm : kSplit_mm) > 0) now_->link_stiffness.clear();
  now_->split_once = true;
}

void Loop::stiffen(const std::vector<MoveMap::MovePlace>& places) {
  auto& stiffness = now_->stiffness;
  for (const auto& place : places) {
    if (!now_->path->contains(place.move)) continue;
    const std::size_t at = now_->path->find(place.move, place.fraction).lower;
    for (std::size_t i = at > 0 ? at - 1 : 0; i < std::min(at + 3, stiffness.size()); ++i) stiffness[i] *= kStiffer;
  }
}

PlainFigures Loop::figures_of(const Trial& trial) const {
  return plain_figures(trial.surface, trial.total_mm, trial.observed, job_.compensation);
}

void Loop::record(CompensationResult& out, Round round) {
  round.error_um = judged_of(figures_of(*last_), job_.compensation.reference);
  round.split = split_error(*now_->path, last_->observed, fit_options());
  if (round.guard) round.split.give_to_guard(free_correctable_um_);
  round.deepest_um = depth_of(last_->surface, last_->observed, depth_limit_um_, true).gouge_depth_p999_um;
  round.static_rounds = last_->static_rounds;
  round.unsettled = last_->unsettled;
  round.machine_time_s = (last_->emitted ? last_->emitted->program : setup_.program).feed.time_s;
  round.slowed = count_feed_changes(*now_->path);
  round.repeated = now_->passes.size();
  out.rounds.push_back(round);
  figures_.push_back({round.error_um.rms, round.error_um.p95, round.deepest_um, round.machine_time_s > allowed_s_,
                      worse_of(*last_).p999_um});
  const bool by_p95 = has(machine::Lever::feed) || has(machine::Lever::passes);
  const std::size_t allowed = choose_round(figures_, depth_limit_um_, by_p95);
  if (allowed != allowed_index_) allowed_ = last_;  // only the newest round can take the place of another
  allowed_index_ = allowed;
}

void Loop::take(CompensationResult& out) {
  out.best = out.rounds.size() - 1;
  best_ = last_;
}

bool Loop::done(const CompensationResult& out, const StepModel& model) {
  const auto& c = job_.compensation;
  const Round& best = out.rounds[out.best];
  const std::size_t made = out.rounds.size() - first_round_;  // the first one is that of the version as given
  const bool ready = out.best > 0 || within_tolerance(out.figures.plain_before, c);
  const double left_um = c.goal == machine::Goal::best ? std::max(kMinFall * best.error_um.p95, kFinest_um)
                                                       : kLeftOver * c.half_width_um();
  const bool nothing_left = best.split.correctable_p95_um <= left_um;
  const bool stalled = (ready && nothing_left) || (made > 1 && !worth_a_round(out, model));
  ended_ = stalled ? Stop::stalled : Stop::rounds;
  return stalled || static_cast<int>(made) > c.max_rounds;
}

/// Returns whether another round is expected to be worth its prediction, after the first one of a version.
bool Loop::worth_a_round(const CompensationResult& out, const StepModel& model) {
  const Round& best = out.rounds[out.best];
  if (would_be_within(model.effect(share_))) return true;
  if (job_.compensation.goal == machine::Goal::best && last_gain_)
    return *last_gain_ > kMinFall && shift_pays(*best_, best.error_um.p95, model.effect(share_));
  return model.expected_rms_um(best.error_um.rms, best.split, share_) <= (1 - kMinGain) * best.error_um.rms;
}

/// The judged errors of a trial once the fraction `effect` of what shifts can still take away is taken away.
JudgedErrors Loop::errors_after_shift(const Trial& trial, double effect) {
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
  now_->path->set_shifts(trial.shifts);
  const std::vector<double> left = left_by_shift_mm(*now_->path, judged, fit_options());
  for (std::size_t i = 0; i < judged.size(); ++i) {
    out.error_um.push_back(1000 * (judged[i].error_mm + effect * (left[i] - judged[i].error_mm)));
    out.area_mm2.push_back(judged[i].area_mm2);
  }
  return out;
}

/// Returns whether the fraction `effect` of what shifts can still take away is more than a tenth of a trial's 95th
/// percentile.
bool Loop::shift_pays(const Trial& trial, double p95_um, double effect) {
  const JudgedErrors expected = errors_after_shift(trial, effect);
  return p95_of(expected.error_um, expected.area_mm2) < (1 - kMinFall) * p95_um;
}

/// Returns whether the best round, which is not within tolerance, is expected to come within it with the fraction
/// `effect` of what shifts can still take away taken away.
bool Loop::would_be_within(double effect) {
  if (effect <= 0 || within_tolerance(figures_of(*best_), job_.compensation)) return false;
  const JudgedErrors expected = errors_after_shift(*best_, effect);
  return within_tolerance(expected.error_um, expected.area_mm2, job_.compensation);
}

}  // namespace camber::compensate
