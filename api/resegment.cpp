#include "camber/resegment.h"

#include <fmt/format.h>

#include "api/job.h"
#include "api/program.h"
#include "api/run.h"
#include "kinematics/control_options.h"
#include "nc/language.h"
#include "repath/resegment/fastest.h"
#include "report/rewrite_summary.h"

namespace camber {
namespace {

ContourError contour_of(const repath::ContourFigures& f) {
  return {f.time_s, 1000 * f.contour_max_mm, 1000 * f.contour_rms_mm};
}

std::string why_same(const nc::Program& program, const nc::Interpretation& moves, const repath::Fastest& result) {
  if (!result.path.runs.empty()) return {};
  const std::string runs = repath::why_unchanged(program, moves, repath::RunKind::with_arcs);
  return result.tried.empty() ? fmt::format("it is as near to its feed as its blocks allow ({})", runs)
                              : fmt::format("no length of segments is faster ({})", runs);
}

ResegmentResult resegmented(const Program& given, const Machine& on, const ResegmentOptions& options, api::Run& run) {
  const machine::Machine& machine = on.impl().machine;
  const nc::Program& program = given.impl().text;
  const std::string name = options.output.empty() ? given.path() : options.output;
  Diagnostics found = on.impl().found;
  found.append(given.impl().found);
  const nc::InterpreterOptions read = kinematics::interpreter_options(machine, given.impl().options);
  const nc::Interpretation moves = nc::interpret(program, read, found);
  run.settle_first(found);

  run.steps()("timing the old blocks", std::nullopt);
  const repath::ContourFigures before = repath::contour_figures(moves, moves, machine);
  repath::FastestOptions fastest;
  fastest.layout.tolerance_mm = options.tolerance_mm;
  fastest.layout.length_mm = options.length_mm;
  fastest.contour_mm = options.contour_mm;
  fastest.interpreter = read;
  fastest.progress = [&](double fraction) { run.show("timing new ones", fraction); };
  const repath::Fastest result = repath::find_fastest(program, moves, machine, before, fastest);

  Diagnostics again;
  const nc::Program new_program = nc::read_program(SourceText(name, result.path.text), program.language, again);
  const nc::Interpretation new_moves = nc::interpret(new_program, read, again);
  again.throw_if_errors();
  const auto measured = repath::measure_deviation(moves, new_moves, result.path.runs, options.tolerance_mm);
  const report::ResegmentSummary summary{report::program_figures(program, moves),
                                         report::program_figures(new_program, new_moves),
                                         before,
                                         result,
                                         options.tolerance_mm,
                                         measured,
                                         why_same(program, moves, result)};
  ResegmentResult out{.program = result.path.text,
                      .within_limit = result.within_limit,
                      .limit_um = 1000 * result.limit.max_mm,
                      .before = api::counts_of(summary.before),
                      .after = api::counts_of(summary.after),
                      .contour_before = contour_of(before),
                      .contour_after = contour_of(summary.chosen().figures),
                      .runs = result.path.runs.size(),
                      .tried = result.tried.size(),
                      .max_deviation_mm = result.path.max_deviation_mm,
                      .unchanged_because = summary.why,
                      .diagnostics = found.all(),
                      .json = report::resegment_json(summary),
                      .printed = report::resegment_text(summary)};
  if (options.page) out.page = report::resegment_page(summary, {given.path(), name, moves, new_moves, measured});
  return out;
}

}  // namespace

ResegmentResult v0::resegment(const Program& program, const Machine& machine, const ResegmentOptions& options,
                              const RunOptions& run_options) {
  ResegmentResult result;
  api::Run run(run_options);
  run.execute([&] { result = resegmented(program, machine, options, run); });
  return result;
}

}  // namespace camber
