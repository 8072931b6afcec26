// fit-force on the command line.
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cli/command_line.h"
#include "cli/fit_force_command.h"
#include "cli/outputs.h"

namespace camber::cli {

void add_force_commands(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("fit-force", "fit cutting force coefficients to dynamometer logs");
  auto arguments = std::make_shared<FitForceArguments>();
  command->add_option("--log", arguments->logs, "dynamometer log: samples, or a table of means")
      ->required()
      ->expected(1)
      ->take_all()
      ->type_name("FORCE.csv");
  command
      ->add_option("--job", arguments->jobs,
                   "job.toml with the tool and [force_log]; once for each log, or once for all")
      ->required()
      ->expected(1)
      ->take_all()
      ->type_name("J.toml");
  command->add_option("-o,--output", arguments->output, "the fitted material")->required()->type_name("material.toml");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command->callback([arguments, &options, &chosen] {
    if (arguments->jobs.size() != 1 && arguments->jobs.size() != arguments->logs.size())
      throw CLI::ValidationError("--job",
                                 fmt::format("{} logs and {} jobs; one job for all or one for each was expected",
                                             arguments->logs.size(), arguments->jobs.size()));
    chosen = [arguments, &options] {
      std::vector<std::string> inputs = arguments->logs;
      inputs.insert(inputs.end(), arguments->jobs.begin(), arguments->jobs.end());
      check_outputs({arguments->output, arguments->json}, inputs);
      return run_fit_force(*arguments, options);
    };
  });
}

}  // namespace camber::cli
