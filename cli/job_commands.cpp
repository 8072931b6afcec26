// predict and compensate on the command line.
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cli/command_line.h"
#include "cli/compensate_command.h"
#include "cli/console.h"
#include "cli/predict_command.h"
#include "machine/job.h"

namespace camber::cli {
namespace {

int print_effective_job(const std::string& path, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const machine::Job job = machine::read_job(path, diagnostics);
  settle(diagnostics, options);
  fmt::print("# {}\n{}\n# {}\n{}", path, machine::to_toml(job), job.machine_path, machine::to_toml(job.machine));
  return kDone;
}

/// Outputs may be written, and are none of the job's own files.
void check_outputs(const std::string& job_path, std::initializer_list<std::string> outputs) {
  Diagnostics diagnostics;
  const machine::Job job = machine::read_job(job_path, diagnostics);
  for (const auto& output : outputs) {
    require_folder_of(output);
    require_not_an_input(output, {job_path, job.program, job.machine_path, job.stock.mesh, job.stock.vdb, job.part.mesh,
                                  job.part.program});
  }
}

void add_predict(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("predict", "cutting force, deflection and form error of a job");
  auto arguments = std::make_shared<PredictArguments>();
  command->add_option("job", arguments->job, "job.toml")->required()->type_name("J.toml");
  command->add_option("-o,--output", arguments->output_folder, "folder for the results")->required()->type_name("DIR");
  command->add_option("--json", arguments->json, "write the figures here as well")->type_name("R.json");
  command
      ->add_option("--forces-at", arguments->forces_at,
                   "write forces_at_LINE.csv: one turn of the spindle at this line, in degrees, tooth by tooth")
      ->check(CLI::Range(std::size_t{1}, std::size_t{2000000000}))
      ->type_name("LINE");
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_job(arguments->job, options);
      check_outputs(arguments->job, {arguments->json});
      Diagnostics diagnostics;
      require_not_an_input(arguments->output_folder + "/stock.vdb",
                           {machine::read_job(arguments->job, diagnostics).stock.vdb});
      return run_predict(*arguments, options);
    };
  });
}

void add_compensate(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("compensate", "move the path of a job against its form error");
  auto arguments = std::make_shared<CompensateArguments>();
  command->add_option("job", arguments->job, "job.toml")->required()->type_name("J.toml");
  command->add_option("-o,--output", arguments->output, "the new program")->required()->type_name("OUT.nc");
  command->add_option("--report", arguments->report, "a page with pictures of before and after")->type_name("R.html");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_job(arguments->job, options);
      check_outputs(arguments->job, {arguments->output, arguments->report, arguments->json});
      return run_compensate(*arguments, options);
    };
  });
}

}  // namespace

void add_job_commands(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  add_predict(app, options, chosen);
  add_compensate(app, options, chosen);
}

}  // namespace camber::cli
