#include "cli/posture_command.h"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "api/commands/posture.h"
#include "base/output_file.h"
#include "base/stage.h"
#include "cli/console.h"
#include "cli/posture_page.h"
#include "cli/progress.h"
#include "machine/job_file.h"
#include "nc/language.h"

namespace camber::cli {

int run_posture(const PostureArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  ProgressLine progress(options, "reading");
  const StageScope stages([&](const std::string& what, double share) { progress.show(what, share); });
  const machine::Job job = machine::read_unprogrammed_job(arguments.job, diagnostics);
  const nc::Program text =
      nc::read_program(SourceText::read(arguments.program), nc::language_asked_for(arguments.interpreter), diagnostics);
  nc::require_iso(text, "posture");
  const api::PostureCommand command{.text = &text,
                                    .output = arguments.output,
                                    .job = &job,
                                    .interpreter = arguments.interpreter,
                                    .tool = arguments.tool,
                                    .step_mm = arguments.step_mm,
                                    .options = arguments.options,
                                    .written = arguments.written,
                                    .overhang_step_mm = arguments.overhang_step_mm,
                                    .least_error = arguments.least_error};
  const api::PosturedOverhangs overhangs = api::posture_programs(command, diagnostics);
  const api::PosturedProgram& program = overhangs.program();
  progress.clear();
  settle(diagnostics, options);
  const posture::PostureFigures& figures = program.postured.figures;
  if (!arguments.json.empty()) write_file(arguments.json, api::posture_json(overhangs, command));
  if (program.blocked_line > 0) {
    fmt::print(stderr, "posture: no direction of the tool is clear of {} by {:g} mm in line {}; nothing was written\n",
               arguments.options.stock ? "part, stock and fixtures" : "part and fixtures",
               arguments.options.clearance_mm, program.blocked_line);
    return kNumbersDidNotWorkOut;
  }
  write_file(arguments.output, program.postured.text);
  if (!arguments.report.empty()) write_file(arguments.report, posture_page(overhangs, command, diagnostics));
  if (!options.quiet) {
    if (arguments.overhang_step_mm > 0 && figures.unclear == 0) fmt::print("{}\n", api::overhang_text(overhangs));
    fmt::print("{}", api::posture_text(program, command));
  }
  if (figures.unclear == 0) return kDone;
  fmt::print(
      stderr,
      "posture: the tool is nearer than {:g} mm, or swings, at {} of {} points, first in line {}; the program was "
      "written\n",
      arguments.options.clearance_mm, figures.unclear, figures.points, program.unclear_line);
  return kNumbersDidNotWorkOut;
}

}  // namespace camber::cli
