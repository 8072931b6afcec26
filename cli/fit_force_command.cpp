// camber fit-force: a material from dynamometer logs.
#include "camber/fit_force.h"

#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "cli/command_line.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/progress.h"

namespace camber::cli {
namespace {

struct FitForceArguments {
  std::vector<std::string> logs;
  std::vector<std::string> jobs;  ///< one for each log, or one for all
  std::string output;             ///< material.toml
  std::string json;               ///< empty: none
};

/// Throws InputError. Returns kDone, or kNumbersDidNotWorkOut when the fit did not converge or makes no sense (the
/// material is written all the same, and a sentence says so).
int run_fit_force(const FitForceArguments& arguments, const GlobalOptions& options) {
  std::vector<ForceLogFile> logs;
  for (std::size_t i = 0; i < arguments.logs.size(); ++i)
    logs.push_back({arguments.logs[i], arguments.jobs.size() == 1 ? arguments.jobs.front() : arguments.jobs[i]});
  ProgressLine progress(options, "reading");
  const FitForceResult result = fit_force(logs, run_options(progress, options));
  if (!options.quiet) fmt::print("{}", result.printed);
  write_file(arguments.output, result.material);
  if (!arguments.json.empty()) write_file(arguments.json, result.json);
  if (!result.success) print_error(result.message);
  return result.success ? kDone : kNumbersDidNotWorkOut;
}

}  // namespace

void add_fit_force_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
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
