#include "report/plot_frame.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace camber::report {
namespace {

constexpr double kPlotWidth = 640, kPlotHeight = 300, kPlotLeft = 58, kPlotRight = 16, kPlotTop = 28, kPlotBottom = 44;

std::string plot_text(double x, double y, const char* anchor, const std::string& what) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, what);
}

}  // namespace

PlotFrame::Range PlotFrame::range_over(double least, double greatest) {
  const double span = std::max(greatest - least, 1e-12 + 1e-6 * std::abs(greatest));
  const double decade = std::pow(10, std::floor(std::log10(span / 5)));
  double step = 10 * decade;
  for (const double s : {5.0, 2.0, 1.0})
    if (span / (s * decade) <= 6) step = s * decade;
  return {std::floor(least / step + 1e-9) * step, std::ceil((least + span) / step - 1e-9) * step, step};
}

PlotFrame::PlotFrame(double x_least, double x_greatest, double y_least, double y_greatest, bool y_log)
    : x_(range_over(x_least, x_greatest)),
      y_(y_log ? Range{std::floor(std::log10(y_least)), std::ceil(std::log10(y_greatest)), 1}
               : range_over(y_least, y_greatest)),
      y_log_(y_log) {}

double PlotFrame::x_px(double v) const {
  return kPlotLeft + (v - x_.least) / (x_.greatest - x_.least) * (kPlotWidth - kPlotLeft - kPlotRight);
}

double PlotFrame::y_px(double v) const {
  const double at = y_log_ ? std::log10(std::max(v, 1e-300)) : v;
  const double share = std::clamp((at - y_.least) / (y_.greatest - y_.least), 0.0, 1.0);
  return kPlotHeight - kPlotBottom - share * (kPlotHeight - kPlotTop - kPlotBottom);
}

std::string PlotFrame::begin(const std::string& label, const std::string& x_name, const std::string& y_name) const {
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"histogram\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" "
      "aria-label=\"{}\" font-family=\"sans-serif\" font-size=\"12\">\n",
      kPlotWidth, kPlotHeight, label);
  for (int i = 0; y_.least + i * y_.step <= y_.greatest + 1e-9; ++i) {
    const double mark = y_.least + i * y_.step, value = y_log_ ? std::pow(10, mark) : mark, at = y_px(value);
    fmt::format_to(std::back_inserter(out), "<path stroke=\"#e3e8ee\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n", kPlotLeft, at,
                   kPlotWidth - kPlotRight);
    out +=
        plot_text(kPlotLeft - 6, at + 4, "end", y_log_ ? fmt::format("{:.0e}", value) : fmt::format("{:.6g}", value));
  }
  for (int i = 0; x_.least + i * x_.step <= x_.greatest + 1e-9; ++i)
    out += plot_text(x_px(x_.least + i * x_.step), kPlotHeight - kPlotBottom + 17, "middle",
                     fmt::format("{:.6g}", x_.least + i * x_.step));
  out += plot_text((kPlotLeft + kPlotWidth - kPlotRight) / 2, kPlotHeight - 8, "middle", x_name);
  return out + plot_text(4, 16, "start", y_name);
}

std::string PlotFrame::line(const std::vector<double>& x, const std::vector<double>& y, const char* colour) const {
  std::string path;
  bool pen = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(y[i])) {
      pen = false;
      continue;
    }
    path += fmt::format("{}{:.1f} {:.1f}", pen ? "L" : "M", x_px(x[i]), y_px(y[i]));
    pen = true;
  }
  return fmt::format("<path stroke=\"{}\" fill=\"none\" stroke-width=\"1.5\" d=\"{}\"/>\n", colour, path);
}

std::string PlotFrame::dot(double x, double y, const char* colour, const std::string& title) const {
  return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\"><title>{}</title></circle>\n", x_px(x),
                     y_px(y), colour, title);
}

}  // namespace camber::report
