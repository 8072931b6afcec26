#include "camber/sections.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "api/commands/sections.h"
#include "api/predict_result.h"
#include "api/run.h"
#include "machine/assumptions.h"
#include "report/feature_results.h"
#include "report/summary.h"

namespace camber {
namespace {

void check_section(const SectionOptions& options) {
  if (options.section < 1 || options.section > options.sections)
    throw std::invalid_argument("section: 1 ... sections was expected");
  if (options.round < 1 || options.round > distribute::kMaxSectionRounds || (options.round > 1 && !options.solve))
    throw std::invalid_argument("round: 1 ... 12 was expected, 1 without solve");
}

api::StepProgress steps_of(api::Run& run) {
  return [&run](const std::string& what, std::optional<double> share) { run.show(what, share.value_or(0)); };
}

}  // namespace

SectionResult v0::predict_section(const std::string& job_path, const std::string& folder, const SectionOptions& options,
                                  const RunOptions& run_options) {
  check_section(options);
  SectionResult out;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found, of_run;
    const machine::Job job = machine::read_job(job_path, found);
    run.settle(found);
    const distribute::PartKey key = distribute::part_key(job, options.sections, options.forces_at);
    distribute::PartFiles store(folder, key);
    distribute::SectionRun section(job, key, store, steps_of(run), of_run);
    const distribute::PartName name{options.solve ? distribute::PartStage::solve : distribute::PartStage::sweep,
                                    options.round, options.section - 1, options.sections};
    if (options.round == 1 || section.is_static()) {
      out.computed = options.solve ? section.solve(name.section, name.round) : section.sweep(name.section);
      out.part = store.path(name);
      out.solved_again = static_cast<std::int64_t>(section.solved_again_in(name));
    }
    run.settle(of_run);
    out.stamps = static_cast<std::int64_t>(section.work().stamps);
    out.voxels = static_cast<std::int64_t>(section.work().voxels);
    found.append(of_run);
    out.diagnostics = found.all();
  });
  return out;
}

PredictResult v0::merge(const std::string& folder, const RunOptions& run_options) {
  const auto begin = std::chrono::steady_clock::now();
  PredictResult out;
  api::Run run(run_options);
  run.execute([&] {
    const distribute::PartKey of_parts = distribute::find_parts(folder);
    Diagnostics of_job, found, of_cut, failed;
    const machine::Job job = machine::read_job(of_parts.job_path, of_job);
    run.settle(of_job);
    const distribute::PartKey key = distribute::part_key(job, of_parts.sections, of_parts.forces_at);
    distribute::PartFiles store(folder, key);
    const int round = std::max(1, distribute::last_round(folder, key));
    const api::PredictRequest request{.folder = folder, .forces_at = key.forces_at, .progress = steps_of(run)};
    api::MergedJob merged = api::merge_parts(job, key, round, store, request, found, of_cut);
    run.settle(found);
    run.settle(of_cut);
    found.append(of_cut);
    out = api::result_of(job, merged.prepared, merged.prediction);
    if (!merged.doubt.empty()) out.doubts.push_back(merged.doubt);
    const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    out.json = machine::with_assumptions(
        report::with_features(api::with_sections(report::predict_json(merged.prepared.setup.program, merged.prediction,
                                                                      compute_s, nullptr, out.doubts),
                                                 merged.figures),
                              {{"features", report::features_of(job, merged.prediction.surface)}}),
        machine::assumptions(job));
    of_job.append(found);
    out.diagnostics = of_job.all();
    api::write_prediction(job, merged.prepared, merged.prediction, request, out.json, found, failed);
    failed.throw_if_errors();
  });
  return out;
}

}  // namespace camber
