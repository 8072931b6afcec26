#include "report/fit_summary.h"

#include <fmt/format.h>

#include "base/json.h"
#include "machine/job_tables.h"

namespace camber::report {

using dynamics::FittedMode;
using dynamics::ModeFit;

std::string modes_text(const ModeFit& fit) {
  std::string out = fmt::format("{:>12} {:>10} {:>10} {:>10} {:>12} {:>10}\n", "frequency/Hz", "std error", "damping/%",
                                "std error", "stiff./N/um", "std error");
  for (const FittedMode& m : fit.modes)
    out += fmt::format("{:>12.3f} {:>10.2g} {:>10.4f} {:>10.2g} {:>12.5g} {:>10.2g}\n", m.frequency_hz.value,
                       m.frequency_hz.error, 100 * m.damping_ratio.value, 100 * m.damping_ratio.error,
                       m.stiffness_N_per_mm.value / 1000, m.stiffness_N_per_mm.error / 1000);
  out += fmt::format("noise {:.2g} % of each value and {:.2g} % of the peak; misfit {:.2f} times the noise\n",
                     100 * fit.noise_of_value, 100 * fit.noise_of_peak, fit.misfit);
  return out;
}

std::string mode_tables(const ModeFit& fit, const std::string& response, const std::string& direction, int tool) {
  std::string out =
      fmt::format("# Fitted by camber fit-modes to {}; misfit {:.2f} times the noise.\n", response, fit.misfit);
  std::vector<machine::Mode> modes;
  for (const char axis : direction)
    for (const FittedMode& m : fit.modes) {
      // More digits than the fit can know would only hide it.
      const auto rounded = [](double v) { return std::stod(fmt::format("{:.6g}", v)); };
      modes.push_back({axis == 'x' ? Vec2::UnitX() : Vec2::UnitY(), rounded(m.frequency_hz.value),
                       rounded(m.damping_ratio.value), rounded(m.stiffness_N_per_mm.value)});
    }
  for (const FittedMode& m : fit.modes)
    out += fmt::format("# {:.6g} +- {:.2g} Hz, {:.4g} +- {:.2g} %, {:.5g} +- {:.2g} N/um\n", m.frequency_hz.value,
                       m.frequency_hz.error, 100 * m.damping_ratio.value, 100 * m.damping_ratio.error,
                       m.stiffness_N_per_mm.value / 1000, m.stiffness_N_per_mm.error / 1000);
  return out + machine::modes_text(modes, fmt::format("tool.{}", tool));
}

std::string modes_json(const ModeFit& fit) {
  Json out = {{"misfit", fit.misfit},
              {"noise_percent_of_value", 100 * fit.noise_of_value},
              {"noise_percent_of_peak", 100 * fit.noise_of_peak},
              {"modes", Json::array()}};
  for (const FittedMode& m : fit.modes)
    out["modes"].push_back({{"frequency_Hz", m.frequency_hz.value},
                            {"frequency_std_error_Hz", m.frequency_hz.error},
                            {"damping_percent", 100 * m.damping_ratio.value},
                            {"damping_std_error_percent", 100 * m.damping_ratio.error},
                            {"stiffness_N_per_um", m.stiffness_N_per_mm.value / 1000},
                            {"stiffness_std_error_N_per_um", m.stiffness_N_per_mm.error / 1000}});
  return out.dump(2) + "\n";
}

}  // namespace camber::report
