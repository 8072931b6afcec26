#include "camber/time.h"

#include "api/commands/time.h"
#include "api/job.h"
#include "api/program.h"
#include "api/run.h"
#include "base/units.h"
#include "machine/assumptions.h"

namespace camber {
namespace {

TimeUse use_of(const feedmodel::CycleUse& u) {
  const feedmodel::CycleSplit& t = u.time;
  return {.tool = u.tool,
          .tool_changes = u.tool_changes,
          .cutting_moves = u.cutting_moves,
          .cutting_s = t.cutting_s,
          .positioning_s = t.positioning_s,
          .spindle_s = t.spindle_s,
          .tool_change_s = t.tool_change_s,
          .m_code_s = t.m_code_s,
          .dwell_s = t.dwell_s,
          .index_s = t.index_s,
          .pallet_s = t.pallet_s,
          .total_s = t.total_s(),
          .cutting_length_mm = u.cutting_mm,
          .positioning_length_mm = u.positioning_mm,
          .commanded_feed_mm_per_min = mm_per_min_from_mm_per_s(u.commanded_feed_mm_per_s()),
          .average_feed_mm_per_min = mm_per_min_from_mm_per_s(u.average_feed_mm_per_s()),
          .e = u.e(),
          .k = u.k()};
}

TimeResult result_of(const api::TimeReport& report, const Diagnostics& found) {
  TimeResult out;
  const feedmodel::CycleTime& first = report.rows.front().time;
  out.all = use_of(first.all);
  for (const feedmodel::CycleUse& use : first.tools) out.tools.push_back(use_of(use));
  if (!report.keys.empty())
    for (const auto& row : report.rows) out.sweep.push_back(use_of(row.time.all));
  out.notes = report.notes;
  out.diagnostics = found.all();
  out.json = api::time_json(report);
  return out;
}

}  // namespace

TimeResult v0::time(const Program& program, const Machine& machine, const TimeOptions& options,
                    const RunOptions& run_options) {
  TimeResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found = machine.impl().found;
    found.append(program.impl().found);
    const api::TimedProgram timed =
        api::time_program({.program = program.path(),
                           .text = &program.impl().text,
                           .machine_path = machine.path(),
                           .machine = &machine.impl().machine,
                           .trace = options.trace,
                           .cases = {},
                           .sweeps = options.sweeps,
                           .interpreter = program.impl().options,
                           .picture = false,
                           .progress = [&](double fraction) { run.show("timing", fraction); }},
                          found);
    run.settle(found);
    result = result_of(timed.report, found);
    result.json = machine::with_assumptions(std::move(result.json), machine::assumptions(machine.impl().machine));
  });
  return result;
}

}  // namespace camber
