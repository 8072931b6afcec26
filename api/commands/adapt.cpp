#include "api/commands/adapt.h"

#include "feedmodel/control_options.h"
#include "feedmodel/fitted_range.h"
#include "nc/interpreter.h"

namespace camber::api {

adapt::AdaptResult adapt_job(const machine::Job& job, const adapt::AdaptOptions& options, Diagnostics& diagnostics) {
  adapt::AdaptResult out = adapt::adapt(job, diagnostics, options);
  Diagnostics ignored;  // those of the given program were reported already
  const auto text = nc::read_program(SourceText(job.program, out.text), ignored);
  const auto moves = nc::interpret(text, feedmodel::interpreter_options(job.machine, job.inch), ignored);
  feedmodel::check_range(moves, job.program, job.machine, diagnostics);
  return out;
}

}  // namespace camber::api
