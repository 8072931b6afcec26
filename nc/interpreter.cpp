#include "nc/interpreter.h"

#include <algorithm>

#include <fmt/format.h>

#include "nc/block_interpreter.h"
#include "nc/durations.h"
#include "nc/iso_language.h"
#include "nc/program_files.h"
#include "nc/sequencer.h"

namespace camber::nc {

namespace {

/// Runs the program once.
void run_program(ProgramFiles& files, const InterpreterOptions& options, Reporter& report, Interpretation& out,
                 RunVerdict& verdict) {
  Sequencer sequencer(files, options, report, out);
  sequencer.run();
  out.whole_numbers_are_increments = options.whole_numbers_are_increments.value_or(false);
  verdict = sequencer.verdict();
}

/// The dialect that the text shows where none is named, and what it says of dwells and of numbers without a point.
InterpreterOptions settled(const Program& program, InterpreterOptions options) {
  if (const Dialect* shown = dialect_shown_by(program); shown && !options.dialect) options.dialect = *shown;
  if (options.dialect) options.dwell_p_is_ms |= options.dialect->dwell_p_is_ms;
  const Dialect& dialect = options.dialect_or_default();
  if (!options.whole_numbers_are_increments) {
    if (dialect.whole_numbers_are_increments) options.whole_numbers_are_increments = true;
    if (dialect.whole_numbers_setting.empty()) options.whole_numbers_are_increments = false;
  }
  return options;
}

/// Some CAM systems write absolute arc centres and leave G90.1 to the control. It shows: no arc fits otherwise.
bool try_absolute_centres(ProgramFiles& files, InterpreterOptions options, Diagnostics& diagnostics,
                          Interpretation& found) {
  options.absolute_arc_centre = true;
  files.forget_runs();
  const Program& program = files.main();
  Interpretation out;
  Reporter report(program.source, diagnostics);
  RunVerdict verdict;
  run_program(files, options, report, out, verdict);
  if (report.has_errors()) return false;
  const auto first_arc = std::find_if(out.moves.begin(), out.moves.end(), [](const Move& m) { return m.arc == 0; });
  report.warning(
      program.offset_of(first_arc->block), "arc-centre",
      fmt::format("the {} arcs of the program fit with absolute centres only; G90.1 is assumed", out.arcs.size()));
  check_durations(program, out, report);
  report.finish();
  found = std::move(out);
  return true;
}

}  // namespace

Interpretation interpret_iso(const Program& program, const InterpreterOptions& wanted, Diagnostics& diagnostics) {
  InterpreterOptions options = settled(program, wanted);
  Interpretation out;
  ProgramFiles files(program, diagnostics);
  Reporter report(program.source, diagnostics);
  RunVerdict verdict;
  run_program(files, options, report, out, verdict);
  if (!verdict.increments_warning.empty()) {
    options.whole_numbers_are_increments = true;
    files.forget_runs();
    report.forget();
    out = {};
    report.warning(verdict.increments_offset, "decimal-point", verdict.increments_warning);
    run_program(files, options, report, out, verdict);
  }
  if (verdict.centres_look_absolute && !options.absolute_arc_centre &&
      try_absolute_centres(files, options, diagnostics, out))
    return out;
  check_durations(program, out, report);
  report.finish();
  return out;
}

}  // namespace camber::nc
