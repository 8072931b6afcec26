#include "camber/fit_modes.h"

#include "api/run.h"
#include "dynamics/modal_fit.h"
#include "report/fit_summary.h"

namespace camber {

FitModesResult v0::fit_modes(const std::string& response, const FitModesOptions& options,
                             const RunOptions& run_options) {
  FitModesResult result;
  api::Run run(run_options);
  run.execute([&] {
    const dynamics::FrequencyResponse measured = dynamics::read_frequency_response(response);
    const dynamics::ModeFit fit =
        dynamics::fit_modes(measured, {.modes = options.modes, .from_hz = options.from_hz, .to_hz = options.to_hz});
    if (fit.modes.empty()) return;
    for (const dynamics::FittedMode& m : fit.modes)
      result.modes.push_back({m.frequency_hz.value, m.frequency_hz.error, 100 * m.damping_ratio.value,
                              100 * m.damping_ratio.error, m.stiffness_N_per_mm.value / 1000,
                              m.stiffness_N_per_mm.error / 1000});
    result.misfit = fit.misfit;
    result.tables = report::mode_tables(fit, response, options.direction, options.tool);
    result.plot = report::response_svg(measured, fit);
    result.json = report::modes_json(fit);
    result.printed = report::modes_text(fit);
  });
  return result;
}

}  // namespace camber
