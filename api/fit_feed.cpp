#include "camber/fit_feed.h"

#include "api/commands/fit_feed.h"
#include "api/job.h"
#include "api/program.h"
#include "api/run.h"

namespace camber {
namespace {

Machine machine_of(const machine::Machine& fitted) {
  auto impl = std::make_shared<Machine::Impl>();
  impl->machine = fitted;
  return Machine(std::move(impl));
}

std::vector<FitParameter> parameters_of(const std::vector<calib::FitParameter>& parameters) {
  std::vector<FitParameter> out;
  out.reserve(parameters.size());
  for (const auto& p : parameters)
    out.push_back({p.name, p.value, p.unit, p.std_error, p.note, p.written, p.stretches, p.changed_from});
  return out;
}

}  // namespace

FitFeedResult v0::fit_feed(const std::vector<FeedTrace>& traces, const Machine& start, const FitFeedOptions& options,
                           const RunOptions& run_options) {
  if (traces.empty()) fail_on_file(start.path(), "a program and its trace are required", "fit-runs");
  FitFeedResult result{.machine = start};
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found = start.impl().found;
    std::vector<api::TracedProgram> traced;
    for (const FeedTrace& one : traces) {
      found.append(one.program.impl().found);
      traced.push_back({one.program.path(), &one.program.impl().text, one.trace, one.program.impl().options});
    }
    const api::FeedRuns runs = api::read_runs(traced, options.columns, start.impl().machine, found);
    run.settle(found);
    run.show("fitting", 0);
    const api::FeedFit fit = api::fit_runs(runs, start.impl().machine, {.update = options.update});
    std::visit(
        [&](const auto& fitted) {
          result.machine = machine_of(fitted.machine);
          result.parameters = parameters_of(fitted.parameters);
          result.converged = fitted.converged;
          result.message = fitted.message;
        },
        fit);
    result.diagnostics = found.all();
    result.json = api::fit_json(fit);
  });
  return result;
}

}  // namespace camber
