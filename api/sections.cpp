#include "camber/sections.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "api/merged_sections.h"

namespace camber {
namespace {

void check_section(const SectionOptions& options) {
  if (options.section < 1 || options.section > options.sections)
    throw std::invalid_argument("section: 1 ... sections was expected");
  if (options.round < 1 || options.round > distribute::kMaxSectionRounds || (options.round > 1 && !options.solve))
    throw std::invalid_argument("round: 1 ... 12 was expected, 1 without solve");
}

/// The warnings of the job's files come first.
PredictResult with_first(const Diagnostics& of_job, PredictResult result) {
  result.diagnostics.insert(result.diagnostics.begin(), of_job.all().begin(), of_job.all().end());
  return result;
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
    run.settle_first(found);
    const distribute::PartKey key = distribute::part_key(job, options.sections, options.forces_at);
    distribute::PartFiles store(folder, key);
    distribute::SectionRun section(job, key, store, run.steps(), of_run);
    const distribute::PartName name{options.solve ? distribute::PartStage::solve : distribute::PartStage::sweep,
                                    options.round, options.section - 1, options.sections};
    out.has_round = options.round == 1 || section.is_static();
    if (out.has_round) {
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

PredictResult v0::predict_in_sections(const std::string& job_path, std::size_t sections, const PredictOptions& options,
                                      const RunOptions& run_options) {
  check_section({.sections = sections});
  PredictResult out;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found, of_run;
    const machine::Job job = machine::read_job(job_path, found);
    run.settle_first(found);
    const distribute::PartKey key = distribute::part_key(job, sections, options.forces_at);
    distribute::PartFiles store(options.output_folder, key);
    distribute::SectionRun all(job, key, store, run.steps(), of_run);
    for (std::size_t s = 0; s < sections; ++s) all.sweep(s);
    int round = 1;
    for (;;) {
      for (std::size_t s = 0; s < sections; ++s) all.solve(s, round);
      if (!all.is_static() || round == distribute::kMaxSectionRounds || (round > 1 && all.solved_again(round) == 0))
        break;
      ++round;
    }
    out = with_first(found, api::merge_parts(job, key, round, store, options, all.take_programs(), run));
  });
  return out;
}

PredictResult v0::merge(const std::string& folder, const MergeOptions& options, const RunOptions& run_options) {
  PredictResult out;
  api::Run run(run_options);
  run.execute([&] {
    const distribute::PartKey of_parts = distribute::find_parts(folder);
    Diagnostics found;
    const machine::Job job = machine::read_job(of_parts.job_path, found);
    run.settle_first(found);
    const distribute::PartKey key = distribute::part_key(job, of_parts.sections, of_parts.forces_at);
    distribute::PartFiles store(folder, key);
    const int round = std::max(1, distribute::last_round(folder, key));
    const PredictOptions how{
        .output_folder = folder, .rows = options.rows, .throw_if_unwritten = options.throw_if_unwritten};
    out = with_first(found, api::merge_parts(job, key, round, store, how, nullptr, run));
  });
  return out;
}

PredictResult v0::merge(const std::string& folder, const RunOptions& run) { return merge(folder, MergeOptions(), run); }

}  // namespace camber
