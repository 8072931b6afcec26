// copy on the command line.
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "api/commands/copy.h"
#include "cli/command_line.h"
#include "cli/console.h"
#include "cli/copy_command.h"

namespace camber::cli {
namespace {

int print_effective_copy_job(const std::string& path, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const api::CopyJob job = api::read_copy_job(path, diagnostics);
  settle(diagnostics, options);
  fmt::print("# {}\n{}", path, machine::to_toml(job.job));
  for (const machine::CopyOperation& o : job.operations) fmt::print("{}", machine::to_toml(o));
  fmt::print("\n# {}\n{}", job.job.machine_path, machine::to_toml(job.job.machine));
  return kDone;
}

}  // namespace

void add_copy_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("copy", "make paths from the part's model while the tool cuts");
  auto arguments = std::make_shared<CopyArguments>();
  command->add_option("job", arguments->job, "job.toml with [part] mesh and [[copy]]")->required()->type_name("J.toml");
  command->add_option("-o,--output", arguments->output, "the program")->required()->type_name("OUT.nc");
  command->add_option("--stream", arguments->stream, "positions, feed and load, a row a tick of the control")
      ->type_name("S.csv");
  command->add_option("--stock", arguments->stock, "the stock that is left")->type_name("OUT.vdb");
  command
      ->add_option("--stop-after", arguments->stop_after_s,
                   "stop after this time, s, and lift the tool; with --stock the run can be taken up again")
      ->check(CLI::PositiveNumber)
      ->type_name("SECONDS");
  command->add_option("--log", arguments->log, "changes of feed and depths: time, place, reason")->type_name("LOG.csv");
  command
      ->add_option("--hardness", arguments->hardness,
                   "boxes in which the material is harder by a factor: the cut feels it, the rule has to find out")
      ->type_name("REGIONS.csv");
  command->add_option("--report", arguments->report, "page with the path, loads and feeds")->type_name("R.html");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_copy_job(arguments->job, options);
      return run_copy(*arguments, options);
    };
  });
}

}  // namespace camber::cli
