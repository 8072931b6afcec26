#include "camber/copy.h"

#include <algorithm>

#include <fmt/format.h>

#include "api/run.h"
#include "base/units.h"
#include "checks/collisions.h"
#include "checks/flute_reach.h"
#include "copymill/copy_milling.h"
#include "machine/assumptions.h"
#include "machine/copy_operations.h"
#include "machine/job_file.h"
#include "plausibility/plausibility.h"
#include "report/copy_summary.h"
#include "simulate/predict_path.h"

namespace camber {
namespace {

struct CopyJob {
  machine::Job job;
  std::vector<machine::CopyOperation> operations;
};

CopyJob read_copy_job(const std::string& path, Diagnostics& diagnostics) {
  CopyJob out{machine::read_unprogrammed_job(path, diagnostics), {}};
  out.operations = machine::read_copy_operations(path, out.job, diagnostics);
  plausibility::check_job_values(out.job, diagnostics);
  diagnostics.throw_if_errors();
  return out;
}

/// The emitted text is read again: rapids through material, shank and holder in stock, and material above the flutes
/// are diagnostics at its blocks.
void check_emitted(const CopyJob& job, const std::string& program, const copymill::CopyResult& made,
                   Diagnostics& diagnostics) {
  if (std::ranges::all_of(made.operations, &copymill::OperationSummary::nothing_left)) return;
  const simulate::SimulatedProgram emitted =
      motion::simulate_motion(SourceText(program, made.text), job.job, {}, diagnostics);
  checks::check_collisions(job.job, emitted, *made.blank, diagnostics);
  checks::check_flute_reach(job.job, emitted, *made.blank, diagnostics);
}

CopyTick tick_of(const copymill::Tick& t) {
  return {t.t_s, t.tip_mm.x(), t.tip_mm.y(), t.tip_mm.z(), mm_per_min_from_mm_per_s(t.feed_mm_per_s), t.load_N};
}

CopiedOperation copied_operation(const copymill::OperationSummary& o) {
  const copymill::LoadFigures& l = o.load;
  return {.tool = o.tool,
          .mode = std::string(machine::word_of(o.mode)),
          .time_s = o.time_s,
          .cutting_s = o.cutting_s,
          .removed_mm3 = o.removed_mm3,
          .levels = o.levels,
          .passes = o.passes,
          .ramps = o.ramps,
          .plunges = o.plunges,
          .retracts = o.retracts,
          .nothing_left = o.nothing_left,
          .target_N = l.target_N,
          .max_N = l.max_N,
          .within_share = l.counted > 0 ? static_cast<double>(l.within) / static_cast<double>(l.counted) : 0,
          .trochoid_circles = o.trochoid_circles};
}

CopyResult copy_result_of(const copymill::CopyResult& r) {
  CopyResult out{.program = r.text,
                 .time_s = r.time_s,
                 .removed_mm3 = r.removed_mm3,
                 .ticks = r.ticks,
                 .blocks = r.blocks,
                 .gouge_um = r.path_depth_um,
                 .left_p95_um = r.left.p95_um,
                 .left_max_um = r.left.max_um,
                 .unreached_mm2 = r.left.unreached_mm2,
                 .stopped = r.stopped,
                 .log = report::copy_log_csv(r)};
  for (const copymill::OperationSummary& o : r.operations) out.operations.push_back(copied_operation(o));
  return out;
}

}  // namespace

CopyResult v0::copy(const std::string& job_path, const CopyOptions& options, const RunOptions& run_options) {
  CopyResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found;
    const CopyJob job = read_copy_job(job_path, found);
    report::TickPicture picture;
    copymill::CopyOptions how;
    how.stop_after_s = options.stop_after_s;
    if (!options.hardness.empty()) how.regions = simulate::read_force_regions(options.hardness);
    if (options.stream || options.page)
      how.stream = [&](const copymill::Tick& t) {
        if (options.stream) options.stream(tick_of(t));
        if (options.page) picture.add(t);
      };
    const copymill::CopyResult done = copymill::copy(job.job, job.operations, how, found);
    check_emitted(job, options.output, done, found);
    run.settle_first(found);
    const double compute_s = run.seconds();
    if (!options.stock.empty()) done.stock->save(options.stock);
    const std::vector<std::string> assumed = machine::assumptions(job.job);
    result = copy_result_of(done);
    result.diagnostics = found.all();
    result.json = machine::with_assumptions(report::copy_json(done, compute_s), assumed);
    result.printed = machine::assumptions_text(assumed) + report::copy_text(done, compute_s);
    if (options.page)
      result.page =
          report::copy_page(done, picture, {job_path, job.job.part.mesh, options.output}, api::texts_of(found));
  });
  return result;
}

std::string v0::copy_job_toml(const std::string& job_path, const RunOptions& run_options) {
  Diagnostics found;
  const CopyJob job = read_copy_job(job_path, found);
  api::Run(run_options).settle_first(found);
  std::string out = fmt::format("# {}\n{}", job_path, machine::to_toml(job.job));
  for (const machine::CopyOperation& o : job.operations) out += machine::to_toml(o);
  return out + fmt::format("\n# {}\n{}", job.job.machine_path, machine::to_toml(job.job.machine));
}

}  // namespace camber
