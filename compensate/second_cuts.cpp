#include "compensate/second_cuts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "checks/collisions.h"
#include "compensate/fit_shift.h"
#include "compensate/judge.h"
#include "compensate/propose.h"
#include "motion/operations.h"

namespace camber::compensate {

using simulate::SimulatedProgram;

namespace {

constexpr std::size_t kDropped = 10;  // where the chosen runs take too long, one in so many is left as it is

/// Removes the run that contains the given program's move, or the last run before it.
std::vector<std::size_t> without_run_at(const std::vector<PassRun>& runs, std::vector<std::size_t> chosen,
                                        std::uint32_t move) {
  auto last = chosen.begin();
  for (auto r = chosen.begin(); r != chosen.end(); ++r)
    if (runs[*r].run.first_move <= move) last = r;
  chosen.erase(last);
  return chosen;
}

/// Removes cuts before which the least error is left: as many as take the time that is too much, if they take the mean
/// of all, but no more than a tenth. `chosen`: ascending; they take `times_too_long` of the time that they may.
std::vector<std::size_t> without_least(const std::vector<PassRun>& runs, const std::vector<std::size_t>& chosen,
                                       double times_too_long) {
  std::vector<std::pair<double, std::size_t>> before_mm;  // what is left before each cut, and its run
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const bool again = i > 0 && chosen[i] == chosen[i - 1];
    before_mm.emplace_back(again ? kLeftByCut * before_mm.back().first : runs[chosen[i]].left_mm, chosen[i]);
  }
  std::ranges::stable_sort(before_mm, [](const auto& a, const auto& b) { return a.first > b.first; });
  const auto count = static_cast<double>(chosen.size());
  const auto over = static_cast<std::size_t>(std::max(1.0, std::ceil(count - count / times_too_long)));
  before_mm.resize(chosen.size() - std::min(over, (chosen.size() + kDropped - 1) / kDropped));
  std::vector<std::size_t> out;
  out.reserve(before_mm.size());
  for (const auto& [left, run] : before_mm) out.push_back(run);
  std::ranges::sort(out);
  return out;
}

/// The given program's block before which a rapid between two cuts collides.
std::optional<std::uint32_t> block_behind_collision(const machine::Job& job, const SimulatedProgram& program,
                                                    const nc::RepeatedText& text, const removal::Stock& blank) {
  if (job.simulation.collisions == machine::Collisions::off) return std::nullopt;
  for (const checks::Collision& c : checks::find_collisions(job, program, blank)) {
    std::size_t line = program.moves_in_part().moves[c.move].block;
    if (!text.added[line] || text.block_of_line[line] != nc::Emission::kNoBlock) continue;
    while (text.added[line]) ++line;
    return text.block_of_line[line];
  }
  return std::nullopt;
}

/// The program of first cuts.
struct FirstCuts {
  nc::Emission emission;
  double allowance_mm = 0;
};

/// The best path without lower feeds, lifted by the allowance; the given path where that needs less of it, since it
/// cuts less deep into the part: a second cut puts nothing back.
FirstCuts first_cuts(const Task& task, Version& given) {
  const auto allowance_of = [&](const Trial& trial) {
    const Depth depth = depth_of(trial.surface, trial.observed, task.given.depth_limit_um, true);
    return pass_allowance_mm(depth.gouge_depth_p999_um / 1000, task.tolerance_mm());
  };
  const Trial &as_given = *task.given.trial, &best = *given.best_shifted;
  const double given_mm = allowance_of(as_given), best_mm = allowance_of(best);
  const Trial& base = given_mm < best_mm ? as_given : best;
  const double own = task.job.compensation.pass_allowance_mm;
  FirstCuts out;
  out.allowance_mm = own > 0 ? own : std::min(given_mm, best_mm);
  std::vector<Observation> wanted = base.observed.of_path();
  for (Observation& o : wanted) o.error_mm = -out.allowance_mm;
  ShiftPath& path = given.path;
  path.set_shifts(base.shifts);
  const std::vector<double> full_feeds(path.points().size(), 1.0);
  FeedLever::set_fractions(path, full_feeds);
  ThinPath thin(path, given.splits.kept());
  const std::vector<double> stiffness = thin.greatest_of(given.stiffness);
  const std::vector<RowLink> links = row_links(thin.path(), kRowReach_mm);
  FitShiftOptions options = fit_options(task, stiffness, links, {});
  options.max_shift_mm += out.allowance_mm;
  options.bounded = false;
  fit_shift(thin.path(), thin.places_of(wanted), options);
  thin.give_shifts(path);
  out.emission = text_of(given.source, path, given.splits.kept());
  return out;
}

void warn_of_run(const Task& task, std::uint32_t block, const std::string& why, const char* check) {
  const nc::Program& text = task.setup->program.text();
  task.diagnostics.add(text.source.diagnostic(Severity::warning, text.blocks[block].offset,
                                              fmt::format("the cuts here are made once: the moves {}", why), check));
}

}  // namespace

