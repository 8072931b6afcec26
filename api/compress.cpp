#include "camber/compress.h"

#include "api/job.h"
#include "api/new_program.h"
#include "api/program.h"
#include "api/run.h"
#include "base/units.h"
#include "feedmodel/cycle_time.h"
#include "kinematics/control_options.h"
#include "nc/language.h"
#include "repath/compress/compression.h"
#include "report/rewrite_summary.h"

namespace camber {
namespace {

std::optional<repath::FeedsByKind> feeds_by_kind(const CompressOptions& options) {
  if (!options.line_feed_mm_per_min || !options.arc_feed_mm_per_min) return std::nullopt;
  return repath::FeedsByKind{mm_per_s_from_mm_per_min(*options.line_feed_mm_per_min),
                             mm_per_s_from_mm_per_min(*options.arc_feed_mm_per_min), options.block_s};
}

repath::CompressOptions compress_rules(const CompressOptions& options, api::Run& run) {
  repath::CompressOptions out;
  out.tolerance_mm = options.tolerance_mm;
  out.feeds = feeds_by_kind(options);
  out.switch_planes = options.switch_planes;
  out.helices = options.helices;
  out.fit.max_kink_rad = rad_from_deg(options.tangent_deg);
  out.fit.arcs = !options.lines_only;
  out.progress = [&run](double fraction) { run.show("compressing", fraction); };
  return out;
}

CompressResult compressed(const Program& given, const machine::Machine* machine, Diagnostics found,
                          const CompressOptions& options, api::Run& run) {
  const nc::Program& program = given.impl().text;
  const std::string name = options.output.empty() ? given.path() : options.output;
  found.append(given.impl().found);
  const nc::InterpreterOptions read =
      machine ? kinematics::interpreter_options(*machine, given.impl().options) : given.impl().options;
  const nc::Interpretation moves = nc::interpret(program, read, found);
  run.settle_first(found);
  const repath::CompressOptions rules = compress_rules(options, run);
  const repath::Compression result = repath::compress(program, moves, rules);
  Diagnostics again;  // what it says of the text was said above; an error is ours
  const nc::Program new_program = nc::read_program(SourceText(name, result.text), program.language, again);
  const nc::Interpretation new_moves = nc::interpret(new_program, read, again);
  again.throw_if_errors();

  report::CompressSummary summary{.before = report::program_figures(program, moves),
                                  .after = report::program_figures(new_program, new_moves),
                                  .time_before_s = {},
                                  .time_after_s = {},
                                  .time_at_feeds_before_s = {},
                                  .time_at_feeds_after_s = {},
                                  .result = result,
                                  .tolerance_mm = options.tolerance_mm,
                                  .why = {}};
  if (result.runs.empty()) summary.why = repath::why_unchanged(program, moves, repath::RunKind::in_space);
  if (machine) {
    summary.time_before_s = feedmodel::cycle_time(moves, *machine).all.time.total_s();
    summary.time_after_s = feedmodel::cycle_time(new_moves, *machine).all.time.total_s();
  }
  if (rules.feeds) {
    summary.time_at_feeds_before_s = repath::cutting_time_s(moves, *rules.feeds);
    summary.time_at_feeds_after_s = repath::cutting_time_s(new_moves, *rules.feeds);
  }
  CompressResult out{.program = result.text,
                     .before = api::counts_of(summary.before),
                     .after = api::counts_of(summary.after),
                     .runs = result.runs.size(),
                     .max_deviation_mm = result.max_deviation_mm,
                     .max_kink_deg = deg_from_rad(result.max_kink_rad),
                     .time_before_s = summary.time_before_s,
                     .time_after_s = summary.time_after_s,
                     .unchanged_because = summary.why,
                     .diagnostics = found.all(),
                     .printed = report::compress_text(summary)};
  if (!options.json && !options.page) return out;
  const auto measured = repath::measure_deviation(moves, new_moves, result.runs, options.tolerance_mm);
  if (options.json) out.json = report::compress_json(summary, measured);
  if (options.page) out.page = report::compress_page(summary, {given.path(), name, moves, new_moves, measured});
  return out;
}

}  // namespace

CompressResult v0::compress(const Program& program, const CompressOptions& options, const RunOptions& run_options) {
  CompressResult result;
  api::Run run(run_options);
  run.execute([&] { result = compressed(program, nullptr, {}, options, run); });
  return result;
}

CompressResult v0::compress(const Program& program, const Machine& machine, const CompressOptions& options,
                            const RunOptions& run_options) {
  CompressResult result;
  api::Run run(run_options);
  run.execute([&] { result = compressed(program, &machine.impl().machine, machine.impl().found, options, run); });
  return result;
}

}  // namespace camber
