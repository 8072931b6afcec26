#include "camber/fit_force.h"

#include "api/run.h"
#include "calib/force_fit.h"
#include "machine/force_law.h"
#include "report/fit_summary.h"

namespace camber {

FitForceResult v0::fit_force(const std::vector<ForceLogFile>& logs, const RunOptions& run_options) {
  FitForceResult out;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found;
    std::vector<calib::MeasuredLog> measured;
    std::vector<std::string> names;
    for (const ForceLogFile& one : logs) {
      names.push_back(one.log);
      measured.push_back(calib::read_measured_log(one.log, machine::read_force_log(one.job, found), found));
    }
    run.settle_first(found);
    run.steps()("fitting", std::nullopt);
    const calib::FitForceResult fit = calib::fit_force(measured);
    for (const auto& p : fit.parameters) out.coefficients.push_back({p.name, p.unit, p.value, p.std_error, p.note});
    out.residual_rms_N = fit.residual_rms_N;
    out.held_out_rms_N = fit.held_out_rms_N;
    out.success = fit.converged && fit.plausible;
    out.message = fit.message;
    out.diagnostics = found.all();
    out.material = report::material_file(fit, names);
    out.json = report::fit_force_json(fit);
    out.printed = report::fit_force_text(fit);
  });
  return out;
}

}  // namespace camber
