// What costs machine time: lower feeds and second cuts.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compensate/least_feed.h"
#include "compensate/loop.h"

namespace camber::compensate {
namespace {

constexpr std::array kRungs_percent{5.0, 10.0, 15.0, 25.0, 50.0, 100.0, 200.0};  // of extra time
constexpr int kRungRounds = 2;
constexpr int kBudgetRounds = 6;
constexpr double kDefaultBudget_percent = 10;  // where the job names no levers
constexpr double kPays = 0.1;        // of the 95th percentile: what feeds by default must be expected to bring
constexpr double kTimeRoom = 0.003;  // by which the shifts that follow a plan of feeds may exceed a budget
constexpr int kPlannings = 5;        // of feeds, until their text fits into the budget
constexpr double kReserve = 0.98;    // of the time that should fit by the last plan
constexpr double kMinExtra = 0.005;  // less extra time is not worth a round
constexpr double kWanted = 0.9;      // of the tolerance: what feeds and second cuts are chosen for
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

}  // namespace

bool Loop::met(const CompensationResult& out) const {
  return within_tolerance(figures_of(*best_), job_.compensation) && out.rounds[out.best].deepest_um <= depth_limit_um_;
}

void Loop::spend_time(CompensationResult& out) {
  if (!has(machine::Lever::feed) && !has(machine::Lever::passes)) return;
  out.time_points.push_back({0, out.best});
  const auto budget = budget_percent();
  std::vector<double> rungs(kRungs_percent.begin(), kRungs_percent.end());
  if (budget) rungs = {*budget};
  if (!budget && job_.compensation.levers.empty()) rungs = {kDefaultBudget_percent};
  for (const double percent : rungs) {
    if (!budget && met(out)) return;
    allowed_s_ = (1 + percent / 100 + kTimeRoom) * given_s_;
    const std::size_t before = out.best;
    lower_feeds(out, percent);
    const bool more = (budget || !met(out)) && cut_twice(out, percent);
    if (out.best != before) out.time_points.push_back({percent, out.best});
    if (out.best == before && !more) return;  // the least feed, or nothing that a lever changes
  }
}

// --- feeds ----------------------------------------------------------------------------------------------------------

void Loop::lower_feeds(CompensationResult& out, double percent) {
  const double left_s = (1 + percent / 100) * given_s_ - setup_.program.feed.time_s;
  if (!has(machine::Lever::feed) || now_->feeds_stuck || left_s < kMinExtra * given_s_) return;
  if (!now_->feeds) {
    const bool splittable = !std::isinf(spacing_mm());
    const std::vector<double> least = least_feeds(*now_->path, setup_.program.moves_in_part(), job_.machine,
                                                  job_.compensation.min_feed_percent / 100);
    now_->feeds.emplace(*now_->path, setup_.program, splittable, least);
  }
  const bool budget = budget_percent().has_value();
  if (!budget && job_.compensation.levers.empty() && !feeds_pay(percent)) return;
  last_ = best_;
  const std::size_t before = out.best;
  for (int i = 0; i < (budget ? kBudgetRounds : kRungRounds); ++i) {
    const bool made = i % 2 == 0 ? step_with_feeds(out, percent)
                                 : shift_pays(*last_, out.rounds.back().error_um.p95, 1) && step(out, 1, nullptr);
    if (!made && i % 2 == 0) break;
    if (!made) continue;  // the shifts to these feeds would change little
    if (out.rounds.back().machine_time_s <= allowed_s_ &&
        out.rounds.back().error_um.p95 < out.rounds[out.best].error_um.p95)
      take(out);
    if (!budget && met(out)) break;
  }
  now_->feeds_stuck = out.best == before;
}

/// Returns whether lower feeds are expected to take a tenth or more off the 95th percentile that the best shift leaves.
bool Loop::feeds_pay(double percent) {
  ShiftPath path = *now_->path;
  path.set_shifts(best_->shifts);
  FeedLever::set_fractions(path, best_->fractions);
  const std::vector<Observation> all = best_->observed.of_path();
  const std::vector<double> left_mm = left_by_shift_mm(path, all, fit_options());
  std::vector<double> area_mm2;
  area_mm2.reserve(all.size());
  for (const Observation& o : all) area_mm2.push_back(o.area_mm2);
  const double budget_s = percent / 100 * given_s_;
  const double expected_mm = now_->feeds->choose(path, all, left_mm, budget_s, kWanted * tolerance_mm()).error_mm;
  return expected_mm <= (1 - kPays) * p95_of(left_mm, area_mm2);
}

/// One round with new feeds. Changes of feed cost more on the machine than their plan has it: until the text fits into
/// the time, it is planned for less. False: no text does, and nothing was predicted.
bool Loop::step_with_feeds(CompensationResult& out, double percent) {
  const std::shared_ptr<const Trial> from = last_;
  FeedLever& lever = *now_->feeds;
  const double wanted_mm = budget_percent() ? 0.0 : kWanted * tolerance_mm();
  const double program_s = setup_.program.feed.time_s;
  const double budget_s = std::max(0.0, (1 + percent / 100) * given_s_ - program_s);
  const Splits splits = *now_->splits;
  double plan_s = budget_s, planned_s = 0;
  const Prepare choose = [&](std::vector<Observation>& observations) {
    const std::vector<Observation> all = from->observed.of_path();
    const std::vector<double> left = left_by_shift_mm(*now_->path, all, fit_options());
    planned_s = lever.choose(*now_->path, all, left, plan_s, wanted_mm).extra_s;
    now_->splits->add_feed_changes(*now_->path);
    lever.apply_to(observations, *now_->path, from->fractions);
  };
  for (int i = 0; i < kPlannings; ++i) {
    now_->splits = splits;
    now_->link_stiffness.clear();
    PlannedRound round = plan_round(1, nullptr, choose);
    const double found_s = round.made->emitted->program.feed.time_s - program_s;
    if (found_s > budget_s) {
      plan_s *= kReserve * budget_s / found_s;
      continue;
    }
    run_round(out, std::move(round));
    lever.learn(*now_->path, from->fractions, from->shifts, from->observed, last_->observed, planned_s, found_s);
    return true;
  }
  return false;
}

// --- second cuts ----------------------------------------------------------------------------------------------------

/// Returns the runs with what the best shifts leave of each. Requires the given program to be active.
std::vector<PassRun> Loop::runs_after_shifts() {
  const Trial& base = *now_->best_shifted;
  now_->path->set_shifts(base.shifts);
  const std::vector<Observation> all = base.observed.of_path();
  const std::vector<double> left = left_by_shift_mm(*now_->path, all, fit_options());
  return pass_runs(setup_.program, now_->compensated, *now_->path, all, left);
}

/// The runs whose error exceeds what is wanted are cut twice, if that fits into the time. True: more time would allow
/// more. The best of the versions is active afterwards.
bool Loop::cut_twice(CompensationResult& out, double percent) {
  if (!has(machine::Lever::passes)) return false;
  const bool budget = budget_percent().has_value();
  activate(0);
  const std::vector<PassRun> runs = runs_after_shifts();
  const double wanted_mm = budget ? 0.0 : kWanted * tolerance_mm(), budget_s = percent / 100 * given_s_;
  const std::vector<std::size_t> chosen = choose_passes(runs, budget_s, wanted_mm);
  const bool all_fit = chosen.size() == choose_passes(runs, kNoLimit, wanted_mm).size();
  const auto tried = [&] { return std::ranges::any_of(versions_, [&](const auto& v) { return v->passes == chosen; }); };
  // Without a budget all that need it are cut twice at once: a version takes several predictions.
  std::unique_ptr<Version> version;
  too_slow_ = !all_fit;
  if (!tried() && (budget || all_fit)) version = version_with(runs, chosen, first_cuts());
  if (!version) {
    activate(best_->version);
    return too_slow_ && !budget;
  }
  compensate_version(std::move(version), out, percent);
  return false;
}

/// Runs the rounds of a version. The better of its best round and the best so far stays, with its version active.
void Loop::compensate_version(std::unique_ptr<Version> version, CompensationResult& out, double percent) {
  const std::shared_ptr<const Trial> best = best_;
  const std::size_t best_round = out.best;
  versions_.push_back(std::move(version));
  activate(versions_.size() - 1);
  predict_version(out);
  share_ = 1;
  converge(out);
  if (budget_percent() || !met(out)) lower_feeds(out, percent);
  const Round &found = out.rounds[out.best], &old = out.rounds[best_round];
  if (found.machine_time_s > allowed_s_ || found.error_um.p95 >= old.error_um.p95) {
    best_ = best;
    out.best = best_round;
  }
  activate(best_->version);
}

/// The best path without lower feeds, lifted by the allowance; the given path where that needs less of it, since it
/// cuts less deep into the part: a second cut puts nothing back.
nc::Emission Loop::first_cuts() {
  const auto allowance_of = [&](const Trial& trial) {
    const Depth depth = depth_of(trial.surface, trial.observed, depth_limit_um_, true);
    return pass_allowance_mm(depth.gouge_depth_p999_um / 1000, tolerance_mm());
  };
  const double given_mm = allowance_of(*given_trial_), best_mm = allowance_of(*now_->best_shifted);
  const Trial& base = given_mm < best_mm ? *given_trial_ : *now_->best_shifted;
  const double own = job_.compensation.pass_allowance_mm;
  allowance_mm_ = own > 0 ? own : std::min(given_mm, best_mm);
  std::vector<Observation> wanted = base.observed.of_path();
  for (Observation& o : wanted) o.error_mm = -allowance_mm_;
  ShiftPath& path = *now_->path;
  path.set_shifts(base.shifts);
  const std::vector<double> full_feeds(path.points().size(), 1.0);
  FeedLever::set_fractions(path, full_feeds);
  ThinPath thin(path, now_->splits->kept());
  const std::vector<double> stiffness = thin.greatest_of(now_->stiffness);
  const std::vector<RowLink> links = row_links(thin.path(), kRowReach_mm);
  FitShiftOptions options = fit_options(stiffness, links, {});
  options.max_shift_mm += allowance_mm_;
  options.bounded = false;
  fit_shift(thin.path(), thin.places_of(wanted), options);
  thin.give_shifts(path);
  return trials_.text_of(path, now_->splits->kept());
}

}  // namespace camber::compensate
