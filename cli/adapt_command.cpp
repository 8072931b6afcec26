// camber adapt J.toml -o OUT.nc [--report R.html] [--json R.json]
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "cli/console.h"
#include "cli/job_commands.h"
#include "cli/outputs.h"
#include "cli/progress.h"

namespace camber::cli {

int run_adapt(const AdaptArguments& arguments, const GlobalOptions& options) {
  ProgressLine progress(options, "reading");
  const Job job = read_job(arguments.job);
  AdaptOptions asked = arguments.options;
  asked.page = !arguments.report.empty();
  asked.output = arguments.output;
  const AdaptResult result = v0::adapt(job, asked, run_options(progress, options));
  print_translation(job.machine().translation(), options);
  const bool written = result.success || arguments.keep_anyway;
  Diagnostics failed;
  if (written) try_to_write([&] { write_file(arguments.output, result.program); }, failed);
  if (!arguments.json.empty()) try_to_write([&] { write_file(arguments.json, result.json); }, failed);
  if (!arguments.report.empty()) try_to_write([&] { write_file(arguments.report, result.page); }, failed);
  if (!options.quiet) fmt::print("{}", result.printed);
  failed.throw_if_errors();
  for (const std::string& reason : result.reasons) print_error(reason);
  if (!written) print_error(fmt::format("{} was not written; --keep-anyway writes it all the same", arguments.output));
  return result.success ? kDone : kNumbersDidNotWorkOut;
}

void add_adapt_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("adapt", "change the feeds of a job's program by the loads of its cut");
  auto arguments = std::make_shared<AdaptArguments>();
  command->add_option("job", arguments->job, "job.toml with [adapt]")->required()->type_name("J.toml");
  command->add_option("-o,--output", arguments->output, "the new program")->required()->type_name("OUT.nc");
  command
      ->add_option("--time-limit", arguments->options.time_limit_s,
                   "scale all limits by the least factor with which the program takes no longer than this, s")
      ->check(CLI::PositiveNumber)
      ->type_name("SECONDS");
  command->add_flag("--sweep", arguments->options.sweep, "also the time for limits from half to twice the given ones");
  command->add_flag("--keep-anyway", arguments->keep_anyway, "write the program even if a limit is not kept");
  command->add_option("--report", arguments->report, "report page with loads and feeds along the path")
      ->type_name("R.html");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_job(arguments->job, options);
      check_outputs({arguments->output, arguments->report, arguments->json}, files_read(arguments->job));
      return run_adapt(*arguments, options);
    };
  });
}

}  // namespace camber::cli
