#include "compensate/compensate_path.h"

#include <fmt/format.h>

#include "compensate/judge.h"
#include "compensate/measure.h"
#include "compensate/outcome.h"
#include "compensate/rounds.h"
#include "compensate/spend_time.h"

namespace camber::compensate {

std::string to_string(Stop stop) {
  switch (stop) {
    case Stop::tolerance:
      return "tolerance";
    case Stop::stalled:
      return "stalled";
    case Stop::depth_limit:
      return "depth_limit";
    case Stop::rounds:
      break;
  }
  return "rounds";
}

CompensationResult compensate(const machine::Job& job, Diagnostics& diagnostics, const CompensateOptions& options) {
  const auto& levers = job.compensation;
  const auto budget = options.time_budget_percent ? options.time_budget_percent : levers.time_budget_percent;
  if (budget && !levers.has(machine::Lever::feed) && !levers.has(machine::Lever::passes))
    diagnostics.add({Severity::error,
                     {job.path, 0, 0},
                     fmt::format("a time budget of {:g} % has no lever to use it; levers = [\"shift\", \"feed\"] was "
                                 "expected in [compensation]",
                                 *budget),
                     "lever-missing",
                     {}});
  diagnostics.throw_if_errors();

  CompensationResult out;
  Task task = open_task(job, options, diagnostics);
  State state = measure_given(task, out);
  converge(task, state);
  spend_time(task, state);
  combine_rounds(task, state);
  stay_out_of_part(task, state);
  const bool better = choose(task, state);
  conclude(task, state, better, out);
  check_outcome(task, state, out);
  return out;
}

}  // namespace camber::compensate
