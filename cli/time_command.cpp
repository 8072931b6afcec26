// camber time: how long a program takes, by kind of operation and by tool; what-if; against a measured run.
#include "camber/time.h"

#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "cli/command_line.h"
#include "cli/outputs.h"
#include "cli/program_options.h"
#include "cli/progress.h"

namespace camber::cli {
namespace {

struct TimeArguments {
  std::string program, machine;
  std::string json;    ///< empty: none
  std::string report;  ///< empty: none
  TimeOptions options{};
  ReadOptions read{};
};

/// Throws InputError. Returns kDone.
int run_time(const TimeArguments& arguments, const GlobalOptions& options) {
  ProgressLine progress(options, "timing");
  const RunOptions run = run_options(progress, options);
  TimeOptions asked = arguments.options;
  asked.page = !arguments.report.empty();
  TimeResult result;
  if (arguments.machine.empty()) {
    result = time(read_program(arguments.program, arguments.read), asked, run);
  } else {
    const Machine machine = read_machine(arguments.machine);
    result = time(read_program(arguments.program, arguments.read), machine, asked, run);
  }
  if (!options.quiet) fmt::print("{}", result.printed);
  if (!arguments.json.empty()) write_file(arguments.json, result.json);
  if (!arguments.report.empty()) write_file(arguments.report, result.page);
  return kDone;
}

}  // namespace

void add_time_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("time", "cycle time by kind of operation and by tool; what-if sweeps");
  auto arguments = std::make_shared<TimeArguments>();
  command->add_option("program", arguments->program, "NC program")->required()->type_name("P.nc");
  auto* machine = command->add_option("--machine", arguments->machine, "machine.toml")->type_name("M.toml");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  auto* trace = command->add_option("--trace", arguments->options.trace, "measured run to compare with");
  trace->type_name("T.csv");
  auto* sweep = command->add_option("--sweep", arguments->options.sweeps, "sweep a machine parameter over N values");
  sweep->expected(1)->take_all()->type_name("KEY=FROM:TO:N")->needs(machine)->excludes(trace);
  sweep->check(CLI::Validator(
      [](std::string& text) {
        try {
          check_sweep(text);
        } catch (const std::invalid_argument& problem) {
          return std::string(problem.what());
        }
        return std::string();
      },
      ""));
  auto* cases = command->add_option("--case", arguments->options.cases, "machines to compare");
  cases->type_name("cases.toml")->excludes(trace)->excludes(sweep);
  command->add_option("--report", arguments->report, "report page")->type_name("R.html");
  add_tool_lengths(*command, arguments->read);
  add_work_offsets(*command, arguments->read);
  add_reading_options(*command, arguments->read);
  command->callback([arguments, &options, &chosen] {
    if (arguments->machine.empty() && arguments->options.cases.empty())
      throw CLI::ValidationError("time", "--machine M.toml or --case cases.toml was expected");
    chosen = [arguments, &options] {
      if (options.effective_config && !arguments->machine.empty())
        return print_effective_machine(arguments->machine, options);
      check_outputs({arguments->json, arguments->report},
                    {arguments->program, arguments->machine, arguments->options.trace, arguments->options.cases});
      return run_time(*arguments, options);
    };
  });
}

}  // namespace camber::cli
