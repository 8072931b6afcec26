#include "cli/time_command.h"

#include <optional>

#include <fmt/format.h>

#include "api/commands/time.h"
#include "base/output_file.h"
#include "cli/console.h"
#include "cli/progress.h"
#include "machine/assumptions.h"
#include "report/cycle_page.h"

namespace camber::cli {

int run_time(const TimeArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  ProgressLine progress(options, "timing");
  std::optional<machine::Machine> machine;
  if (!arguments.machine.empty()) machine = machine::read_machine(arguments.machine, diagnostics);
  api::TimedProgram timed = api::time_program({.program = arguments.program,
                                               .machine_path = arguments.machine,
                                               .machine = machine ? &*machine : nullptr,
                                               .trace = arguments.trace,
                                               .cases = arguments.cases,
                                               .sweeps = arguments.sweeps,
                                               .interpreter = arguments.interpreter,
                                               .picture = !arguments.report.empty(),
                                               .progress = [&](double fraction) { progress.show("timing", fraction); }},
                                              diagnostics);
  const api::TimeReport& out = timed.report;
  progress.clear();
  settle(diagnostics, options);
  const auto assumed = machine ? machine::assumptions(*machine) : std::vector<std::string>{};
  if (!options.quiet) fmt::print("{}{}", machine::assumptions_text(assumed), api::time_text(out));
  if (!arguments.json.empty()) write_file(arguments.json, machine::with_assumptions(api::time_json(out), assumed));
  if (!arguments.report.empty())
    write_file(arguments.report, report::cycle_page({.title = "Cycle time: " + out.program,
                                                     .subtitle = out.machine,
                                                     .keys = out.keys,
                                                     .rows = out.rows,
                                                     .picture = std::move(timed.picture),
                                                     .machine = std::move(timed.machine),
                                                     .notes = out.notes}));
  return kDone;
}

}  // namespace camber::cli
