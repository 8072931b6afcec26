#include "compensate/compensate.h"

#include <fmt/format.h>

#include "compensate/loop.h"

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
  Loop loop(job, diagnostics, options);
  loop.start(out);
  loop.converge(out);
  loop.spend_time(out);
  loop.stay_out_of_part(out);
  loop.choose(out);
  loop.finish(out);
  loop.check(out);
  return out;
}

}  // namespace camber::compensate
