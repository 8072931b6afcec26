// The page of camber adapt: loads and feeds along the path, before and after.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/units.h"
#include "report/adapt_summary.h"
#include "report/page_tables.h"

namespace camber::report {
namespace {

using adapt::AdaptResult;

constexpr double kWidth = 920, kLeft = 70, kRight = 20, kTop = 24, kBottom = 220;
constexpr const char* kBefore = "#8b95a3";
constexpr const char* kAfter = "#1668b8";
constexpr const char* kLimit = "#d9622b";

std::string label(double x, double y, const char* anchor, const std::string& what) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, html_text(what));
}

/// 1, 2 or 5 times a power of ten: about `count` steps up to `most`.
double round_step(double most, int count) {
  const double raw = std::max(most, 1e-9) / count, decade = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * decade >= raw * 0.999) return factor * decade;
  return 10 * decade;
}

/// A plot over one horizontal axis.
class Plot {
 public:
  Plot(double x_from, double x_to, double most, std::string x_name, std::string y_name)
      : from_(x_from), to_(std::max(x_to, x_from + 1e-9)), most_(std::max(1.05 * most, 1e-9)) {
    svg_ = fmt::format(
        "<svg class=\"fixed\" viewBox=\"0 0 {} {:.0f}\" width=\"100%\" role=\"img\" font-size=\"12\" fill=\"#5c6877\" "
        "font-family=\"system-ui, sans-serif\">\n",
        kWidth, kBottom + 44);
    const double step = round_step(most_, 5);
    for (double v = 0; v <= most_; v += step) {
      svg_ += fmt::format("<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#e3e8ee\"/>\n", kLeft,
                          kWidth - kRight, y(v), y(v));
      svg_ += label(kLeft - 6, y(v) + 4, "end", format_trimmed(v, 4));
    }
    const double across = round_step(to_ - from_, 8);
    for (double v = std::ceil(from_ / across) * across; v <= to_; v += across)
      svg_ += label(x(v), kBottom + 16, "middle", format_trimmed(v, 3));
    svg_ += label((kLeft + kWidth - kRight) / 2, kBottom + 36, "middle", x_name) + label(4, 14, "start", y_name);
  }

  double x(double v) const { return kLeft + (v - from_) / (to_ - from_) * (kWidth - kLeft - kRight); }
  double y(double v) const { return kBottom - v / most_ * (kBottom - kTop); }

  void level(double v, const char* colour, const std::string& name) {
    svg_ +=
        fmt::format("<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-dasharray=\"6 4\"/>\n",
                    kLeft, kWidth - kRight, y(v), y(v), colour);
    svg_ += label(kWidth - kRight, y(v) - 5, "end", name);
  }

  /// Least and greatest value of each pixel.
  void band(const std::vector<double>& xs, const std::vector<double>& ys, const char* colour) {
    if (xs.empty()) return;
    const auto pixels = static_cast<std::size_t>(kWidth - kLeft - kRight);
    std::vector<double> low(pixels, 1e300), high(pixels, -1e300);
    for (std::size_t i = 0; i < xs.size(); ++i) {
      const auto at = static_cast<std::size_t>(std::clamp(x(xs[i]) - kLeft, 0.0, static_cast<double>(pixels) - 1));
      low[at] = std::min(low[at], ys[i]);
      high[at] = std::max(high[at], ys[i]);
    }
    std::string points;
    for (std::size_t p = 0; p < pixels; ++p)
      if (high[p] >= low[p]) {
        points += fmt::format("{:.0f},{:.1f} ", kLeft + static_cast<double>(p), y(high[p]));
        if (high[p] - low[p] > 0.005 * most_)
          points += fmt::format("{:.0f},{:.1f} ", kLeft + static_cast<double>(p), y(low[p]));
      }
    line(points, colour);
  }

  void curve(const std::vector<double>& xs, const std::vector<double>& ys, const char* colour) {
    std::string points;
    for (std::size_t i = 0; i < xs.size(); ++i) points += fmt::format("{:.1f},{:.1f} ", x(xs[i]), y(ys[i]));
    line(points, colour);
    for (std::size_t i = 0; i < xs.size(); ++i)
      svg_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", x(xs[i]), y(ys[i]), colour);
  }

  void legend(const std::string& first, const std::string& second) {
    key(kWidth - 330, kBefore, first);
    key(kWidth - 170, kAfter, second);
  }

  std::string svg() const { return svg_ + "</svg>\n"; }

