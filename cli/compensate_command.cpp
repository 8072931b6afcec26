#include "cli/compensate_command.h"

#include <chrono>

#include <fmt/format.h>

#include "base/output_file.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "compensate/header.h"
#include "compensate/measured.h"
#include "compensate/recheck.h"
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
void write_report(const CompensateArguments& arguments, const machine::Job& job,
                  const compensate::CompensationResult& result, const Diagnostics& diagnostics) {
  Diagnostics ignored;  // said already
  const auto machined = [&](SourceText source) {
    return simulate::simulate_motion(std::move(source), job, {}, ignored);
  };
  const auto rows = [&](const simulate::SimulatedProgram& program) {
    report::PathCollector collector(program.moves);
    feedmodel::predict_feed(program.moves, job.machine,
                            [&](std::span<const feedmodel::TimedSample> s) { collector.add(s); });
    return collector.take();
  };
  const auto before = machined(SourceText::read(job.program));
  const auto after = machined(SourceText(job.program, result.text));
  report::write_html_report(
      arguments.report,
      report::compensate_report(job, result, {before, rows(before), result.loads_before},
                                {after, rows(after), result.loads_after}, arguments.output, diagnostics));
}

/// The job as it was measured; the fit goes to `fit`.
machine::Job as_measured(const machine::Job& job, const CompensateArguments& arguments, Diagnostics& diagnostics,
                         const simulate::Progress& progress, std::optional<compensate::MeasuredFit>& fit) {
  if (arguments.measured.empty()) return job;
  const auto points = compensate::read_measured(arguments.measured);
  fit = compensate::fit_measured(job, arguments.measured, points, arguments.measured_program, diagnostics, progress);
  return compensate::softened(job, fit->scale);
}

std::string header_of(const machine::Job& job, const compensate::CompensationResult& c, bool hash) {
  const std::string lines = compensate::header_lines(job, c, CAMBER_VERSION);
  return hash ? lines + "\nINPUTS " + compensate::hash_of_inputs(job) : lines;
}

}  // namespace

int run_compensate(const CompensateArguments& arguments, const GlobalOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Diagnostics diagnostics;
  ProgressLine progress(options, "reading");
  const machine::Job told = machine::read_job(arguments.job, diagnostics);
  compensate::CompensateOptions compensate_options;
  compensate_options.progress = [&](const std::string& what, double share) { progress.show(what, share); };
  for (const auto& u : arguments.uncertainty)
    for (auto& group : compensate::read_uncertainty(u)) compensate_options.uncertainty.push_back(std::move(group));
  if (!arguments.report.empty()) compensate_options.max_stock_crossings = report::kMaxStockCrossings;
  compensate_options.recheck_voxels_mm = arguments.check_voxels_mm;
  std::optional<compensate::MeasuredFit> fit;
  const machine::Job job = as_measured(told, arguments, diagnostics, compensate_options.progress, fit);
  if (arguments.header || arguments.header_hash)
    compensate_options.header = [&](const auto& c) { return header_of(job, c, arguments.header_hash); };
  compensate::CompensationResult result;
  try {
    result = compensate::compensate(job, diagnostics, compensate_options);
  } catch (const compensate::BeyondModel& beyond) {
    progress.clear();
    settle(diagnostics, options);
    print_error(beyond.what());
    return kNumbersDidNotWorkOut;
  }
  result.measured = fit;
  progress.clear();
  feedmodel::check_range(moves_of(SourceText::read(job.program), job), job.program, job.machine, diagnostics);
  settle(diagnostics, options);
  print_translation(job.machine.translation, options);
  const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  for (const auto& name : result.unknown_parameters)
    if (!options.quiet)
      fmt::print(stderr, "camber: warning: --uncertainty: {} is no parameter of the job; left out [uncertainty]\n",
                 name);
  Diagnostics failed;
  if (!arguments.dry_run) try_to_write([&] { write_file(arguments.output, result.text); }, failed);
  if (!arguments.json.empty())
    try_to_write([&] { write_file(arguments.json, report::compensate_json(result, compute_s)); }, failed);
  progress.show("writing the report");
  if (!arguments.report.empty()) try_to_write([&] { write_report(arguments, job, result, diagnostics); }, failed);
  progress.clear();

  if (!options.quiet) fmt::print("{}", report::compensate_text(result, compute_s));
  failed.throw_if_errors();
  for (const std::string& doubt : result.doubts) print_error(doubt);
  if (!result.doubts.empty()) return kNumbersDidNotWorkOut;
  if (const std::string unsettled = report::unsettled_sentence(result); !unsettled.empty()) {
    print_error(unsettled);
    return kNumbersDidNotWorkOut;
  }
  if (!result.within_part) {
    print_error(
        fmt::format("more than a thousandth of the surface lies {:.2f} um or more in the part, deepest ({:.2f} um) at "
                    "X{:.3f} Y{:.3f} Z{:.3f}; no more than {:g} um ({}) were expected",
                    result.depth_after.held_um, result.depth_after.deepest_um, result.depth_after.place_mm.x(),
                    result.depth_after.place_mm.y(), result.depth_after.place_mm.z(), job.compensation.overcut_um(),
                    job.compensation.max_overcut_um > 0 ? "max_overcut_um" : "tolerance_um"));
    return kNumbersDidNotWorkOut;
  }
  if (result.stop == compensate::Stop::tolerance) return kDone;
  print_error(report::left_over_sentence(result.split_after, job.compensation));
  return kNumbersDidNotWorkOut;
}

}  // namespace camber::cli
