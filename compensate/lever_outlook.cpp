#include "compensate/lever_outlook.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "compensate/judge.h"
#include "compensate/passes.h"
#include "compensate/propose.h"
#include "compensate/second_cuts.h"

namespace camber::compensate {
namespace {

constexpr double kPays = 0.1;        // of the 95th percentile
constexpr double kLongest = 2;       // of the given machine time, in addition
constexpr double kWanted = 0.9;      // of the tolerance
constexpr double kShortest = 0.005;  // of the given machine time: what takes less is what the shifts do

/// The best round's observations, and what the best shifts leave of them.
struct Left {
  ShiftPath path;
  std::vector<Observation> of_path;
  std::vector<double> mm, area_mm2;
};

Left left_by_shifts(const Task& task, const State& state) {
  const Version& version = *state.active;
  const Trial& best = *state.best.trial;
  Left out{version.path, best.observed.of_path(), {}, {}};
  out.path.set_shifts(best.shifts);
  FeedLever::set_fractions(out.path, best.fractions);
  out.mm = left_by_shift_mm(out.path, out.of_path, fit_options(task, version));
  for (const Observation& o : out.of_path) out.area_mm2.push_back(o.area_mm2);
  return out;
}

std::optional<LeverOutlook> of_second_cuts(const Task& task, const State& state, const Left& left) {
  if (state.active->repeated) return std::nullopt;
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

std::optional<LeverOutlook> of_lower_feeds(const Task& task, const State& state, const Left& left) {
  if (task.feed_unusable || state.rounds[state.best.round].slowed > 0) return std::nullopt;
  const simulate::SimulatedProgram& program = *state.active->source.program;
  Diagnostics unusable;
  check_feeds(program, state.active->compensated, unusable);
  if (!unusable.all().empty()) return std::nullopt;
  ShiftPath path = left.path;
  const std::vector<double> least =
      least_feeds(path, program.moves_in_part(), task.job.machine, task.job.compensation.min_feed_percent / 100);
  FeedLever lever(path, program, !std::isinf(task.spacing_mm()), least);
  const FeedChoice choice =
      lever.choose(path, left.of_path, left.mm, kLongest * task.given.time_s, kWanted * task.tolerance_mm());
  return LeverOutlook{machine::Lever::feed, 1000 * choice.error_mm, choice.extra_s};
}

}  // namespace

std::vector<LeverOutlook> unused_levers(const Task& task, const State& state) {
  std::vector<LeverOutlook> out;
  if (!task.job.workpiece) return out;
  const Left left = left_by_shifts(task, state);
  const double now_um = state.rounds[state.best.round].error_um.p95;
  for (const auto& found : {of_second_cuts(task, state, left), of_lower_feeds(task, state, left)})
    if (found && found->p95_um <= (1 - kPays) * now_um && found->extra_s >= kShortest * task.given.time_s)
      out.push_back(*found);
  return out;
}

}  // namespace camber::compensate
