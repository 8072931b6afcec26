// check, feed and fit-feed on the command line.
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cli/check_command.h"
#include "cli/command_line.h"
#include "cli/console.h"
#include "cli/feed_command.h"
#include "cli/fit_feed_command.h"
#include "cli/protocol_command.h"
#include "machine/machine.h"

namespace camber::cli {
namespace {

void add_interpreter_options(CLI::App& command, nc::InterpreterOptions& interpreter) {
  command.add_option("--units", interpreter.inch, "unit of a program that has neither G20 nor G21")
      ->transform(CLI::CheckedTransformer(std::map<std::string, bool>{{"mm", false}, {"inch", true}}).description(""))
      ->type_name("mm|inch");
  command.add_flag("--block-skip", interpreter.skip_slash_blocks, "leave out blocks that begin with /");
}

int print_effective_machine(const std::string& path, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const machine::Machine machine = machine::read_machine(path, diagnostics);
  settle(diagnostics, options);
  fmt::print("# {}\n{}", path, machine::to_toml(machine));
  return kDone;
}

/// What check finds is its result: it is printed, and what --strict makes errors ends it with 1.
int check(const CheckCommand& command, const GlobalOptions& options) {
  Diagnostics diagnostics;
  std::ostream silent(nullptr);
  const int status = run_check(command, diagnostics, options.quiet ? silent : std::cout);
  std::cout.flush();
  settle(diagnostics, options);
  return status;
}

/// Outputs may be written, and are none of the files that are read. (A machine file may be fitted in its place.)
void check_outputs(std::initializer_list<std::string> outputs, const std::vector<std::string>& inputs) {
  for (const auto& output : outputs) {
    require_folder_of(output);
    require_not_an_input(output, inputs);
  }
}

void add_check(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("check", "read and interpret a program, report, change nothing");
  auto arguments = std::make_shared<CheckCommand>();
  command->add_option("program", arguments->program, "NC program")->required()->type_name("P.nc");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  add_interpreter_options(*command, arguments->interpreter);
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      check_outputs({arguments->json}, {arguments->program});
      return check(*arguments, options);
    };
  });
}

void add_feed(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("feed", "actual feed along a program, and its time");
  auto arguments = std::make_shared<FeedArguments>();
  command->add_option("program", arguments->program, "NC program")->required()->type_name("P.nc");
  command->add_option("--machine", arguments->machine, "machine.toml")->required()->type_name("M.toml");
  command->add_option("-o,--output", arguments->output, "the axes at every period")->type_name("feed.csv");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  add_interpreter_options(*command, arguments->interpreter);
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_machine(arguments->machine, options);
      check_outputs({arguments->output, arguments->json}, {arguments->program, arguments->machine});
      return run_feed(*arguments, options);
    };
  });
}

void add_fit_feed(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("fit-feed", "fit a machine's feed model to servo traces");
  auto arguments = std::make_shared<FitFeedArguments>();
  command->add_option("--program", arguments->programs, "a program that was run; once for each trace")
      ->required()
      ->expected(1)
      ->take_all()
      ->type_name("P.nc");
  command
      ->add_option("--trace", arguments->traces,
                   "what the machine did: servo trace, MTConnect log or table of stretch times")
      ->required()
      ->expected(1)
      ->take_all()
      ->type_name("T");
  command->add_option("--columns", arguments->columns, "what the columns of the servo traces are, where they are not ours")
      ->type_name("C.toml");
  command->add_option("--machine", arguments->machine, "machine to start from")->required()->type_name("M.toml");
  command->add_option("-o,--output", arguments->output, "the fitted machine")->required()->type_name("fitted.toml");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command->add_option("--block-time-plot", arguments->block_time_plot,
                      "speed against block length of the saturated runs")->type_name("P.svg");
  command->add_flag("--leave-one-out", arguments->leave_one_out,
                    "predict each servo trace by a fit on the others as well (takes a fit for each)");
  add_interpreter_options(*command, arguments->interpreter);
  command->callback([arguments, &options, &chosen] {
    if (arguments->programs.size() != arguments->traces.size())
      throw CLI::ValidationError("--trace",
                                 fmt::format("{} programs and {} traces; as many of one as of the other were expected",
                                             arguments->programs.size(), arguments->traces.size()));
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_machine(arguments->machine, options);
      check_outputs({arguments->output, arguments->json}, arguments->programs);
      check_outputs({arguments->output, arguments->json}, arguments->traces);
      return run_fit_feed(*arguments, options);
    };
  });
}

void add_protocol(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("protocol", "programs to run on a machine so that fit-feed has what it needs");
  auto arguments = std::make_shared<ProtocolArguments>();
  command->add_option("--machine", arguments->machine, "machine.toml")->required()->type_name("M.toml");
  command->add_option("-o,--output", arguments->folder, "folder for the programs")->required()->type_name("DIR");
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_machine(arguments->machine, options);
      return run_protocol(*arguments, options);
    };
  });
}

}  // namespace

void add_program_commands(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  add_check(app, options, chosen);
  add_feed(app, options, chosen);
  add_fit_feed(app, options, chosen);
  add_protocol(app, options, chosen);
}

}  // namespace camber::cli
