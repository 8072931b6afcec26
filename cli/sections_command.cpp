#include "cli/sections_command.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "api/commands/sections.h"
#include "base/output_file.h"
#include "cli/console.h"
#include "cli/progress.h"
#include "machine/assumptions.h"
#include "report/feature_results.h"
#include "report/summary.h"

namespace camber::cli {

api::StepProgress section_steps(ProgressLine& progress) {
  return [&progress](const std::string& what, std::optional<double> fraction) {
    fraction ? progress.show(what, *fraction) : progress.show(what);
  };
}

int merge_and_write(const machine::Job& job, const distribute::PartKey& key, int round, distribute::PartStore& store,
                    const MergeArguments& arguments, const GlobalOptions& options,
                    std::chrono::steady_clock::time_point begin) {
  Diagnostics found, of_cut;
  ProgressLine progress(options, "merging");
  const api::PredictRequest request{.folder = arguments.folder,
                                    .forces_at = key.forces_at,
                                    .progress = section_steps(progress),
                                    .programs = arguments.programs};
  api::MergedJob merged = api::merge_parts(job, key, round, store, request, found, of_cut);
  progress.clear();
  settle(found, options);
  found.append(of_cut);
  const simulate::SimulatedProgram& program = merged.prepared.setup.program;
  const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::vector<std::string> wrong = api::doubts_of(job, program, merged.prediction);
  if (!merged.doubt.empty()) wrong.push_back(merged.doubt);
  const std::vector<std::string> assumed = machine::assumptions(job);
  const auto features = report::features_of(job, merged.prediction.surface);
  const std::string json = machine::with_assumptions(
      report::with_features(
          api::with_sections(report::predict_json(program, merged.prediction, compute_s, nullptr, wrong),
                             merged.figures),
          {{"features", features}}),
      assumed);
  Diagnostics failed;
  api::write_prediction(job, merged.prepared, merged.prediction, request, json, found, failed);
  if (!arguments.json.empty()) try_to_write([&] { write_file(arguments.json, json); }, failed);
  progress.clear();
  if (!options.quiet)
    fmt::print("{}{}{}", machine::assumptions_text(assumed),
               report::predict_text(program, merged.prediction, compute_s), report::features_text(features));
  failed.throw_if_errors();
  settle(of_cut, options);
  for (const std::string& sentence : wrong) print_error(sentence);
  return wrong.empty() ? kDone : kNumbersDidNotWorkOut;
}

namespace {

/// One part.
int run_part(distribute::SectionRun& run, const SectionsArguments& arguments, const GlobalOptions& options,
             const std::string& path) {
  if (arguments.round > 1 && !run.is_static()) {
    if (!options.quiet) fmt::print("rigid coupling has one round\n");
    return kDone;
  }
  const bool computed =
      arguments.solve ? run.solve(arguments.section - 1, arguments.round) : run.sweep(arguments.section - 1);
  if (!options.quiet) {
    if (computed)
      fmt::print("{}: {} stamps, {} voxels\n", path, run.work().stamps, run.work().voxels);
    else
      fmt::print("{}: is there already\n", path);
  }
  return kDone;
}

}  // namespace

int run_sections(const SectionsArguments& arguments, const GlobalOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Diagnostics diagnostics;
  ProgressLine progress(options, "reading");
  const machine::Job job = machine::read_job(arguments.job, diagnostics);
  settle(diagnostics, options);
  Diagnostics of_run;
  const distribute::PartKey key = distribute::part_key(job, arguments.sections, arguments.forces_at);
  distribute::PartFiles store(arguments.output_folder, key);
  distribute::SectionRun run(job, key, store, section_steps(progress), of_run);
  if (arguments.section > 0) {
    const distribute::PartName name{arguments.solve ? distribute::PartStage::solve : distribute::PartStage::sweep,
                                    arguments.round, arguments.section - 1, arguments.sections};
    const int status = run_part(run, arguments, options, store.path(name));
    progress.clear();
    settle(of_run, options);
    return status;
  }
  for (std::size_t s = 0; s < arguments.sections; ++s) run.sweep(s);
  int round = 1;
  for (bool again = true; again; ++round) {
    for (std::size_t s = 0; s < arguments.sections; ++s) run.solve(s, round);
    again = run.is_static() && round < distribute::kMaxSectionRounds && (round == 1 || run.solved_again(round) > 0);
    if (!again) break;
  }
  progress.clear();
  return merge_and_write(job, key, round, store, {arguments.output_folder, arguments.json, run.take_programs()},
                         options, begin);
}

int run_merge(const MergeArguments& arguments, const GlobalOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  const distribute::PartKey found = distribute::find_parts(arguments.folder);
  Diagnostics diagnostics;
  const machine::Job job = machine::read_job(found.job_path, diagnostics);
  settle(diagnostics, options);
  const distribute::PartKey key = distribute::part_key(job, found.sections, found.forces_at);
  distribute::PartFiles store(arguments.folder, key);
  return merge_and_write(job, key, std::max(1, distribute::last_round(arguments.folder, key)), store, arguments,
                         options, begin);
}

}  // namespace camber::cli
