#include "cli/post_command.h"

#include <optional>

#include <fmt/format.h>

#include "api/commands/post.h"
#include "base/output_file.h"
#include "base/stage.h"
#include "cli/console.h"
#include "cli/progress.h"
#include "machine/job_file.h"
#include "nc/language.h"

namespace camber::cli {

int run_post(const PostArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  ProgressLine progress(options, "reading");
  const StageScope stages([&](const std::string& what, double share) { progress.show(what, share); });
  std::optional<machine::Job> job;
  if (!arguments.job.empty()) job = machine::read_job(arguments.job, diagnostics);
  const machine::Machine machine = job ? job->machine : machine::read_machine(arguments.machine, diagnostics);
  const nc::Program text =
      nc::read_program(SourceText::read(arguments.program), nc::language_asked_for(arguments.interpreter), diagnostics);
  nc::require_iso(text, "post");
  const api::PostRequest request{.text = &text,
                                 .output = arguments.output,
                                 .machine = &machine,
                                 .job = job ? &*job : nullptr,
                                 .interpreter = arguments.interpreter,
                                 .options = arguments.options};
  const api::PostedProgram program = api::post_program(request, diagnostics);
  progress.clear();
  settle(diagnostics, options);
  write_file(arguments.output, program.posted.text);
  if (!arguments.json.empty()) write_file(arguments.json, api::post_json(program, request));
  if (!options.quiet) fmt::print("{}", api::post_text(program));
  return kDone;
}

}  // namespace camber::cli
