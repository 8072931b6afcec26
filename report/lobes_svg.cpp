#include "report/lobes_summary.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "report/plot_frame.h"

namespace camber::report {
namespace {

constexpr const char *kBorderColour = "#1668b8", *kFlipColour = "#c0392b", *kStableColour = "#2e8b57";
constexpr double kNotDrawn = std::numeric_limits<double>::quiet_NaN();

/// Highest depth that is drawn: peaks of lobes go on for ever.
double top_of(const std::vector<dynamics::LobePoint>& lobes, const std::vector<OperatingPoint>& points) {
  constexpr double kOfLowest = 8;
  double lowest = std::numeric_limits<double>::infinity(), highest = 0;
  for (const auto& p : lobes) {
    if (!std::isfinite(p.critical.depth_mm)) continue;
    lowest = std::min(lowest, p.critical.depth_mm), highest = std::max(highest, p.critical.depth_mm);
  }
  double top = std::isfinite(lowest) ? std::min(highest, kOfLowest * lowest) : 1;
  for (const auto& p : points) top = std::max(top, 1.1 * p.depth_mm);
  return top;
}

}  // namespace

std::string lobes_svg(const std::vector<dynamics::LobePoint>& lobes, const std::vector<OperatingPoint>& points) {
  if (lobes.empty()) return {};
  const PlotFrame frame(lobes.front().speed_rpm, lobes.back().speed_rpm, 0, top_of(lobes, points));
  std::vector<double> speed, border, flips;
  for (const auto& p : lobes) {
    const bool flip = p.border == dynamics::StabilityBorder::flip;
    speed.push_back(p.speed_rpm);
    border.push_back(std::isfinite(p.critical.depth_mm) ? p.critical.depth_mm : kNotDrawn);
    flips.push_back(flip ? p.critical.depth_mm : kNotDrawn);
  }
  std::string out = frame.begin("Stability lobes", "spindle speed, 1/min", "critical axial depth, mm");
  out += frame.line(speed, border, kBorderColour) + frame.line(speed, flips, kFlipColour);
  for (const auto& p : points) {
    const auto next = std::ranges::lower_bound(lobes, p.speed_rpm, {}, &dynamics::LobePoint::speed_rpm);
    const bool unstable = next != lobes.end() && p.depth_mm > next->critical.depth_mm;
    out += frame.dot(p.speed_rpm, p.depth_mm, unstable ? kFlipColour : kStableColour, p.title);
  }
  return out + PlotFrame::end();
}

}  // namespace camber::report
