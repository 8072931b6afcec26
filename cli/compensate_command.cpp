#include "cli/compensate_command.h"

#include <chrono>

#include <fmt/format.h>

#include "api/commands/compensate.h"
#include "base/output_file.h"
#include "base/stage.h"
#include "cli/console.h"
#include "cli/progress.h"
#include "cli/rounds_progress.h"
#include "compensate/trial.h"
#include "report/report_data.h"
#include "report/summary.h"
#include "report/verdict_text.h"

namespace camber::cli {
namespace {

/// Reads both programs once more, for their stamps and their feed.
void write_report(const CompensateArguments& arguments, const machine::Job& job,
                  const compensate::CompensationResult& result, const Diagnostics& diagnostics) {
  Diagnostics ignored;  // said already
  const auto machined = [&](SourceText source) {
    return simulate::simulate_motion(std::move(source), job, {}, ignored);
  };
  const auto rows = [&](const simulate::SimulatedProgram& program) {
    return report::rows_of_program(program, job.machine);
  };
  const auto before = machined(SourceText::read(job.program));
  machine::Job emitted_job = job;
  if (job.operations.given() && !result.block_of_line.empty())
    emitted_job.operations = compensate::moved_ranges(result.operations, result.block_of_line);
  const auto after = simulate::simulate_motion(SourceText(job.program, result.text), emitted_job, {}, ignored);
  std::optional<nc::Interpretation> from;
  if (!result.repeated_text.empty()) from = machined(SourceText(job.program, result.repeated_text)).moves;
  report::write_html_report(arguments.report,
                            report::compensate_report(job, result, {before, rows(before), result.loads_before},
                                                      {after, rows(after), result.loads_after}, arguments.output,
                                                      diagnostics, from ? &*from : nullptr));
}

}  // namespace

api::CompensateRequest compensate_request(const CompensateArguments& arguments) {
  return {.uncertainty = arguments.uncertainty,
          .measured = arguments.measured,
          .measured_program = arguments.measured_program,
          .check_voxels_mm = arguments.check_voxels_mm,
          .time_budget_percent = arguments.time_budget_percent,
          .keep_anyway = arguments.keep_anyway,
          .header = arguments.header,
          .header_hash = arguments.header_hash,
          .max_stock_crossings = arguments.report.empty() ? 0 : report::kMaxStockCrossings,
          .progress = {}};
}

int run_compensate(const CompensateArguments& arguments, const GlobalOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Diagnostics diagnostics;
  ProgressLine progress(options, "reading");
  const machine::Job given = machine::read_job(arguments.job, diagnostics);
  bool in_rounds = false;  // their share is that of the whole run
  const StageScope stages([&](const std::string& what, double share) {
    if (!in_rounds) progress.show(what, share);
  });
  RoundsProgress rounds(given.compensation.max_rounds,
                        static_cast<int>(2 * arguments.check_voxels_mm.size() + arguments.uncertainty.size()));
  api::CompensateRequest request = compensate_request(arguments);
  request.progress = [&](const std::string& what, double share) {
    in_rounds = true;
    const RoundsProgress::Whole whole = rounds.at(what, share);
    progress.show_whole(whole.what, whole.share);
  };
  api::CompensatedJob done;
  try {
    done = api::compensate_job(given, request, diagnostics);
  } catch (const BeyondModel& beyond) {
    progress.clear();
    settle(diagnostics, options);
    print_error(beyond.what());
    return kNumbersDidNotWorkOut;
  }
  const machine::Job& job = done.job;
  const compensate::CompensationResult& result = done.result;
  progress.clear();
  settle(diagnostics, options);
  print_translation(job.machine.translation, options);
  const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  for (const auto& name : result.unknown_parameters)
    if (!options.quiet)
      fmt::print(stderr, "camber: warning: --uncertainty: {} is not a parameter of the job; ignored [uncertainty]\n",
                 name);
  Diagnostics failed;
  const bool written = !arguments.dry_run && (result.better || arguments.keep_anyway);
  if (written) try_to_write([&] { api::write_compensated(arguments.output, job, result); }, failed);
  if (!arguments.json.empty())
    try_to_write([&] { write_file(arguments.json, report::compensate_json(result, job.compensation, compute_s)); },
                 failed);
  in_rounds = false;
  progress.show("writing the report");
  if (!arguments.report.empty()) try_to_write([&] { write_report(arguments, job, result, diagnostics); }, failed);
  progress.clear();

  if (!options.quiet) fmt::print("{}", report::compensate_text(result, compute_s));
  failed.throw_if_errors();
  const report::VerdictText verdict = report::verdict_text(result, job.compensation);
  if (!verdict.success) {
    print_error(verdict.headline);
    for (const std::string& reason : verdict.reasons) print_error(reason);
  }
  if (!written && !arguments.dry_run)
    print_error(
        fmt::format("{} was not written; --keep-anyway writes the round with the smallest error", arguments.output));
  return verdict.success ? kDone : kNumbersDidNotWorkOut;
}

}  // namespace camber::cli