 private:
  void line(const std::string& points, const char* colour) {
    svg_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.2\"/>\n", points, colour);
  }
  void key(double x, const char* colour, const std::string& name) {
    svg_ += fmt::format("<rect x=\"{}\" y=\"4\" width=\"12\" height=\"12\" fill=\"{}\"/>\n", x, colour);
    svg_ += label(x + 17, 14, "start", name);
  }

  double from_, to_, most_;
  std::string svg_;
};

std::string plot_card(const std::string& title, const std::string& svg, const std::string& note) {
  return fmt::format(
      "<div class=\"card\"><h2>{}</h2>\n<div class=\"wide\">\n{}</div>\n<p class=\"note\">{}</p></div>\n",
      html_text(title), svg, html_text(note));
}

std::vector<double> in_mm_per_min(const std::vector<double>& feeds) {
  std::vector<double> out;
  for (const double f : feeds) out.push_back(mm_per_min_from_mm_per_s(f));
  return out;
}

double most_of(const std::vector<double>& a, const std::vector<double>& b, double least) {
  for (const auto* values : {&a, &b})
    for (const double v : *values) least = std::max(least, v);
  return least;
}

std::string feed_card(const adapt::PathTrace& t) {
  if (t.along_mm.empty()) return {};
  const auto before = in_mm_per_min(t.speed_before_mm_per_s), after = in_mm_per_min(t.speed_after_mm_per_s);
  Plot plot(0, t.along_mm.back(), most_of(before, after, 0), "along the cutting moves, mm", "actual feed, mm/min");
  plot.band(t.along_mm, before, kBefore);
  plot.band(t.along_mm, after, kAfter);
  plot.legend("before", "after");
  return plot_card("Feed along the path", plot.svg(),
                   "Actual feed by the feed model: where the axes are slower than F, the picture shows the axes.");
}

std::string load_card(const AdaptResult& r, std::size_t row) {
  std::vector<const adapt::LoadFigure*> upper;
  for (const adapt::LoadFigure& f : r.loads)
    if (f.limit.load != adapt::Load::chip_min) upper.push_back(&f);
  const adapt::LoadLimit& limit = upper[row]->limit;
  const adapt::LoadText& text = adapt::text_of(limit.load);
  std::vector<double> before = r.trace.load_before[row], after = r.trace.load_after[row];
  for (auto* values : {&before, &after})
    for (double& v : *values) v *= text.scale;
  const double bound = text.scale * limit.value;
  Plot plot(0, r.trace.along_mm.back(), most_of(before, after, bound), "along the cutting moves, mm",
            fmt::format("{}, {}", text.name, text.unit));
  plot.band(r.trace.along_mm, before, kBefore);
  plot.band(r.trace.along_mm, after, kAfter);
  plot.level(bound, kLimit, fmt::format("limit {}", format_trimmed(bound, 4)));
  plot.legend("before", "after");
  return plot_card(
      fmt::format("{}{} along the path", static_cast<char>(std::toupper(text.name.front())), text.name.substr(1)),
      plot.svg(), "The greatest value of each place. Before: with a rigid tool; after: as the job couples it.");
}

std::string sweep_card(const AdaptResult& r) {
  if (r.sweep.empty()) return {};
  std::vector<double> factor, time, constant_factor, constant;
  for (const adapt::SweepRow& row : r.sweep) {
    factor.push_back(row.factor);
    time.push_back(row.time_s);
    if (row.constant_feed_mm_per_s <= 0) continue;
    constant_factor.push_back(row.factor);
    constant.push_back(row.constant_time_s);
  }
  Plot plot(factor.front(), factor.back(), most_of(time, constant, 0), "factor of the limits", "time, s");
  plot.curve(constant_factor, constant, kBefore);
  plot.curve(factor, time, kAfter);
  plot.legend("one feed throughout", "adapted");
  TextTable table{"Time for other limits",
                  {"factor of the limits", "time, s", "blocks", "single feed, mm/min", "its time, s"},
                  {},
                  "By the loads of the last prediction and the feed model; no other cut is simulated."};
  for (const adapt::SweepRow& row : r.sweep) {
    const bool any = row.constant_feed_mm_per_s > 0;
    table.rows.push_back({format_trimmed(row.factor, 3), fmt::format("{:.1f}", row.time_s),
                          fmt::format("{}", row.blocks),
                          any ? fmt::format("{:.0f}", mm_per_min_from_mm_per_s(row.constant_feed_mm_per_s)) : "none",
                          any ? fmt::format("{:.1f}", row.constant_time_s) : "-"});
  }
  return plot_card("Time against the limit", plot.svg(), "") + table_html(table);
}