std::unique_ptr<Version> taken_over(const Task& task, const Version& given, const machine::Job& job,
                                    SimulatedProgram program, EarlierCuts repeated) {
  ShiftedProgram source = given.source;
  source.leading = nullptr;
  const std::size_t count = program.moves_in_part().moves.size();
  std::vector<bool> compensated(count, false);
  for (std::size_t m = 0; m < repeated.moves.size(); ++m) compensated[repeated.moves[m]] = given.compensated[m];
  source.first_cuts.resize(count);
  for (std::size_t m = 0; m < count; ++m)
    source.first_cuts[m] = repeated.text.added[program.moves_in_part().moves[m].block];
  for (simulate::PathFraction& stamp : source.stamps) stamp.move = repeated.moves[stamp.move];
  // What the nominal chip bends is not what the second cut's does: of hidden rows only the offset of the axes counts.
  source.bending.assign(source.bending.size(), Vec3::Zero());
  source.job = job;
  source.program = std::make_shared<const SimulatedProgram>(std::move(program));
  auto out = std::make_unique<Version>(std::move(source), std::move(compensated), task.spacing_mm());
  out->repeated = std::move(repeated);
  return out;
}

std::vector<PassRun> runs_after_shifts(const Task& task, Version& given) {
  const Trial& base = *given.best_shifted;
  given.path.set_shifts(base.shifts);
  const std::vector<Observation> all = base.observed.of_path();
  const std::vector<double> left = left_by_shift_mm(given.path, all, fit_options(task, given));
  return pass_runs(task.setup->program, given.compensated, given.path, all, left);
}

SecondCutVersion version_with(const Task& task, Version& given, const std::vector<PassRun>& runs,
                              std::vector<std::size_t> chosen, double allowed_s) {
  const SimulatedProgram& program = task.setup->program;
  const FirstCuts first = first_cuts(task, given);
  SecondCutVersion out;
  while (!chosen.empty()) {
    EarlierCuts repeated{.text = with_first_cuts(program, runs, chosen, first.emission),
                         .allowance_mm = first.allowance_mm};
    machine::Job job = task.job;
    job.operations = moved_ranges(motion::as_lines(job.operations, program.text(), program.moves_in_part()),
                                  repeated.text.block_of_line);
    Diagnostics ignored;  // the given program's
    SimulatedProgram made = motion::simulate_motion(SourceText(job.program, repeated.text.text), job, {}, ignored);
    std::uint32_t wrong = 0;
    auto moves = moves_in_repeated(program.moves_in_part(), made.moves_in_part(), repeated.text, wrong);
    if (!moves) {
      warn_of_run(task, program.moves_in_part().moves[wrong].block, nc::to_string(nc::RunGap::modal), "not-repeatable");
      chosen = without_run_at(runs, chosen, wrong);
      continue;
    }
    if (made.feed.time_s > allowed_s) {
      out.too_slow = true;
      if (!task.budget_percent()) return out;  // all of them within the next step of time
      const double given_s = program.feed.time_s;
      chosen = without_least(runs, chosen, (made.feed.time_s - given_s) / std::max(allowed_s - given_s, 1e-9));
      continue;
    }
    if (const auto block = block_behind_collision(job, made, repeated.text, task.setup->target.blank)) {
      warn_of_run(task, *block, "cannot be reached again by a rapid through the stock that is left", "pass-collision");
      std::erase_if(chosen, [&](std::size_t r) { return runs[r].run.first_block == *block; });
      continue;
    }
    repeated.runs = chosen;
    repeated.moves = std::move(*moves);
    out.version = taken_over(task, given, job, std::move(made), std::move(repeated));
    return out;
  }
  return out;
}

