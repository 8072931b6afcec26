// fit-force and fit-parts on the command line.
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cli/command_line.h"
#include "cli/fit_force_command.h"
#include "cli/fit_parts_command.h"
#include "cli/outputs.h"

namespace camber::cli {

namespace {

void add_fit_parts(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command =
      app.add_subcommand("fit-parts", "fit forces, stiffness, gains and tool diameters to measured features of parts");
  auto arguments = std::make_shared<FitPartsArguments>();
  command->add_option("jobs", arguments->jobs, "jobs whose [[feature]] have measured values")
      ->required()
      ->type_name("J.toml");
  command
      ->add_option("-o,--output", arguments->folder, "folder for machine.toml, tools.toml, material.toml, report.html")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--hold-out", arguments->hold_out,
                   "job (its file without ending) or part that is judged, not fitted")
      ->expected(1)
      ->take_all()
      ->type_name("NAME");
  command->add_flag("--suggest", arguments->suggest, "say what experiment would tell what is not determined");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      check_output_folder(arguments->folder);
      check_outputs({arguments->json}, arguments->jobs);
      return run_fit_parts(*arguments, options);
    };
  });
}

}  // namespace

void add_force_commands(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  add_fit_parts(app, options, chosen);
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
