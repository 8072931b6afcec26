#include "camber/check.h"

#include "api/commands/check.h"
#include "api/job.h"
#include "api/program.h"
#include "api/run.h"
#include "machine/assumptions.h"

namespace camber {
namespace {

std::optional<Box> box_of(const nc::Extents& e) {
  if (e.empty()) return std::nullopt;
  return Box{{e.min_mm.x(), e.min_mm.y(), e.min_mm.z()}, {e.max_mm.x(), e.max_mm.y(), e.max_mm.z()}};
}

ToolUse tool_of(const nc::ToolUse& t) {
  return {t.tool, t.line, t.calls, t.cutting_moves, t.cutting_length_mm, t.rapid_length_mm, box_of(t.cutting)};
}

CheckResult result_of(const nc::Program& text, const api::CheckedProgram& checked, const Diagnostics& found) {
  const nc::Summary& s = checked.summary;
  CheckResult out{.blocks = s.blocks,
                  .blocks_with_words = s.blocks_with_words,
                  .rapids = s.rapids,
                  .lines = s.lines,
                  .arcs = s.arcs,
                  .dwells = s.dwells,
                  .rotary_moves = s.rotary,
                  .cutting_length_mm = s.cutting_length_mm,
                  .rapid_length_mm = s.rapid_length_mm,
                  .dwell_s = s.dwell_s,
                  .cutting = box_of(s.cutting),
                  .rapid = box_of(s.rapid)};
  for (const nc::ToolUse& t : s.tools) out.tools.push_back(tool_of(t));
  out.diagnostics = found.all();
  if (checked.memory_bytes) out.memory_GB = *checked.memory_bytes / 1e9;
  out.json = api::check_json(text, s, found, checked.memory_bytes, checked.feed_meanings);
  return out;
}

CheckResult checked(const Program& program, const Diagnostics& before, const machine::Machine* machine,
                    const machine::Job* job, const RunOptions& options) {
  CheckResult result;
  api::Run run(options);
  run.execute([&] {
    Diagnostics found = before;
    try {
      found.append(program.impl().found);
      const auto done = api::check_program(program.impl().text, program.impl().options, machine, job, found);
      Diagnostics ordered;
      for (auto& d : api::in_order(found.all())) ordered.add(std::move(d));
      run.settle(ordered);
      result = result_of(program.impl().text, done, ordered);
      const auto assumed = job       ? machine::assumptions(*job)
                           : machine ? machine::assumptions(*machine)
                                     : std::vector<std::string>{};
      result.json = machine::with_assumptions(std::move(result.json), assumed);
    } catch (const InputError& e) {
      throw InputError(api::in_order(e.diagnostics()));
    }
  });
  return result;
}

}  // namespace

CheckResult v0::check(const Program& program, const RunOptions& run) {
  return checked(program, {}, nullptr, nullptr, run);
}

CheckResult v0::check(const Program& program, const Machine& machine, const RunOptions& run) {
  return checked(program, machine.impl().found, &machine.impl().machine, nullptr, run);
}

CheckResult v0::check(const Program& program, const Job& job, const RunOptions& run) {
  return checked(program, job.impl().found, &job.impl().job.machine, &job.impl().job, run);
}

}  // namespace camber
