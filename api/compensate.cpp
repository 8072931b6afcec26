// The namespace compensate comes before the function of that name: clang takes it in no other order.
#include "api/commands/compensate.h"

#include "camber/compensate.h"

#include <chrono>
#include <filesystem>

#include "api/error_figures.h"
#include "api/job.h"
#include "api/run.h"
#include "machine/assumptions.h"
#include "machine/compensation_settings.h"
#include "report/feature_results.h"
#include "report/summary.h"
#include "report/verdict_text.h"

namespace camber {
namespace {

using compensate::CompensationResult;

std::vector<CompensatedPoint> points_of(const CompensationResult& c) {
  std::vector<CompensatedPoint> out;
  out.reserve(c.surface_before.size());
  for (std::size_t i = 0; i < c.surface_before.size(); ++i) {
    const removal::SurfacePoint& p = c.surface_before[i];
    const double after_mm = i < c.surface_after.size() ? c.surface_after[i].error_mm : p.error_mm;
    out.push_back({p.place_mm.x(), p.place_mm.y(), p.place_mm.z(), p.normal.x(), p.normal.y(), p.normal.z(),
                   1000 * p.error_mm, 1000 * after_mm, p.area_mm2});
  }
  return out;
}

/// All but diagnostics and json.
CompensateResult result_of(const CompensationResult& c, const machine::CompensationSettings& asked) {
  const report::VerdictText verdict = report::verdict_text(c, asked);
  CompensateResult out{.program = c.text,
                       .better = c.better,
                       .success = verdict.success,
                       .headline = verdict.headline,
                       .reasons = verdict.reasons,
                       .before_um = api::figures_of(c.before_um),
                       .after_um = api::figures_of(c.after_um),
                       .best_round = c.best,
                       .stop = compensate::to_string(c.stop),
                       .blocks_before = c.blocks_before,
                       .blocks_after = c.blocks_after,
                       .blocks_changed = c.blocks_changed,
                       .max_shift_mm = c.max_shift_mm,
                       .surface = points_of(c)};
  for (const auto& round : c.rounds)
    out.rounds.push_back(
        {api::figures_of(round.error_um), round.largest_shift_mm, round.machine_time_s, round.repeated});
  for (const auto& point : c.time_points) out.time_points.push_back({point.allowed_percent, point.round});
  for (const auto& run : c.repeated) out.repeated.push_back({run.first_line, run.last_line});
  out.pass_allowance_mm = c.pass_allowance_mm;
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

}  // namespace

CompensateResult v0::compensate(const Job& job, const CompensateOptions& options, const RunOptions& run_options) {
  const auto begin = std::chrono::steady_clock::now();
  CompensateResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found = job.impl().found;
    check_output(options.output, api::programmed(job));
    check_levers(options.levers, job.impl().job, found);
    const api::CompensateRequest request{.uncertainty = options.uncertainty,
                                         .measured = options.measured,
                                         .measured_program = options.measured_program,
                                         .check_voxels_mm = options.check_voxels_mm,
                                         .time_budget_percent = options.time_budget_percent,
                                         .keep_anyway = options.keep_anyway,
                                         .header = options.header,
                                         .header_hash = options.header_hash,
                                         .levers = options.levers,
                                         .progress = run.progress()};
    const api::CompensatedJob done = api::compensate_job(job.impl().job, request, found);
    for (const std::string& name : done.result.unknown_parameters)
      found.add({Severity::warning,
                 {job.path(), 0, 0},
                 "uncertainty: " + name + " is not a parameter of the job; ignored",
                 "uncertainty",
                 {}});
    run.settle(found);
    if (!options.output.empty() && (done.result.better || options.keep_anyway))
      api::write_compensated(options.output, done.job, done.result);
    const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    result = result_of(done.result, done.job.compensation);
    result.diagnostics = found.all();
    result.json = machine::with_assumptions(
        report::with_features(report::compensate_json(done.result, done.job.compensation, compute_s),
                              {{"features_before", report::features_of(done.job, done.result.surface_before)},
                               {"features_after", report::features_of(done.job, done.result.surface_after)}}),
        machine::assumptions(done.job));
  });
  return result;
}

}  // namespace camber