LeftByShifts left_by_shifts(const Task& task, const State& state) {
  const Version& version = *state.active;
  const Trial& best = *state.best.trial;
  LeftByShifts out{version.path, best.observed.of_path(), {}, {}};
  out.path.set_shifts(best.shifts);
  FeedLever::set_fractions(out.path, best.fractions);
  out.mm = left_by_shift_mm(out.path, out.of_path, fit_options(task, version));
  for (const Observation& o : out.of_path) out.area_mm2.push_back(o.area_mm2);
  return out;
}

namespace {

constexpr double kPays = 0.1;        // of the 95th percentile
constexpr double kLongest = 2;       // of the given machine time, in addition
constexpr double kWanted = 0.9;      // of the tolerance
constexpr double kShortest = 0.005;  // of the given machine time: what takes less is what the shifts do

std::optional<LeverOutlook> of_second_cuts(const Task& task, const State& state, const LeftByShifts& left) {
  if (state.active->repeated || !task.job.workpiece) return std::nullopt;
  const std::vector<PassRun> runs =
      pass_runs(*state.active->source.program, state.active->compensated, left.path, left.of_path, left.mm);
  const std::vector<std::size_t> chosen =
      choose_passes(runs, kLongest * task.given.time_s, kWanted * task.tolerance_mm(), most_passes(task.job));
  if (chosen.empty()) return std::nullopt;
  LeverOutlook out{.lever = machine::Lever::passes};
  for (const std::size_t r : chosen) out.extra_s += runs[r].time_s;
  std::vector<double> then = left_after_passes_mm(runs, chosen, left.path, left.of_path, left.mm);
  out.p95_um = 1000 * p95_of(then, left.area_mm2);
  return out;
}

std::optional<LeverOutlook> of_lower_feeds(const Task& task, const State& state, const LeftByShifts& left) {
  if (task.feed_unusable) return std::nullopt;
  const simulate::SimulatedProgram& program = *state.active->source.program;
  Diagnostics unusable;
  check_feeds(program, state.active->compensated, unusable);
  if (!unusable.all().empty()) return std::nullopt;
  ShiftPath path = left.path;
  std::optional<FeedLever> lever = state.active->feeds;
  if (!lever) {
    const std::vector<double> least =
        least_feeds(path, program.moves_in_part(), task.job.machine, task.job.compensation.min_feed_percent / 100);
    lever.emplace(path, program, !std::isinf(task.spacing_mm()), least);
  }
  const FeedChoice choice =
      lever->choose(path, left.of_path, left.mm, kLongest * task.given.time_s, kWanted * task.tolerance_mm());
  const double spent_s = state.rounds[state.best.round].machine_time_s - program.feed.time_s;
  return LeverOutlook{machine::Lever::feed, 1000 * choice.error_mm, choice.extra_s - spent_s};
}

}  // namespace

std::vector<LeverOutlook> unused_levers(const Task& task, const State& state) {
  std::vector<LeverOutlook> out;
  const LeftByShifts left = left_by_shifts(task, state);
  const double now_um = state.rounds[state.best.round].error_um.p95;
  for (const auto& found : {of_second_cuts(task, state, left), of_lower_feeds(task, state, left)})
    if (found && found->p95_um <= (1 - kPays) * now_um && found->extra_s >= kShortest * task.given.time_s)
      out.push_back(*found);
  return out;
}

}  // namespace camber::compensate
