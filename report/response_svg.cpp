#include "report/fit_summary.h"

#include <algorithm>
#include <array>
#include <limits>

#include "report/plot_frame.h"

namespace camber::report {

std::string response_svg(const dynamics::FrequencyResponse& response, const dynamics::ModeFit& fit) {
  constexpr double kShown = 1e-4;  // of the peak
  std::vector<double> measured, fitted;
  double peak = 0, least = std::numeric_limits<double>::infinity();
  for (const auto& v : response.value) measured.push_back(std::abs(v)), peak = std::max(peak, std::abs(v));
  for (const auto& v : fit.fitted) fitted.push_back(std::abs(v));
  for (double& v : measured) v = std::max(v, kShown * peak), least = std::min(least, v);
  if (!(peak > 0)) return {};
  const PlotFrame frame(response.hz.front(), response.hz.back(), least, peak, true);
  constexpr std::array<const char*, 3> kNames{"receptance, mm/N", "mobility, mm/s/N", "accelerance, mm/s²/N"};
  std::string out = frame.begin("Frequency response", "frequency, Hz", kNames[static_cast<std::size_t>(response.kind)]);
  out += frame.line(response.hz, measured, "#9aa5b1");
  if (!fitted.empty()) out += frame.line(response.hz, fitted, "#1668b8");
  return out + PlotFrame::end();
}

}  // namespace camber::report