TextTable over_table(const AdaptResult& r) {
  TextTable table{
      "Blocks that remain beyond a limit", {"line", "new line", "load", "value", "feed, mm/min", "why"}, {}, ""};
  constexpr std::size_t kRows = 200;
  for (std::size_t i = 0; i < std::min(kRows, r.over.size()); ++i) {
    const adapt::OverLimit& o = r.over[i];
    const adapt::LoadText& text = adapt::text_of(o.limit.load);
    table.rows.push_back({fmt::format("{}", o.line), fmt::format("{}", o.new_line), std::string(text.name),
                          fmt::format("{:.{}f} {}", text.scale * o.value, text.decimals, text.unit),
                          fmt::format("{:.0f}", mm_per_min_from_mm_per_s(o.feed_mm_per_s)),
                          std::string(adapt::to_string(o.reason))});
  }
  if (r.over.size() > kRows) table.note = fmt::format("and {} more", r.over.size() - kRows);
  return table;
}

TextTable speed_table(const AdaptResult& r) {
  TextTable table{
      fmt::format("Margin of chatter, at most {:g}", r.chatter_limit),
      {"tool", "S before", "S after", "margin before", "line", "margin after", "sound, Hz", "probability, %", "modes"},
      {},
      "Depth over critical depth, the worst tooth passing of each tool and speed. Where S changes, F "
      "changes with it, so that the chip stays."};
  for (const adapt::SpeedChange& c : r.speeds)
    table.rows.push_back({fmt::format("T{}", c.tool), fmt::format("{:.0f}", c.before_rpm),
                          fmt::format("{:.0f}", c.after_rpm), fmt::format("{:.2f}", c.margin_before),
                          std::to_string(c.line), fmt::format("{:.2f}", c.margin_after),
                          fmt::format("{:.0f}", c.chatter_hz), fmt::format("{:.0f}", 100 * c.probability),
                          c.measured ? "given" : "beam, usual damping"});
  return table;
}

std::vector<Figure> figures_of(const AdaptResult& r) {
  std::vector<Figure> out{{"time", r.time_before_s, r.time_after_s, "s", 1, "time_{}_s"},
                          {"cutting", r.cutting_time_before_s, r.cutting_time_after_s, "s", 1, "cutting_time_{}_s"}};
  for (const adapt::LoadFigure& f : r.loads) {
    const adapt::LoadText& text = adapt::text_of(f.limit.load);
    out.push_back({std::string(text.name), text.scale * f.max_before, text.scale * f.max_after, std::string(text.unit),
                   text.decimals, "loads[].max_{}"});
  }
  out.push_back(
      {"blocks", static_cast<double>(r.blocks_before), static_cast<double>(r.blocks_after), "", 0, "blocks.{}"});
  return out;
}

}  // namespace

std::string adapt_page(const AdaptResult& r, const machine::AdaptSettings& asked, const AdaptFiles& files,
                       const std::vector<std::string>& warnings) {
  ReportData data;
  data.figures = figures_of(r);
  std::string intro = fmt::format("{}: {} to {}", files.job, files.program, files.output);
  if (asked.highest_feed_mm_per_s > 0)
    intro += fmt::format(", feeds from {:g} to {:g} mm/min", mm_per_min_from_mm_per_s(asked.lowest_feed_mm_per_s),
                         mm_per_min_from_mm_per_s(asked.highest_feed_mm_per_s));
  std::string out = page_head("Feeds of " + files.program, intro);
  out += tiles_html(data) + list_html("Not reached", "warnings", adapt_failures(r)) +
         list_html("Warnings", "warnings", warnings) + feed_card(r.trace);
  for (std::size_t row = 0; row < r.trace.load_before.size() && !r.trace.along_mm.empty(); ++row)
    out += load_card(r, row);
  out += sweep_card(r) + "<div class=\"columns\">\n" + figures_html(data);
  if (!r.speeds.empty()) out += table_html(speed_table(r));
  if (!r.over.empty()) out += table_html(over_table(r));
  std::vector<std::string> notes;
  if (r.constant_feed_mm_per_s > 0)
    notes.push_back(fmt::format("One feed throughout, {:.0f} mm/min, keeps the limits in {:.1f} s.",
                                mm_per_min_from_mm_per_s(r.constant_feed_mm_per_s), r.constant_time_s));
  if (r.limit_factor != 1) notes.push_back(fmt::format("The time limit scaled all limits by {:.3f}.", r.limit_factor));
  return out + list_html("Notes", "notes", notes) + "</div>\n</main>\n</body>\n</html>\n";
}

}  // namespace camber::report
