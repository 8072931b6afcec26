#include "cli/adapt_command.h"

#include <chrono>

#include <fmt/format.h>

#include "api/commands/adapt.h"
#include "base/output_file.h"
#include "base/stage.h"
#include "cli/console.h"
#include "cli/progress.h"
#include "machine/assumptions.h"
#include "report/adapt_summary.h"

namespace camber::cli {
namespace {

std::vector<std::string> warnings_of(const Diagnostics& diagnostics) {
  std::vector<std::string> out;
  for (const Diagnostic& d : diagnostics.all()) out.push_back(to_string(d));
  return out;
}

}  // namespace

int run_adapt(const AdaptArguments& arguments, const GlobalOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Diagnostics diagnostics;
  ProgressLine progress(options, "reading");
  const machine::Job job = machine::read_job(arguments.job, diagnostics);
  const auto show = [&](const std::string& what, double share) { progress.show(what, share); };
  const StageScope stages(show);
  const adapt::AdaptResult result = api::adapt_job(
      job, {.time_limit_s = arguments.time_limit_s, .sweep = arguments.sweep, .progress = show}, diagnostics);
  progress.clear();
  settle(diagnostics, options);
  print_translation(job.machine.translation, options);
  const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const std::vector<std::string> failures = report::adapt_failures(result);
  const bool written = failures.empty() || arguments.keep_anyway;
  const std::vector<std::string> assumed = machine::assumptions(job);
  Diagnostics failed;
  if (written) try_to_write([&] { write_file(arguments.output, result.text); }, failed);
  if (!arguments.json.empty())
    try_to_write(
        [&] {
          write_file(arguments.json,
                     machine::with_assumptions(report::adapt_json(result, *job.adapt, compute_s), assumed));
        },
        failed);
  if (!arguments.report.empty())
    try_to_write(
        [&] {
          write_file(arguments.report,
                     report::adapt_page(result, *job.adapt, {arguments.job, job.program, arguments.output},
                                        warnings_of(diagnostics)));
        },
        failed);
  if (!options.quiet) fmt::print("{}{}", machine::assumptions_text(assumed), report::adapt_text(result, compute_s));
  failed.throw_if_errors();
  for (const std::string& failure : failures) print_error(failure);
  if (!written) print_error(fmt::format("{} was not written; --keep-anyway writes it all the same", arguments.output));
  return failures.empty() ? kDone : kNumbersDidNotWorkOut;
}

}  // namespace camber::cli
