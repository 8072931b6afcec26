#include "api/commands/copy.h"

#include <algorithm>

#include "checks/plausibility.h"
#include "machine/job_file.h"
#include "simulate/collisions.h"
#include "simulate/flute_reach.h"
#include "simulate/predict.h"

namespace camber::api {

CopyJob read_copy_job(const std::string& path, Diagnostics& diagnostics) {
  CopyJob out{machine::read_unprogrammed_job(path, diagnostics), {}};
  out.operations = machine::read_copy_operations(path, out.job, diagnostics);
  checks::check_job_values(out.job, diagnostics);
  diagnostics.throw_if_errors();
  return out;
}

copymill::CopyResult copy_job(const CopyJob& job, const std::string& program, const copymill::CopyOptions& options,
                              Diagnostics& diagnostics) {
  copymill::CopyResult out = copymill::copy(job.job, job.operations, options, diagnostics);
  if (std::ranges::all_of(out.operations, [](const copymill::OperationSummary& o) { return o.nothing_left; }))
    return out;
  const simulate::SimulatedProgram emitted =
      simulate::simulate_motion(SourceText(program, out.text), job.job, {}, diagnostics);
  simulate::check_collisions(job.job, emitted, *out.blank, diagnostics);
  simulate::check_flute_reach(job.job, emitted, *out.blank, diagnostics);
  return out;
}

}  // namespace camber::api
