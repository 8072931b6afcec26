#include "report/fit_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/units.h"

namespace camber::report {
namespace {

constexpr double kWidth = 640, kHeight = 420, kLeft = 80, kRight = 20, kTop = 50, kBottom = 60;

/// A logarithmic axis over whole decades.
struct Axis {
  double least, greatest;  // exponents
  double from_px, to_px;
  double px(double value) const {
    return from_px + (std::log10(value) - least) / (greatest - least) * (to_px - from_px);
  }
};

Axis axis_over(double least, double greatest, double from_px, double to_px) {
  Axis a{std::floor(std::log10(least)), std::ceil(std::log10(greatest)), from_px, to_px};
  if (a.greatest <= a.least) a.greatest = a.least + 1;
  return a;
}

void add_decades(std::string& svg, const Axis& x, const Axis& y) {
  auto out = std::back_inserter(svg);
  for (double e = x.least; e <= x.greatest; ++e) {
    const double at = x.px(std::pow(10, e));
    fmt::format_to(out,
                   "<path d=\"M{0:.1f} {1}V{2}\" stroke=\"#ddd\"/><text x=\"{0:.1f}\" y=\"{3}\" "
                   "text-anchor=\"middle\">{4:g}</text>\n",
                   at, kTop, kHeight - kBottom, kHeight - kBottom + 18, std::pow(10, e));
  }
  for (double e = y.least; e <= y.greatest; ++e) {
    const double at = y.px(std::pow(10, e));
    fmt::format_to(out,
                   "<path d=\"M{1} {0:.1f}H{2}\" stroke=\"#ddd\"/><text x=\"{3}\" y=\"{4:.1f}\" "
                   "text-anchor=\"end\">{5:g}</text>\n",
                   at, kLeft, kWidth - kRight, kLeft - 6, at + 4, std::pow(10, e));
  }
}

}  // namespace

std::string block_time_svg(const calib::BlockTimeFit& fit) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
      "<text x=\"{2}\" y=\"24\">{3}</text>\n",
      kWidth, kHeight, kLeft, fit.message);
  if (fit.runs.empty()) return svg + "</svg>\n";
  double chords[2] = {INFINITY, 0}, speeds[2] = {INFINITY, 0};
  for (const calib::ChordRun& r : fit.runs) {
    const double v = mm_per_min_from_mm_per_s(r.speed_mm_per_s);
    chords[0] = std::min(chords[0], r.chord_mm);
    chords[1] = std::max(chords[1], r.chord_mm);
    speeds[0] = std::min(speeds[0], v);
    speeds[1] = std::max({speeds[1], v, mm_per_min_from_mm_per_s(r.feed_mm_per_s)});
  }
  const Axis x = axis_over(chords[0], chords[1], kLeft, kWidth - kRight);
  const Axis y = axis_over(speeds[0], speeds[1], kHeight - kBottom, kTop);
  add_decades(svg, x, y);
  auto out = std::back_inserter(svg);
  if (fit.block_time_s) {
    const double slope = 60.0 / fit.block_time_s->value;  // mm/min for each mm
    const double from = std::max(std::pow(10, x.least), std::pow(10, y.least) / slope);
    const double to = std::min(std::pow(10, x.greatest), std::pow(10, y.greatest) / slope);
    if (to > from)
      fmt::format_to(out, "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"#06c\" fill=\"none\"/>\n", x.px(from),
                     y.px(from * slope), x.px(to), y.px(to * slope));
  }
  for (const calib::ChordRun& r : fit.runs) {
    const double at = x.px(r.chord_mm);
    fmt::format_to(out, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" stroke=\"#06c\" fill=\"{}\"/>\n", at,
                   y.px(mm_per_min_from_mm_per_s(r.speed_mm_per_s)), r.saturated ? "#06c" : "none");
    const double feed = y.px(mm_per_min_from_mm_per_s(r.feed_mm_per_s));
    fmt::format_to(out, "<path d=\"M{:.1f} {:.1f}h10\" stroke=\"#c30\"/>\n", at - 5, feed);
  }
  fmt::format_to(out,
                 "<text x=\"{:.0f}\" y=\"{}\" text-anchor=\"middle\">length of a block, mm</text>\n"
                 "<text transform=\"translate(20 {:.0f}) rotate(-90)\" text-anchor=\"middle\">speed, mm/min</text>\n"
                 "<text x=\"{}\" y=\"40\">filled: saturated; line: V = L / T_b; red: programmed feed</text>\n</svg>\n",
                 (kLeft + kWidth - kRight) / 2, kHeight - 20, (kTop + kHeight - kBottom) / 2, kLeft);
  return svg;
}

}  // namespace camber::report
