// camber check: read and interpret a program, report, change nothing; with a machine or a job also whether they fit.
#include "camber/check.h"

#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "camber/explain_kinematics.h"
#include "cli/command_line.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/program_options.h"
#include "cli/progress.h"

namespace camber::cli {
namespace {

struct CheckArguments {
  std::string program;             ///< empty: the job's
  std::string json;                ///< file for the figures; empty: none
  std::string machine;             ///< machine.toml; empty: none
  std::string job;                 ///< job.toml, whose machine counts; empty: none
  std::string sheet;               ///< set-up sheet; needs a job; empty: none
  std::string explain_kinematics;  ///< machine.toml or job.toml to explain instead of a program; empty: none
  CheckOptions options{};
  ReadOptions read{};
};

/// Prints what check has found, which is its result. Returns 1 where --strict makes errors of it.
template <class Result>
int finish_check(const Result& result, const std::string& json, const GlobalOptions& options) {
  if (!json.empty()) write_file(json, result.json);
  if constexpr (requires { result.printed; }) {
    if (!options.quiet) fmt::print("{}", result.printed);
  } else {
    if (!options.quiet) fmt::print("{}", result.text);
  }
  std::fflush(stdout);
  settle(result.diagnostics, options);
  return kDone;
}

/// Throws InputError. Returns kDone.
int run_check(const CheckArguments& arguments, const GlobalOptions& options) {
  if (!arguments.explain_kinematics.empty())
    return finish_check(explain_kinematics(arguments.explain_kinematics), arguments.json, options);
  auto progress = std::make_unique<ProgressLine>(options, "reading");
  RunOptions run = run_options(*progress, options);
  run.warn = {};
  CheckOptions asked = arguments.options;
  asked.program = arguments.program;
  asked.sheet = !arguments.sheet.empty();
  if (!arguments.job.empty()) {
    const CheckedJob result = check_job(arguments.job, arguments.read, asked, run);
    progress.reset();
    if (asked.sheet) write_file(arguments.sheet, result.sheet);
    return finish_check(result, arguments.json, options);
  }
  CheckResult result;
  if (arguments.machine.empty()) {
    result = check(read_program(arguments.program, arguments.read), asked, run);
  } else {
    const Machine machine = read_machine(arguments.machine);
    result = check(read_program(arguments.program, arguments.read), machine, asked, run);
  }
  progress.reset();
  return finish_check(result, arguments.json, options);
}

}  // namespace

void add_check_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("check", "read and interpret a program and report problems; change nothing");
  auto arguments = std::make_shared<CheckArguments>();
  auto* program =
      command->add_option("program", arguments->program, "NC program; default: the job's")->type_name("P.nc");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  auto* machine =
      command->add_option("--machine", arguments->machine, "machine.toml: also check axes, feeds and spindle speeds");
  machine->type_name("M.toml");
  command->add_option("--job", arguments->job, "job.toml: also check its machine, tools, stock and part")
      ->type_name("J.toml")
      ->excludes(machine);
  add_tool_lengths(*command, arguments->read);
  add_work_offsets(*command, arguments->read);
  auto* page = command->add_option("--report", arguments->options.page, "report page with a picture of the path");
  page->type_name("R.html");
  command
      ->add_option("--path", arguments->options.path,
                   "the path's points with line, tool and feed, as arrays for pictures")
      ->type_name("P.bin");
  command
      ->add_option("--meshes", arguments->options.meshes,
                   "part and blank at their places, as NAME-part.stl and NAME-blank.stl; none of a box")
      ->type_name("NAME")
      ->needs("--job");
  auto* sheet = command->add_option("--sheet", arguments->sheet,
                                    "set-up sheet for A4: blank and zero, tools to scale, offsets, limits, times");
  sheet->type_name("OUT.html")->needs("--job");
  command
      ->add_option("--explain-kinematics", arguments->explain_kinematics,
                   "instead of a program: the axes of a machine from the part to the spindle, and what a positive word "
                   "of each turns which way")
      ->type_name("M.toml|J.toml")
      ->excludes(program)
      ->excludes(page)
      ->excludes(sheet)
      ->excludes("--machine")
      ->excludes("--job");
  add_reading_options(*command, arguments->read);
  add_language_options(*command, arguments->read);
  command->callback([arguments, &options, &chosen] {
    if (arguments->program.empty() && arguments->job.empty() && arguments->explain_kinematics.empty())
      throw CLI::RequiredError("program or --job");
    chosen = [arguments, &options] {
      check_outputs({arguments->json, arguments->options.page, arguments->sheet, arguments->options.path},
                    {arguments->program, arguments->machine, arguments->job, arguments->explain_kinematics});
      return run_check(*arguments, options);
    };
  });
}

}  // namespace camber::cli
