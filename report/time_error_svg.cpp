#include "report/histogram_svg.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace camber::report {
namespace {

constexpr double kWidth = 560, kHeight = 260, kLeft = 50, kRight = 16, kTop = 28, kBottom = 44;
constexpr double kShownErrors = 1.6;  // of the greatest error of the times: rounds above it are left out
constexpr const char *kBlue = "#1668b8", *kGrey = "#9aa5b1", *kRed = "#c0392b";

/// A linear axis whose marks are at whole steps.
struct Axis {
  double least = 0, greatest = 1, from_px = 0, to_px = 1, step = 1;

  double px(double value) const { return from_px + (value - least) / (greatest - least) * (to_px - from_px); }
};

/// 1, 2 or 5 times a power of ten, at most six of them.
double step_over(double span) {
  const double decade = std::pow(10, std::floor(std::log10(span / 5)));
  for (const double s : {1.0, 2.0, 5.0})
    if (span / (s * decade) <= 6) return s * decade;
  return 10 * decade;
}

Axis axis_over(double least, double greatest, double from_px, double to_px) {
  const double span = std::max(greatest - least, 1e-3 * std::max(1.0, greatest));
  Axis out{.from_px = from_px, .to_px = to_px, .step = step_over(span)};
  out.least = std::floor(least / out.step) * out.step;
  out.greatest = std::ceil((least + span) / out.step - 1e-9) * out.step;
  return out;
}

void text(std::string& out, double x, double y, const char* anchor, const std::string& what) {
  fmt::format_to(std::back_inserter(out), "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y,
                 anchor, what);
}

void add_axes(std::string& out, const Axis& x, const Axis& y) {
  for (int i = 0; y.least + i * y.step <= y.greatest + 1e-9; ++i) {
    const double at = y.px(y.least + i * y.step);
    fmt::format_to(std::back_inserter(out), "<path stroke=\"#e3e8ee\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n", kLeft, at,
                   kWidth - kRight);
    text(out, kLeft - 6, at + 4, "end", fmt::format("{:.6g}", y.least + i * y.step));
  }
  for (int i = 0; x.least + i * x.step <= x.greatest + 1e-9; ++i)
    text(out, x.px(x.least + i * x.step), kHeight - kBottom + 17, "middle",
         fmt::format("{:.6g}", x.least + i * x.step));
  text(out, (kLeft + kWidth - kRight) / 2, kHeight - 8, "middle", "machine time, s");
  text(out, 4, 16, "start", "95th percentile of the error, µm");
}

void dot(std::string& out, double x, double y, double radius, const char* stroke, const char* fill,
         const std::string& title) {
  fmt::format_to(
      std::back_inserter(out),
      "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\" stroke=\"{}\" fill=\"{}\"><title>{}</title></circle>\n", x, y,
      radius, stroke, fill, title);
}

std::string title_of(const compensate::Round& r, std::size_t number) {
  return fmt::format("round {}: {:.1f} s, {:.2f} µm, {} changes of feed, {} runs cut twice", number, r.machine_time_s,
                     r.error_um.p95, r.slowed, r.repeated);
}

}  // namespace

std::string time_error_svg(const compensate::CompensationResult& c, double tolerance_um) {
  if (c.time_points.empty()) return {};
  std::vector<std::size_t> marked;
  for (const compensate::TimePoint& p : c.time_points) marked.push_back(p.round);
  marked.push_back(c.best);
  double most = tolerance_um;
  for (const std::size_t r : marked) most = std::max(most, c.rounds[r].error_um.p95);
  std::vector<std::size_t> shown;
  for (std::size_t r = 0; r < c.rounds.size(); ++r)
    if (c.rounds[r].error_um.p95 <= kShownErrors * most) shown.push_back(r);
  double times[2] = {c.rounds[c.best].machine_time_s, c.rounds[c.best].machine_time_s}, greatest = most;
  for (const std::size_t r : shown) {
    times[0] = std::min(times[0], c.rounds[r].machine_time_s);
    times[1] = std::max(times[1], c.rounds[r].machine_time_s);
    greatest = std::max(greatest, c.rounds[r].error_um.p95);
  }
  const Axis x = axis_over(times[0], times[1], kLeft, kWidth - kRight);
  const Axis y = axis_over(0, greatest, kHeight - kBottom, kTop);
  const auto at_x = [&](std::size_t r) { return x.px(c.rounds[r].machine_time_s); };
  const auto at_y = [&](std::size_t r) { return y.px(c.rounds[r].error_um.p95); };

  std::string out = fmt::format(
      "<svg class=\"histogram\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"Machine time against "
      "error\">\n",
      kWidth, kHeight);
  add_axes(out, x, y);
  fmt::format_to(std::back_inserter(out),
                 "<path stroke=\"{}\" stroke-dasharray=\"4 4\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n", kRed, kLeft,
                 y.px(tolerance_um), kWidth - kRight);
  for (const std::size_t r : shown) dot(out, at_x(r), at_y(r), 2, kGrey, kGrey, title_of(c.rounds[r], r));
  std::string line;
  for (const compensate::TimePoint& p : c.time_points)
    line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? "M" : "L", at_x(p.round), at_y(p.round));
  fmt::format_to(std::back_inserter(out), "<path stroke=\"{}\" fill=\"none\" d=\"{}\"/>\n", kBlue, line);
  for (const compensate::TimePoint& p : c.time_points)
    dot(out, at_x(p.round), at_y(p.round), 4, kBlue, c.rounds[p.round].repeated > 0 ? kBlue : "#fff",
        title_of(c.rounds[p.round], p.round));
  dot(out, at_x(c.best), at_y(c.best), 8, kRed, "none", "emitted: " + title_of(c.rounds[c.best], c.best));
  return out + "</svg>\n";
}

}  // namespace camber::report
