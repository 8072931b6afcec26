#include "api/commands/adapt.h"

#include "feedmodel/fitted_range.h"
#include "kinematics/machine_program.h"
#include "nc/interpreter.h"

namespace camber::api {

adapt::AdaptResult adapt_job(const machine::Job& job, const adapt::AdaptOptions& options, Diagnostics& diagnostics) {
  adapt::AdaptResult out = adapt::adapt(job, diagnostics, options);
  Diagnostics ignored;  // those of the given program were reported already
  const auto emitted =
      kinematics::open_program(SourceText(job.program, out.text), job.machine,
                               {.given = {.inch = job.inch}, .rotary = kinematics::RotaryWords::never}, ignored);
  feedmodel::check_range(emitted.commanded(), job.program, job.machine, diagnostics);
  return out;
}

}  // namespace camber::api
