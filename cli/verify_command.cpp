#include "cli/verify_command.h"

#include <chrono>

#include <fmt/format.h>

#include "api/commands/verify.h"
#include "base/output_file.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "machine/assumptions.h"
#include "report/summary.h"
#include "report/verdict_text.h"

namespace camber::cli {

int run_verify(const VerifyArguments& arguments, const GlobalOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  const api::EmittedProgram emitted = api::find_emitted(arguments.place);
  check_outputs({emitted.job_file, arguments.json}, {emitted.program, emitted.record_file});

  Diagnostics diagnostics;
  ProgressLine progress(options, "reading");
  api::VerifiedProgram verified;
  try {
    verified = api::verify_emitted(emitted, diagnostics,
                                   [&](const std::string& what, double fraction) { progress.show(what, fraction); });
  } catch (const compensate::BeyondModel& beyond) {
    progress.clear();
    settle(diagnostics, options);
    print_error(beyond.what());
    return kNumbersDidNotWorkOut;
  }
  const auto& [job, result] = verified;
  progress.clear();
  settle(diagnostics, options);
  const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const std::vector<std::string> assumed = machine::assumptions(job);
  Diagnostics failed;
  if (!arguments.json.empty())
    try_to_write(
        [&] {
          write_file(arguments.json,
                     machine::with_assumptions(report::verify_json(result, job.compensation, compute_s), assumed));
        },
        failed);
  const report::VerdictText verdict = report::verdict_text(result, job.compensation);
  if (!options.quiet) {
    fmt::print("{}{}\n{}", machine::assumptions_text(assumed), emitted.program, report::verify_text(result, compute_s));
    if (verdict.success) fmt::print("{}\n", verdict.headline);
    fmt::print("the same, with forces and pictures: camber predict {} -o DIR\n", emitted.job_file);
  }
  failed.throw_if_errors();
  if (verdict.success) return kDone;
  print_error(verdict.headline);
  for (const std::string& reason : verdict.reasons) print_error(reason);
  return kNumbersDidNotWorkOut;
}

}  // namespace camber::cli
