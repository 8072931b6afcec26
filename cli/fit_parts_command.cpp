// camber fit-parts: a machine, tools and a material from measured parts.
#include "camber/fit_parts.h"

#include <filesystem>
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

struct FitPartsArguments {
  std::vector<std::string> jobs;
  std::string folder;  ///< machine.toml, tools.toml, material.toml, report.html
  std::string json;    ///< empty: none
  FitPartsOptions options{};
};

constexpr const char* kFiles[] = {"machine.toml", "tools.toml", "material.toml", "report.html"};

/// Refuses a folder whose new files would replace files that the jobs read.
void check_files(const std::vector<Job>& jobs, const std::string& folder) {
  std::error_code ec;
  for (const Job& job : jobs)
    for (const std::string& input : {job.path(), job.machine().path(), job.program_path()})
      for (const char* name : kFiles) {
        const std::filesystem::path output = std::filesystem::path(folder) / name;
        if (std::filesystem::equivalent(output, input, ec))
          fail_on_file(output.string(), "is an input of a job; another folder was expected", "output-is-input");
      }
}

/// Throws InputError. Returns kDone or kNumbersDidNotWorkOut.
int run_fit_parts(const FitPartsArguments& arguments, const GlobalOptions& options) {
  std::vector<Job> jobs;
  for (const std::string& path : arguments.jobs) jobs.push_back(read_job(path));
  check_files(jobs, arguments.folder);
  ProgressLine progress(options, "predicting");
  const FitPartsResult result = fit_parts(jobs, arguments.options, run_options(progress, options));
  if (!options.quiet) fmt::print("{}", result.printed);
  make_folder(arguments.folder);
  for (const auto& [name, text] : result.files) write_file(std::filesystem::path(arguments.folder) / name, text);
  if (!arguments.json.empty()) write_file(arguments.json, result.json);
  if (!result.converged) print_error(result.message);
  return result.converged ? kDone : kNumbersDidNotWorkOut;
}

}  // namespace

void add_fit_parts_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
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
      ->add_option("--hold-out", arguments->options.hold_out,
                   "job (its file without ending) or part that is judged, not fitted")
      ->expected(1)
      ->take_all()
      ->type_name("NAME");
  command->add_flag("--suggest", arguments->options.suggest, "say what experiment would tell what is not determined");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      check_output_folder(arguments->folder);
      check_outputs({arguments->json}, arguments->jobs);
      return run_fit_parts(*arguments, options);
    };
  });
}

}  // namespace camber::cli
