// Pictures of the cycle time page, as SVG.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/numbers.h"
#include "report/cycle_page.h"
#include "report/page_tables.h"

namespace camber::report {
namespace {

constexpr const char* kColours[] = {"#1668b8", "#8b95a3", "#7a4fb5", "#d9622b",
                                    "#c7a02c", "#4f9d69", "#a0527a", "#3b8f9e"};
constexpr double kWidth = 920, kLeft = 190, kRight = 90;

std::string text(double x, double y, const char* anchor, const std::string& what) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, html_text(what));
}

std::string open(double height) {
  return fmt::format(
      "<svg class=\"fixed\" viewBox=\"0 0 {} {:.0f}\" width=\"100%\" role=\"img\" font-size=\"12\" fill=\"#5c6877\" "
      "font-family=\"system-ui, sans-serif\">\n",
      kWidth, height);
}

std::string box(double x, double y, double w, double h, const char* colour, const std::string& tip) {
  return fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"><title>{}</title></rect>\n", x, y,
      std::max(w, 0.0), std::max(h, 0.0), colour, html_text(tip));
}

/// 1, 2 or 5 times a power of ten: about `count` steps up to `most`.
double step_of(double most, int count) {
  const double raw = std::max(most, 1e-9) / count, decade = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * decade >= raw * 0.999) return factor * decade;
  return 10 * decade;
}

}  // namespace

std::string split_bars_svg(const std::vector<CycleRow>& rows) {
  double most = 1e-9;
  for (const CycleRow& row : rows) most = std::max(most, row.time.all.time.total_s());
  const double scale = (kWidth - kLeft - kRight) / most;
  std::string out = open(36.0 + 26.0 * static_cast<double>(rows.size()));
  double at = kLeft;
  for (std::size_t k = 0; k < std::size(feedmodel::kCycleKinds); ++k) {
    const auto& kind = feedmodel::kCycleKinds[k];
    if (std::none_of(rows.begin(), rows.end(), [&](const CycleRow& r) { return r.time.all.time.*kind.field > 0; }))
      continue;
    out += box(at, 4, 12, 12, kColours[k], std::string(kind.name));
    out += text(at + 17, 14, "start", std::string(kind.name));
    at += 30 + 7.0 * static_cast<double>(kind.name.size());
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = 28.0 + 26.0 * static_cast<double>(i);
    out += text(kLeft - 8, y + 14, "end", rows[i].name);
    double x = kLeft;
    for (std::size_t k = 0; k < std::size(feedmodel::kCycleKinds); ++k) {
      const auto& kind = feedmodel::kCycleKinds[k];
      const double s = rows[i].time.all.time.*kind.field;
      if (s > 0) out += box(x, y, s * scale, 19, kColours[k], fmt::format("{} {:.1f} s", kind.name, s));
      x += s * scale;
    }
    out += text(x + 6, y + 14, "start", fmt::format("{:.1f} s", rows[i].time.all.time.total_s()));
  }
  return out + "</svg>\n";
}

std::string sweep_svg(const CyclePage& page) {
  if (page.keys.empty() || page.rows.size() < 2) return {};
  constexpr double kTop = 24, kBottom = 250, kPlotLeft = 70, kPlotRight = kWidth - 20;
  double low = page.rows.front().values.front(), high = low, most = 0;
  for (const CycleRow& row : page.rows) {
    low = std::min(low, row.values.front());
    high = std::max(high, row.values.front());
    most = std::max(most, row.time.all.time.total_s());
  }
  if (high <= low) return {};
  const auto x = [&](double v) { return kPlotLeft + (v - low) / (high - low) * (kPlotRight - kPlotLeft); };
  const auto y = [&](double v) { return kBottom - v / (1.05 * most) * (kBottom - kTop); };
  std::string out = open(290);
  const double step = step_of(most, 5);
  for (double v = 0; v <= 1.05 * most; v += step) {
    out += fmt::format("<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#e3e8ee\"/>\n",
                       kPlotLeft, kPlotRight, y(v), y(v));
    out += text(kPlotLeft - 6, y(v) + 4, "end", format_trimmed(v, 3));
  }
  // A line for each combination of the other keys' values: the first key runs slowest.
  std::vector<std::vector<double>> others;
  for (const CycleRow& row : page.rows) {
    const std::vector<double> other(row.values.begin() + 1, row.values.end());
    if (std::find(others.begin(), others.end(), other) == others.end()) others.push_back(other);
  }
  for (std::size_t i = 0; i < others.size(); ++i) {
    std::string line, name;
    double end_x = 0, end_y = 0;
    for (std::size_t k = 0; k < others[i].size(); ++k) name += (k > 0 ? " / " : "") + format_trimmed(others[i][k], 4);
    for (const CycleRow& row : page.rows) {
      if (std::vector<double>(row.values.begin() + 1, row.values.end()) != others[i]) continue;
      const double total = row.time.all.time.total_s();
      line += fmt::format("{:.1f},{:.1f} ", x(row.values.front()), y(total));
      end_x = x(row.values.front());
      end_y = y(total);
      out +=
          fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"><title>{}: {:.1f} s</title></circle>\n",
                      x(row.values.front()), y(total), kColours[i % std::size(kColours)], html_text(row.name), total);
    }
    out += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"/>\n", line,
                       kColours[i % std::size(kColours)]);
    out += text(end_x, end_y - 8, "end", name);
  }
  std::string others_name;
  for (std::size_t k = 1; k < page.keys.size(); ++k)
    others_name += (k > 1 ? " / " : "at the end of each line: ") + page.keys[k];
  out += text(kPlotRight, 14, "end", others_name);
  for (const CycleRow& row : page.rows)
    if (row.values.size() < 2 || std::vector<double>(row.values.begin() + 1, row.values.end()) == others.front())
      out += text(x(row.values.front()), kBottom + 16, "middle", format_trimmed(row.values.front(), 3));
  out += text((kPlotLeft + kPlotRight) / 2, kBottom + 34, "middle", page.keys.front());
  return out + text(4, 14, "start", "total time, s") + "</svg>\n";
}

std::string distance_svg(const feedmodel::DistanceHistogram& histogram, const std::string& name) {
  constexpr double kTop = 26, kBottom = 170;
  const std::size_t bins = histogram.counts.size();
  const double most = static_cast<double>(
      std::max<std::size_t>(1, *std::max_element(histogram.counts.begin(), histogram.counts.end())));
  const double width = (kWidth - 60) / static_cast<double>(bins);
  std::string out = open(215) + text(4, 14, "start", name);
  for (std::size_t i = 0; i < bins; ++i) {
    const double x = 40 + width * static_cast<double>(i);
    const double height = static_cast<double>(histogram.counts[i]) / most * (kBottom - kTop);
    const std::string label =
        i < histogram.edges_mm.size() ? "≤ " + format_trimmed(histogram.edges_mm[i], 1) : "longer";
    out +=
        box(x, kBottom - height, width - 4, height, kColours[0], fmt::format("{} mm: {}", label, histogram.counts[i]));
    if (histogram.counts[i] > 0)
      out += text(x + width / 2 - 2, kBottom - height - 4, "middle", fmt::format("{}", histogram.counts[i]));
    out += text(x + width / 2 - 2, kBottom + 16, "middle", label);
  }
  return out + text(kWidth / 2, kBottom + 36, "middle", "distance, mm") + "</svg>\n";
}

}  // namespace camber::report
