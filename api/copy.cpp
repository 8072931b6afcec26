#include "camber/copy.h"

#include <chrono>

#include "api/commands/copy.h"
#include "api/run.h"
#include "base/units.h"
#include "report/copy_summary.h"

namespace camber {
namespace {

copymill::CopyOptions copy_options_of(const CopyOptions& options) {
  copymill::CopyOptions out;
  out.stop_after_s = options.stop_after_s;
  if (!options.hardness.empty()) out.regions = simulate::read_force_regions(options.hardness);
  if (options.stream)
    out.stream = [&options](const copymill::Tick& t) {
      options.stream(
          {t.t_s, t.tip_mm.x(), t.tip_mm.y(), t.tip_mm.z(), mm_per_min_from_mm_per_s(t.feed_mm_per_s), t.load_N});
    };
  return out;
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
  const auto begin = std::chrono::steady_clock::now();
  CopyResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found;
    const api::CopyJob job = api::read_copy_job(job_path, found);
    const copymill::CopyResult done = api::copy_job(job, "program.nc", copy_options_of(options), found);
    run.settle(found);
    if (!options.stock.empty()) done.stock->save(options.stock);
    const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    result = copy_result_of(done);
    result.diagnostics = found.all();
    result.json = report::copy_json(done, compute_s);
  });
  return result;
}

}  // namespace camber
