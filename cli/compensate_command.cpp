#include "cli/compensate_command.h"

#include <chrono>

#include <fmt/format.h>

#include "base/output_file.h"
#include "cli/console.h"
#include "cli/progress.h"
#include "feedmodel/control_options.h"
#include "feedmodel/fitted_range.h"
#include "nc/interpreter.h"
#include "report/report_data.h"
#include "report/summary.h"

namespace camber::cli {
namespace {

nc::Interpretation moves_of(SourceText source, const machine::Job& job) {
  Diagnostics ignored;  // said already
  const auto text = nc::read_program(std::move(source), ignored);
  return nc::interpret(text, feedmodel::interpreter_options(job.machine, job.inch), ignored);
}

/// Reads both programs once more, for their stamps and their feed.
void write_report(const CompensateArguments& arguments, const machine::Job& job, const compensate::Compensation& result,
                  const Diagnostics& diagnostics) {
  Diagnostics ignored;  // said already
  const auto machined = [&](SourceText source) {
    return deflection::machine_program(std::move(source), job, {}, ignored);
  };
  const auto rows = [&](const deflection::MachinedProgram& program) {
    report::PathCollector collector(program.moves);
    feedmodel::predict_feed(program.moves, job.machine,
                            [&](std::span<const feedmodel::TimedSample> s) { collector.add(s); });
    return collector.take();
  };
  const auto before = machined(SourceText::read(job.program));
  const auto after = machined(SourceText(job.program, result.text));
  report::write_html_report(arguments.report,
                            report::compensate_report(job, result, {before, rows(before)}, {after, rows(after)},
                                                      arguments.output, diagnostics));
}

}  // namespace

int run_compensate(const CompensateArguments& arguments, const GlobalOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Diagnostics diagnostics;
  const machine::Job job = machine::read_job(arguments.job, diagnostics);
  ProgressLine progress(options);
  compensate::CompensateOptions compensate_options;
  compensate_options.progress = [&](const std::string& what, double share) { progress.show(what, share); };
  const compensate::Compensation result = compensate::compensate(job, diagnostics, compensate_options);
  progress.clear();
  feedmodel::check_range(moves_of(SourceText::read(job.program), job), job.program, job.machine, diagnostics);
  settle(diagnostics, options);
  print_translation(job.machine.translation, options);
  const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  write_file(arguments.output, result.text);
  if (!arguments.json.empty()) write_file(arguments.json, report::compensate_json(result, compute_s));
  if (!arguments.report.empty()) write_report(arguments, job, result, diagnostics);

  if (!options.quiet) fmt::print("{}", report::compensate_text(result, compute_s));
  if (const std::string unsettled = report::unsettled_sentence(result); !unsettled.empty()) {
    print_error(unsettled);
    return kNumbersDidNotWorkOut;
  }
  if (result.stop == compensate::Stop::tolerance) return kDone;
  print_error(fmt::format("the residual of {:.2f} um (95th percentile) is over tolerance_um = {:g}",
                          result.after_um.p95, job.compensation.tolerance_um));
  return kNumbersDidNotWorkOut;
}

}  // namespace camber::cli
