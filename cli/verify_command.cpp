#include "cli/verify_command.h"

#include <chrono>
#include <filesystem>

#include <fmt/format.h>

#include "base/output_file.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "compensate/verify.h"
#include "machine/job.h"
#include "report/summary.h"
#include "report/verdict_text.h"

namespace camber::cli {

namespace fs = std::filesystem;

int run_verify(const VerifyArguments& arguments, const GlobalOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  const std::string record_file = compensate::find_record(arguments.place);
  const compensate::Record record = compensate::read_record(record_file);
  compensate::check_record(record, record_file);
  const fs::path program = fs::path(record_file).parent_path() / record.program;
  const std::string job_file = fs::path(program).replace_extension(".verify.toml").string();
  check_outputs({job_file, arguments.json}, {program.string(), record_file});
  write_file(job_file, record.job);

  Diagnostics diagnostics;
  ProgressLine progress(options, "reading");
  const machine::Job job = machine::read_job(job_file, diagnostics);
  compensate::Verification result;
  try {
    result = compensate::verify(job, record, diagnostics,
                                [&](const std::string& what, double fraction) { progress.show(what, fraction); });
  } catch (const compensate::BeyondModel& beyond) {
    progress.clear();
    settle(diagnostics, options);
    print_error(beyond.what());
    return kNumbersDidNotWorkOut;
  }
  progress.clear();
  settle(diagnostics, options);
  const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  Diagnostics failed;
  if (!arguments.json.empty())
    try_to_write([&] { write_file(arguments.json, report::verify_json(result, job.compensation, compute_s)); }, failed);
  const report::VerdictText verdict = report::verdict_text(result, job.compensation);
  if (!options.quiet) {
    fmt::print("{}\n{}", program.string(), report::verify_text(result, compute_s));
    if (verdict.success) fmt::print("{}\n", verdict.headline);
    fmt::print("the same, with forces and pictures: camber predict {} -o DIR\n", job_file);
  }
  failed.throw_if_errors();
  if (verdict.success) return kDone;
  print_error(verdict.headline);
  for (const std::string& reason : verdict.reasons) print_error(reason);
  return kNumbersDidNotWorkOut;
}

}  // namespace camber::cli
