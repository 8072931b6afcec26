#include "report/histogram_svg.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "report/decimate.h"

namespace camber::report {
namespace {

constexpr int kBins = 80;
constexpr double kWidth = 560, kHeight = 250, kLeft = 44, kRight = 10, kTop = 26, kBottom = 40;

double x_at(double fraction) { return kLeft + fraction * (kWidth - kLeft - kRight); }
double y_at(double fraction) { return kHeight - kBottom - fraction * (kHeight - kTop - kBottom); }

std::string signed_text(double value) {
  if (value == 0) return "0";
  return fmt::format("{}{:g}", value < 0 ? "−" : "+", std::abs(value));
}

void text(std::string& out, double x, double y, const char* anchor, const std::string& content) {
  fmt::format_to(std::back_inserter(out), "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y,
                 anchor, content);
}

void bars(std::string& out, const std::vector<double>& percent, double most, const char* colour) {
  fmt::format_to(std::back_inserter(out), "<path fill=\"{}\" d=\"", colour);
  for (std::size_t i = 0; i < percent.size(); ++i) {
    if (percent[i] <= 0) continue;
    const double n = static_cast<double>(percent.size());
    const double left = x_at(static_cast<double>(i) / n), right = x_at((static_cast<double>(i) + 0.9) / n);
    fmt::format_to(std::back_inserter(out), "M{:.1f} {:.1f}V{:.2f}H{:.1f}V{:.1f}Z", left, y_at(0),
                   y_at(percent[i] / most), right, y_at(0));
  }
  out += "\"/>\n";
}

void key(std::string& out, double x, const char* colour, const std::string& name) {
  fmt::format_to(std::back_inserter(out), "<rect x=\"{:.0f}\" y=\"8\" width=\"12\" height=\"8\" fill=\"{}\"/>\n", x,
                 colour);
  text(out, x + 17, 16, "start", name);
}

}  // namespace

std::vector<double> error_histogram(const SurfaceSamples& samples, double SurfaceSample::*error, double limit_um,
                                    int bins) {
  std::vector<double> out(static_cast<std::size_t>(bins), 0.0);
  double area = 0;
  for (const SurfaceSample& s : samples.all()) {
    const double at = std::floor((s.*error / limit_um + 1) / 2 * bins);
    out[static_cast<std::size_t>(std::clamp(at, 0.0, bins - 1.0))] += s.area_mm2;
    area += s.area_mm2;
  }
  for (double& b : out) b = area > 0 ? 100 * b / area : 0;
  return out;
}

std::string histogram_svg(const SurfaceSamples& samples, bool compared, double limit_um,
                          const std::array<std::string, 2>& names) {
  constexpr const char *kGrey = "#9aa5b1", *kBlue = "#1668b8";
  const auto before = error_histogram(samples, &SurfaceSample::error_um, limit_um, kBins);
  const auto after = compared ? error_histogram(samples, &SurfaceSample::error_after_um, limit_um, kBins) : before;
  const double most = nice_limit(
      std::max(*std::max_element(before.begin(), before.end()), *std::max_element(after.begin(), after.end())));
  std::string out = fmt::format(
      "<svg class=\"histogram\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"Histogram of the form "
      "error\">\n",
      kWidth, kHeight);
  for (const double fraction : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    fmt::format_to(std::back_inserter(out), "<path stroke=\"#e3e8ee\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n", x_at(0),
                   y_at(fraction), x_at(1));
    if (fraction != 0.25 && fraction != 0.75)
      text(out, kLeft - 6, y_at(fraction) + 4, "end", fmt::format("{:g}", fraction * most));
  }
  if (compared) {
    bars(out, before, most, kGrey);
    bars(out, after, most, kBlue);
    key(out, kWidth - 150, kGrey, names[0]);
    key(out, kWidth - 70, kBlue, names[1]);
  } else {
    bars(out, before, most, kBlue);
  }
  for (const double fraction : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    text(out, x_at(fraction), kHeight - kBottom + 17,
         fraction == 0   ? "start"
         : fraction == 1 ? "end"
                         : "middle",
         signed_text((2 * fraction - 1) * limit_um));
  }
  text(out, kLeft - 36, 16, "start", "% of the surface");
  text(out, x_at(0.5), kHeight - 6, "middle", "form error, µm");
  return out + "</svg>\n";
}

}  // namespace camber::report
