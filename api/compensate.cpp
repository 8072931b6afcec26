// Names of the namespace compensate come before the function of that name: clang takes them in no other order.
#include "base/output_file.h"
#include "base/stage.h"
#include "compensate/compensate_path.h"
#include "compensate/header.h"
#include "compensate/measured.h"
#include "compensate/recheck.h"
#include "compensate/trial.h"
#include "compensate/verify_program.h"
#include "feedmodel/fitted_range.h"
#include "machine/assumptions.h"
#include "machine/compensation_settings.h"
#include "report/feature_results.h"
#include "report/figures_json.h"
#include "report/report_data.h"
#include "report/verdict_text.h"

#include "camber/compensate.h"

#include <filesystem>
#include <optional>
#include <utility>

#include "api/compensation.h"
#include "api/job.h"
#include "api/prediction.h"

namespace camber {
namespace {

namespace fs = std::filesystem;
using compensate::CompensationResult;

struct MeasuredSurface {
  std::vector<compensate::MeasuredPoint> points{};
  std::optional<compensate::MeasuredFit> fit{};
};

/// The job as it was measured.
machine::Job as_measured(const machine::Job& job, const CompensateOptions& request, Diagnostics& diagnostics,
                         const simulate::Progress& progress, const simulate::Predictor& predictor,
                         MeasuredSurface& measured) {
  if (request.measured.empty()) return job;
  auto& [points, fit] = measured;
  points = compensate::read_measured(request.measured);
  fit = compensate::fit_measured(job, request.measured, points, request.measured_program, diagnostics, progress,
                                 predictor);
  return compensate::softened(job, fit->scale);
}

std::string header_of(const machine::Job& job, const compensate::CompensationResult& c, bool hash) {
  const std::string lines = compensate::header_lines(job, c, CAMBER_VERSION);
  return hash ? lines + "\nINPUTS " + compensate::hash_of_inputs(job) : lines;
}

/// The job with the levers of the request. Throws InputError.
machine::Job with_levers(const machine::Job& job, const std::vector<std::string>& names, Diagnostics& diagnostics) {
  machine::Job out = job;
  if (names.empty()) return out;
  const machine::LeverNames read = machine::levers_of(names);
  for (const std::string& message : read.errors)
    diagnostics.add({Severity::error, {job.path, 0, 0}, "--levers: " + message, "value-choice", {}});
  diagnostics.throw_if_errors();
  out.compensation.levers = read.levers;
  // The job's budget is for the job's levers.
  if (!out.compensation.has(machine::Lever::feed) && !out.compensation.has(machine::Lever::passes))
    out.compensation.time_budget_percent.reset();
  return out;
}

compensate::CompensateOptions loop_options(const CompensateOptions& request, simulate::Progress progress,
                                           const simulate::Predictor& predictor) {
  compensate::CompensateOptions options;
  options.predictor = predictor;
  options.progress = std::move(progress);
  if (request.outlook)
    options.outlook = [&](const compensate::Outlook& outlook) { request.outlook(report::outlook_sentence(outlook)); };
  for (const auto& u : request.uncertainty)
    for (auto& group : compensate::read_uncertainty(u)) options.uncertainty.push_back(std::move(group));
  options.max_stock_crossings = request.page ? report::kMaxStockCrossings : 0;
  options.time_budget_percent = request.time_budget_percent;
  options.keep_anyway = request.keep_anyway;
  options.recheck_voxels_mm = request.check_voxels_mm;
  return options;
}

struct CompensatedJob {
  machine::Job job;  ///< what was compensated: the given one, or as it was measured
  CompensationResult result;
  std::vector<compensate::MeasuredPoint> measured{};
};

/// Throws InputError and BeyondModel. Writes nothing.
CompensatedJob compensate_job(const machine::Job& given, const CompensateOptions& request,
                              const simulate::Progress& progress, const simulate::Predictor& predictor,
                              Diagnostics& diagnostics) {
  compensate::CompensateOptions options = loop_options(request, progress, predictor);
  MeasuredSurface measured;
  CompensatedJob out{as_measured(with_levers(given, request.levers, diagnostics), request, diagnostics,
                                 options.progress, predictor, measured),
                     {}};
  const machine::Job& job = out.job;
  if (request.header || request.header_hash)
    options.header = [&](const auto& c) { return header_of(job, c, request.header_hash); };
  out.result = compensate::compensate(job, diagnostics, options);
  out.result.uncertainty.measured = measured.fit;
  out.measured = std::move(measured.points);
  feedmodel::check_range(out.result.given.commanded(), job.program, job.machine, diagnostics);
  return out;
}

std::vector<CompensatedPoint> points_of(const CompensationResult& c) {
  std::vector<CompensatedPoint> out;
  out.reserve(c.surfaces.before.size());
  for (std::size_t i = 0; i < c.surfaces.before.size(); ++i) {
    const removal::SurfacePoint& p = c.surfaces.before[i];
    const double after_mm = i < c.surfaces.after.size() ? c.surfaces.after[i].error_mm : p.error_mm;
    out.push_back({p.place_mm.x(), p.place_mm.y(), p.place_mm.z(), p.normal.x(), p.normal.y(), p.normal.z(),
                   1000 * p.error_mm, 1000 * after_mm, p.area_mm2});
  }
  return out;
}

/// Returns the result without diagnostics and json.
CompensateResult result_of(const CompensationResult& c, const machine::CompensationSettings& asked) {
  const report::VerdictText verdict = report::verdict_text(c, asked);
  CompensateResult out{.program = c.emitted.text,
                       .better = c.verdict.better,
                       .success = verdict.success,
                       .headline = verdict.headline,
                       .reasons = verdict.reasons,
                       .before_um = api::figures_of(c.figures.before_um),
                       .after_um = api::figures_of(c.figures.after_um),
                       .best_round = c.best,
                       .stop = compensate::to_string(c.verdict.stop),
                       .blocks_before = c.emitted.blocks_before,
                       .blocks_after = c.emitted.blocks_after,
                       .blocks_changed = c.emitted.blocks_changed,
                       .max_shift_mm = c.path.max_shift_mm,
                       .surface = points_of(c)};
  for (const auto& round : c.rounds)
    out.rounds.push_back(
        {api::figures_of(round.error_um), round.largest_shift_mm, round.machine_time_s, round.repeated});
  for (const auto& point : c.time_points) out.time_points.push_back({point.allowed_percent, point.round});
  for (const auto& run : c.passes.runs) out.repeated.push_back({run.first_line, run.last_line});
  out.pass_allowance_mm = c.passes.allowance_mm;
  if (c.pass_before) out.given_allowance_mm = c.pass_before->given_mm, out.allowance_mm = c.pass_before->left_mm;
  return out;
}

void check_levers(const std::vector<std::string>& names, const machine::Job& job, Diagnostics& diagnostics) {
  if (names.empty()) return;
  for (const std::string& message : machine::levers_of(names).errors)
    diagnostics.add({Severity::error, {job.path, 0, 0}, "compensate: " + message, "value-choice", {}});
  diagnostics.throw_if_errors();
}

/// An input is not written over.
void check_output(const std::string& output, const machine::Job& job) {
  std::error_code ec;
  for (const std::string& input : {job.program, job.path, job.machine_path})
    if (!output.empty() && std::filesystem::equivalent(output, input, ec))
      fail_on_file(output, "is an input of the job; another file was expected for the emitted program",
                   "output-is-input");
}

/// Reads both programs once more, for their stamps and their feed.
std::string page_of(const CompensatedJob& done, const std::string& output, const Diagnostics& diagnostics) {
  const auto& [job, result, measured] = done;
  Diagnostics ignored;  // said already
  const auto machined = [&](const SourceText& source) { return motion::simulate_motion(source, job, {}, ignored); };
  const auto rows = [&](const simulate::SimulatedProgram& program) {
    return report::rows_of_program(program, job.machine);
  };
  const auto before = machined(SourceText::read(job.program));
  machine::Job emitted_job = job;
  if (job.operations.given() && !result.emitted.block_of_line.empty())
    emitted_job.operations = compensate::moved_ranges(result.scope.operations, result.emitted.block_of_line);
  const auto after = motion::simulate_motion(SourceText(job.program, result.emitted.text), emitted_job, {}, ignored);
  std::optional<nc::Interpretation> from;
  if (!result.passes.text.empty()) from = machined(SourceText(job.program, result.passes.text)).moves_in_part();
  const auto& s = result.surfaces;
  report::ReportData data = report::compensate_report(
      job, result, {before, rows(before), s.loads_before, s.chatter_before},
      {after, rows(after), s.loads_after, s.chatter_after}, output, diagnostics, from ? &*from : nullptr);
  report::add_measured(data, measured);
  return report::html_report(data);
}

/// The emitted program, and beside it the record by which it can be judged again and what is measured of it; a pipe has
/// nothing beside it.
void write_files(const std::string& path, const CompensatedJob& done,
                 const std::vector<inspect::FeatureResult>& features, Diagnostics& failed) {
  std::error_code ec;
  const auto is_file = [&] { return fs::is_regular_file(path, ec); };
  try_to_write(
      [&] {
        write_file(path, done.result.emitted.text);
        if (is_file())
          write_file(compensate::record_path(path),
                     compensate::record_json(compensate::make_record(done.job, done.result, path)));
      },
      failed);
  if (!features.empty() && is_file())
    try_to_write(
        [&] { report::write_features_csv((fs::path(path).parent_path() / "features.csv").string(), features); },
        failed);
}

Diagnostic unknown_parameter(const std::string& name, const std::string& job_path) {
  return {Severity::warning,
          {job_path, 0, 0},
          "uncertainty: " + name + " is not a parameter of the job; ignored",
          "uncertainty",
          {}};
}

}  // namespace

CompensateResult api::compensate(const Job& given, const CompensateOptions& options, const RunOptions& run_options,
                                 const simulate::Predictor& predictor) {
  CompensateResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found = given.impl().found;
    if (!options.dry_run) check_output(options.output, api::programmed(given));
    check_levers(options.levers, given.impl().job, found);
    bool in_rounds = false;  // their fraction is that of the whole run
    const StageScope stages([&](const std::string& what, double fraction) {
      if (!in_rounds) run.show(what, fraction);
    });
    const auto progress = [&](const std::string& step, double fraction) {
      in_rounds = true;
      options.step ? options.step(step, fraction) : run.show(step, fraction);
    };
    CompensatedJob done;
    try {
      done = compensate_job(api::programmed(given), options, progress, predictor, found);
    } catch (const BeyondModel&) {
      run.settle_first(found);
      throw;
    }
    run.settle_first(found);
    const double compute_s = run.seconds();
    const CompensationResult& c = done.result;
    Diagnostics all = found, failed;
    for (const std::string& name : c.uncertainty.unknown_parameters) all.add(unknown_parameter(name, given.path()));
    run.settle(all);
    const auto features_before = report::features_of(done.job, c.surfaces.before),
               features_after = report::features_of(done.job, c.surfaces.after);
    const std::vector<std::string> assumed = machine::assumptions(given.impl().job);
    result = result_of(c, done.job.compensation);
    result.unknown_parameters = c.uncertainty.unknown_parameters;
    result.diagnostics = all.all();
    result.written = !options.output.empty() && !options.dry_run && (c.verdict.better || options.keep_anyway);
    if (result.written) write_files(options.output, done, features_after, failed);
    result.json = machine::with_assumptions(
        report::with_features(report::compensate_json(c, done.job.compensation, compute_s),
                              {{"features_before", features_before}, {"features_after", features_after}}),
        assumed);
    result.printed = machine::assumptions_text(assumed) + report::compensate_text(c, compute_s) +
                     report::features_text(features_before, features_after);
    in_rounds = false;
    if (options.page) {
      run.steps()("writing the report", std::nullopt);
      result.page = page_of(done, options.output, found);
    }
    if (options.throw_if_unwritten) failed.throw_if_errors();
    result.unwritten = failed.all();
  });
  return result;
}

CompensateResult v0::compensate(const Job& given, const CompensateOptions& options, const RunOptions& run_options) {
  return api::compensate(given, options, run_options, simulate::predict);
}

}  // namespace camber
