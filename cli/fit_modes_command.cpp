#include "cli/fit_modes_command.h"

#include <cmath>

#include <fmt/format.h>

#include "base/json.h"
#include "base/numbers.h"
#include "base/output_file.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "dynamics/fit_modes.h"
#include "machine/job_tables.h"
#include "report/response_svg.h"

namespace camber::cli {
namespace {

using dynamics::FittedMode;
using dynamics::ModeFit;

void print(const ModeFit& fit) {
  fmt::print("{:>12} {:>10} {:>10} {:>10} {:>12} {:>10}\n", "frequency/Hz", "std error", "damping/%", "std error",
             "stiff./N/um", "std error");
  for (const FittedMode& m : fit.modes)
    fmt::print("{:>12.3f} {:>10.2g} {:>10.4f} {:>10.2g} {:>12.5g} {:>10.2g}\n", m.frequency_hz.value,
               m.frequency_hz.error, 100 * m.damping_ratio.value, 100 * m.damping_ratio.error,
               m.stiffness_N_per_mm.value / 1000, m.stiffness_N_per_mm.error / 1000);
  fmt::print("noise {:.2g} % of each value and {:.2g} % of the peak; misfit {:.2f} times the noise\n",
             100 * fit.noise_of_value, 100 * fit.noise_of_peak, fit.misfit);
}

std::string tables_of(const FitModesArguments& a, const ModeFit& fit) {
  std::string out =
      fmt::format("# Fitted by camber fit-modes to {}; misfit {:.2f} times the noise.\n", a.response, fit.misfit);
  std::vector<machine::Mode> modes;
  for (const char axis : a.direction)
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
  return out + machine::modes_text(modes, fmt::format("tool.{}", a.tool));
}

Json json_of(const ModeFit& fit) {
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
  return out;
}

}  // namespace

bool parse_band(const std::string& text, FitModesArguments& into) {
  const auto colon = std::min(text.find(':'), text.size());
  const auto from = parse_number(std::string_view(text).substr(0, colon));
  const auto to = colon < text.size() ? parse_number(std::string_view(text).substr(colon + 1)) : std::nullopt;
  if (!from || !to || *from < 0 || *to <= *from) return false;
  into.from_hz = *from, into.to_hz = *to;
  return true;
}

int run_fit_modes(const FitModesArguments& a, const GlobalOptions& options) {
  const dynamics::FrequencyResponse response = dynamics::read_frequency_response(a.response);
  const ModeFit fit = dynamics::fit_modes(response, {.modes = a.modes, .from_hz = a.from_hz, .to_hz = a.to_hz});
  if (fit.modes.empty()) {
    print_error(
        fmt::format("{}: no mode stands out of the noise{}; a band (--band) around the resonances or another "
                    "number of modes (--modes) was expected",
                    a.response, a.modes ? fmt::format(" with {} of them", *a.modes) : ""));
    return kNumbersDidNotWorkOut;
  }
  if (!options.quiet) print(fit);
  write_file(a.output, tables_of(a, fit));
  if (!a.plot.empty()) write_file(a.plot, report::response_svg(response, fit));
  if (!a.json.empty()) write_file(a.json, json_of(fit).dump(2) + "\n");
  return kDone;
}

}  // namespace camber::cli
