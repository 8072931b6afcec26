#include "compensate/spend_time.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "compensate/feed_lever.h"
#include "compensate/judge.h"
#include "compensate/measure.h"
#include "compensate/pass_before.h"
#include "compensate/rounds.h"
#include "compensate/second_cuts.h"

namespace camber::compensate {
namespace {

constexpr std::array kRungs_percent{5.0, 10.0, 15.0, 25.0, 50.0, 100.0, 200.0};  // of extra time
constexpr int kRungRounds = 2;
constexpr int kBudgetRounds = 6;
constexpr double kDefaultBudget_percent = 10;  // where the job names no levers
constexpr double kPays = 0.1;        // of the 95th percentile: what feeds by default must be expected to bring
constexpr double kPaysOver = 0.05;   // the same where the tolerance is missed
constexpr double kFollows = 1.05;    // times it: shifts that belong to new feeds need bring less than others
constexpr double kTimeRoom = 0.003;  // by which the shifts that follow a plan of feeds may exceed a budget
constexpr int kPlannings = 5;        // of feeds, until their text fits into the budget
constexpr double kReserve = 0.98;    // of the time that should fit by the last plan
constexpr double kMinExtra = 0.005;  // less extra time is not worth a round
constexpr double kWanted = 0.9;      // of the tolerance: what feeds and second cuts are chosen for
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// The tolerance is kept, whatever the depth is: the guard comes later.
bool kept(const Task& task, const State& state) {
  return within_tolerance(figures_of(task, *state.best.trial), task.job.compensation);
}

/// The least error within a time is wanted: the job gives the time, or the tolerance is kept and the goal is the best.
bool wants_least(const Task& task, const State& state) {
  const auto& asked = task.job.compensation;
  return task.budget_percent() || (asked.levers.empty() && asked.goal == machine::Goal::best && kept(task, state));
}

double wanted_mm(const Task& task, const State& state) {
  return wants_least(task, state) ? 0.0 : kWanted * task.tolerance_mm();
}

/// Extra time where the job names no levers, in percent of the machine time: a tenth of it where the tolerance takes
/// that, else of the time of the moves to compensate.
double default_percent(const Task& task, const State& state) {
  if (!kept(task, state)) return kDefaultBudget_percent;
  const simulate::SimulatedProgram& program = *state.active->source.program;
  const std::span<const removal::Stamp> stamps = program.path.stamps;
  double own_s = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    if (!stamps[i].first && state.active->path.contains(stamps[i].move)) own_s += stamps[i].t_s - stamps[i - 1].t_s;
  return kDefaultBudget_percent * own_s / program.feed.time_s;
}

/// Lower feeds are expected to take a tenth or more off the 95th percentile that the best shift leaves; over the
/// tolerance a twentieth.
bool feeds_pay(const Task& task, const State& state, double percent) {
  LeftByShifts left = left_by_shifts(task, state);
  const double budget_s = percent / 100 * task.given.time_s;
  const FeedChoice choice =
      state.active->feeds->choose(left.path, left.of_path, left.mm, budget_s, wanted_mm(task, state));
  const double pays = kept(task, state) ? kPays : kPaysOver;
  return choice.error_mm <= (1 - pays) * p95_of(left.mm, left.area_mm2);
}

/// Predicts one round with new feeds. Changes of feed cost more on the machine than their plan has it: until the text
/// fits into the time, it is planned for less. False: no text does, and nothing was predicted.
bool step_with_feeds(const Task& task, State& state, double percent) {
  const std::shared_ptr<const Trial> from = state.last;
  Version& version = *state.active;
  FeedLever& lever = *version.feeds;
  const double program_s = version.source.program->feed.time_s;
  const double budget_s = std::max(0.0, (1 + percent / 100) * task.given.time_s - program_s);
  const Splits splits = version.splits;
  double plan_s = budget_s, planned_s = 0;
  const Prepare choose = [&](std::vector<Observation>& observations) {
    const std::vector<Observation> all = from->observed.of_path();
    const std::vector<double> left = left_by_shift_mm(version.path, all, fit_options(task, version));
    planned_s = lever.choose(version.path, all, left, plan_s, wanted_mm(task, state)).extra_s;
    version.splits.add_feed_changes(version.path);
    lever.apply_to(observations, version.path, from->fractions);
  };
  for (int i = 0; i < kPlannings; ++i) {
    version.splits = splits;
    version.link_stiffness.clear();
    PlannedRound round = propose(task, state, 1, nullptr, choose);
    const double found_s = round.made->emitted->program.feed.time_s - program_s;
    if (found_s > budget_s) {
      plan_s *= kReserve * budget_s / found_s;
      continue;
    }
    run_round(task, state, std::move(round));
    lever.learn(version.path, from->fractions, from->shifts, from->observed, state.last->observed, planned_s, found_s);
    return true;
  }
  return false;
}

void lower_feeds(const Task& task, State& state, double percent) {
  Version& version = *state.active;
  const simulate::SimulatedProgram& program = *version.source.program;
  const double left_s = (1 + percent / 100) * task.given.time_s - program.feed.time_s;
  if (!task.has(machine::Lever::feed) || version.feeds_stuck || left_s < kMinExtra * task.given.time_s) return;
  if (!version.feeds) {
    const bool splittable = !std::isinf(task.spacing_mm());
    const std::vector<double> least = least_feeds(version.path, program.moves_in_part(), task.job.machine,
                                                  task.job.compensation.min_feed_percent / 100);
    version.feeds.emplace(version.path, program, splittable, least);
  }
  const bool budget = task.budget_percent().has_value();
  if (!budget && task.job.compensation.levers.empty() && !feeds_pay(task, state, percent)) return;
  state.last = state.best.trial;
  const std::size_t before = state.best.round;
  const bool least = wants_least(task, state);
  for (int i = 0; i < (budget ? kBudgetRounds : kRungRounds); ++i) {
    const bool made = i % 2 == 0
                          ? step_with_feeds(task, state, percent)
                          : shift_pays(task, version, *state.last, kFollows * state.rounds.back().error_um.p95, 1) &&
                                step(task, state, 1, nullptr);
    if (!made && i % 2 == 0) break;
    if (!made) continue;  // the shifts to these feeds would change little
    const Round &now = state.rounds.back(), &best = state.rounds[state.best.round];
    if (now.machine_time_s <= state.allowed_s && now.error_um.p95 < best.error_um.p95) take(state);
    if (!least && met(task, state)) break;
  }
  version.feeds_stuck = state.best.round == before;
}

/// The active version's first prediction.
void measure_version(const Task& task, State& state) {
  auto made = std::make_shared<Trial>();
  measure(task, *state.active, *made, fmt::format("round {}", state.rounds.size()));
  state.active->source.part_yields = made->part_yields;
  state.last = made;
  state.first_round = state.rounds.size();
  record(task, state, {});
  take(state);
}

/// Runs the rounds of a version. The better of its best round and the best so far stays, with its version active.
void compensate_version(const Task& task, State& state, std::unique_ptr<Version> version, double percent) {
  const Kept best = state.best;
  version->index = state.versions.size();
  state.versions.push_back(std::move(version));
  state.activate(state.versions.size() - 1);
  measure_version(task, state);
  state.step_fraction = 1;
  converge(task, state);
  if (task.budget_percent() || !met(task, state)) lower_feeds(task, state, percent);
  const Round &found = state.rounds[state.best.round], &old = state.rounds[best.round];
  if (found.machine_time_s > state.allowed_s || found.error_um.p95 >= old.error_um.p95) state.best = best;
  state.activate(state.best.trial->version);
}

/// The passes before leave less, if that brings more than it spoils.
void leave_less_before(const Task& task, State& state) {
  if (!task.has(machine::Lever::allowance)) return;
  std::unique_ptr<Version> version = with_less_left(task, *state.versions.front());
  if (!version) return;
  const Kept best = state.best;
  version->index = state.versions.size();
  state.versions.push_back(std::move(version));
  state.activate(state.versions.size() - 1);
  measure_version(task, state);
  if (!cuts_into_part(task, *state.last)) {
    state.step_fraction = 1;
    converge(task, state);
  }
  const Round &found = state.rounds[state.best.round], &old = state.rounds[best.round];
  if (cuts_into_part(task, *state.best.trial) || found.error_um.p95 >= old.error_um.p95) state.best = best;
  state.activate(state.best.trial->version);
}

/// The runs whose error exceeds what is wanted are cut twice, if that fits into the time. True: more time would allow
/// more. The best of the versions is active afterwards.
bool cut_twice(const Task& task, State& state, double percent) {
  if (!task.has(machine::Lever::passes)) return false;
  const bool budget = task.budget_percent().has_value();
  Version& given = *state.versions.front();
  const std::vector<PassRun> runs = runs_after_shifts(task, given);
  const double budget_s = percent / 100 * task.given.time_s;
  const int most = most_passes(task.job);
  const std::vector<std::size_t> chosen = choose_passes(runs, budget_s, wanted_mm(task, state), most);
  const bool all_fit = chosen.size() == choose_passes(runs, kNoLimit, wanted_mm(task, state), most).size();
  const auto tried = [&] {
    return std::ranges::any_of(state.versions, [&](const auto& v) { return v->passes() == chosen; });
  };
  // Without a budget all that need it are cut twice at once: a version takes several predictions.
  SecondCutVersion made{.too_slow = !all_fit};
  if (!tried() && (budget || all_fit)) made = version_with(task, given, runs, chosen, state.allowed_s);
  if (!made.version) {
    state.activate(state.best.trial->version);
    return made.too_slow && !budget;
  }
  compensate_version(task, state, std::move(made.version), percent);
  return false;
}

}  // namespace

void spend_time(const Task& task, State& state) {
  if (task.only_shifts()) return;
  leave_less_before(task, state);
  if (!task.has(machine::Lever::feed) && !task.has(machine::Lever::passes)) return;
  state.time_points.push_back({0, state.best.round});
  const auto budget = task.budget_percent();
  std::vector<double> rungs(kRungs_percent.begin(), kRungs_percent.end());
  if (budget) rungs = {*budget};
  if (!budget && task.job.compensation.levers.empty()) rungs = {default_percent(task, state)};
  for (const double percent : rungs) {
    if (!wants_least(task, state) && met(task, state)) return;
    state.allowed_s = (1 + percent / 100 + kTimeRoom) * task.given.time_s;
    const std::size_t before = state.best.round;
    lower_feeds(task, state, percent);
    const bool more = (budget || !met(task, state)) && cut_twice(task, state, percent);
    if (state.best.round != before) state.time_points.push_back({percent, state.best.round});
    if (state.best.round == before && !more) return;  // the least feed, or nothing that a lever changes
  }
}

}  // namespace camber::compensate
