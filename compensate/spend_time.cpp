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
constexpr double kPays = 0.05;       // of the 95th percentile: what feeds by default must be expected to bring
constexpr double kFollows = 1.05;    // times it: shifts that belong to new feeds need bring less than others
constexpr double kTimeRoom = 0.003;  // by which the shifts that follow a plan of feeds may exceed a budget
constexpr int kPlannings = 5;        // of feeds, until their text fits into the budget
constexpr double kReserve = 0.98;    // of the time that should fit by the last plan
constexpr double kMinExtra = 0.005;  // less extra time is not worth a round
constexpr double kWanted = 0.9;      // of the tolerance: what feeds and second cuts are chosen for
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

double wanted_mm(const Task& task) { return task.budget_percent() ? 0.0 : kWanted * task.tolerance_mm(); }

/// Lower feeds are expected to take a twentieth or more off the 95th percentile that the best shift leaves.
bool feeds_pay(const Task& task, const State& state, double percent) {
  LeftByShifts left = left_by_shifts(task, state);
  const double budget_s = percent / 100 * task.given.time_s;
  const FeedChoice choice = state.active->feeds->choose(left.path, left.of_path, left.mm, budget_s, wanted_mm(task));
  return choice.error_mm <= (1 - kPays) * p95_of(left.mm, left.area_mm2);
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
    planned_s = lever.choose(version.path, all, left, plan_s, wanted_mm(task)).extra_s;
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
  for (int i = 0; i < (budget ? kBudgetRounds : kRungRounds); ++i) {
    const bool made = i % 2 == 0
                          ? step_with_feeds(task, state, percent)
                          : shift_pays(task, version, *state.last, kFollows * state.rounds.back().error_um.p95, 1) &&
                                step(task, state, 1, nullptr);
    if (!made && i % 2 == 0) break;
    if (!made) continue;  // the shifts to these feeds would change little
    const Round &now = state.rounds.back(), &best = state.rounds[state.best.round];
    if (now.machine_time_s <= state.allowed_s && now.error_um.p95 < best.error_um.p95) take(state);
    if (!budget && met(task, state)) break;
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
  const std::vector<std::size_t> chosen = choose_passes(runs, budget_s, wanted_mm(task), most);
  const bool all_fit = chosen.size() == choose_passes(runs, kNoLimit, wanted_mm(task), most).size();
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
  if (!budget && task.job.compensation.levers.empty()) rungs = {kDefaultBudget_percent};
  for (const double percent : rungs) {
    if (!budget && met(task, state)) return;
    state.allowed_s = (1 + percent / 100 + kTimeRoom) * task.given.time_s;
    const std::size_t before = state.best.round;
    lower_feeds(task, state, percent);
    const bool more = (budget || !met(task, state)) && cut_twice(task, state, percent);
    if (state.best.round != before) state.time_points.push_back({percent, state.best.round});
    if (state.best.round == before && !more) return;  // the least feed, or nothing that a lever changes
  }
}

}  // namespace camber::compensate
