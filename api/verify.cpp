#include "camber/verify.h"

#include <chrono>

#include "api/commands/verify.h"
#include "api/error_figures.h"
#include "api/run.h"
#include "machine/assumptions.h"
#include "report/summary.h"
#include "report/verdict_text.h"

namespace camber {
namespace {

/// All but diagnostics and json.
VerifyResult result_of(const api::EmittedProgram& emitted, const api::VerifiedProgram& verified) {
  const compensate::Verification& v = verified.result;
  const report::VerdictText verdict = report::verdict_text(v, verified.job.compensation);
  return {.program = emitted.program,
          .job = emitted.job_file,
          .success = verdict.success,
          .headline = verdict.headline,
          .reasons = verdict.reasons,
          .error_um = api::figures_of(v.plain.error_um),
          .deflection_um = api::figures_of(v.plain.deflection_um),
          .contour_um = api::figures_of(v.plain.contour_um),
          .gouge_depth_p999_um = v.depth.gouge_depth_p999_um,
          .depth_limit_um = v.depth_limit_um,
          .machine_time_s = v.machine_time_s};
}

}  // namespace

VerifyResult v0::verify(const std::string& place, const RunOptions& run_options) {
  const auto begin = std::chrono::steady_clock::now();
  VerifyResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found;
    const api::EmittedProgram emitted = api::find_emitted(place);
    const api::VerifiedProgram verified = api::verify_emitted(emitted, found, run.progress());
    run.settle(found);
    const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    result = result_of(emitted, verified);
    result.diagnostics = found.all();
    result.json = machine::with_assumptions(report::verify_json(verified.result, verified.job.compensation, compute_s),
                                            machine::assumptions(verified.job));
  });
  return result;
}

}  // namespace camber
