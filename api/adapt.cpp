// The namespace adapt comes before the function of that name: clang takes it in no other order.
#include "adapt/adaptation.h"

#include "camber/adapt.h"

#include "api/job.h"
#include "api/run.h"
#include "base/units.h"
#include "feedmodel/fitted_range.h"
#include "kinematics/machine_program.h"
#include "machine/assumptions.h"
#include "nc/interpreter.h"
#include "report/adapt_summary.h"

namespace camber {
namespace {

AdaptResult result_of(const adapt::AdaptResult& r) {
  AdaptResult out{.program = r.text,
                  .reasons = report::adapt_failures(r),
                  .time_before_s = r.time_before_s,
                  .time_after_s = r.time_after_s,
                  .constant_feed_mm_per_min = mm_per_min_from_mm_per_s(r.constant_feed_mm_per_s),
                  .constant_time_s = r.constant_time_s,
                  .blocks_before = r.blocks_before,
                  .blocks_after = r.blocks_after,
                  .blocks_changed = r.blocks_changed,
                  .limit_factor = r.limit_factor};
  out.success = out.reasons.empty();
  for (const adapt::LoadFigure& f : r.loads) {
    const adapt::LoadText& text = adapt::text_of(f.limit.load);
    out.loads.push_back({std::string(text.key), text.scale * f.limit.value, text.scale * f.max_before,
                         text.scale * f.max_after, text.scale * f.max_elsewhere});
  }
  for (const adapt::OverLimit& o : r.over) {
    const adapt::LoadText& text = adapt::text_of(o.limit.load);
    out.over_limit.push_back({o.line, o.new_line, std::string(text.key), text.scale * o.value,
                              mm_per_min_from_mm_per_s(o.feed_mm_per_s), std::string(adapt::to_string(o.reason))});
  }
  for (const adapt::SpeedChange& c : r.speeds)
    out.speeds.push_back({.tool = c.tool,
                          .speed_before_rpm = c.before_rpm,
                          .speed_after_rpm = c.after_rpm,
                          .margin_before = c.margin_before,
                          .margin_after = c.margin_after,
                          .line = c.line,
                          .new_line = c.new_line,
                          .chatter_hz = c.chatter_hz,
                          .kept_depth_mm = c.kept_depth_mm,
                          .stable_speed_rpm = c.advised_rpm,
                          .probability = c.probability,
                          .modes_given = c.measured,
                          .kept = c.kept,
                          .reason = c.reason});
  for (const adapt::SweepRow& row : r.sweep)
    out.sweep.push_back(
        {row.factor, row.time_s, mm_per_min_from_mm_per_s(row.constant_feed_mm_per_s), row.constant_time_s});
  return out;
}

/// Whether the feed model was fitted at such moves.
void check_range_of(const machine::Job& job, const std::string& text, Diagnostics& diagnostics) {
  Diagnostics ignored;  // those of the given program were reported already
  const auto program =
      kinematics::open_program(SourceText(job.program, text), job.machine,
                               {.given = {.inch = job.inch}, .rotary = kinematics::RotaryWords::never}, ignored);
  feedmodel::check_range(program.commanded(), job.program, job.machine, diagnostics);
}

}  // namespace

AdaptResult v0::adapt(const Job& given, const AdaptOptions& options, const RunOptions& run_options) {
  AdaptResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found = given.impl().found;
    const machine::Job& job = api::programmed(given);
    const adapt::AdaptResult done = adapt::adapt(
        job, found, {.time_limit_s = options.time_limit_s, .sweep = options.sweep, .progress = run.progress()});
    check_range_of(job, done.text, found);
    run.settle_first(found);
    const double compute_s = run.seconds();
    const std::vector<std::string> assumed = machine::assumptions(job);
    result = result_of(done);
    result.diagnostics = found.all();
    result.json = machine::with_assumptions(report::adapt_json(done, *job.adapt, compute_s), assumed);
    result.printed = machine::assumptions_text(assumed) + report::adapt_text(done, compute_s);
    if (options.page)
      result.page = report::adapt_page(done, *job.adapt, {job.path, job.program, options.output}, api::texts_of(found));
  });
  return result;
}

}  // namespace camber
