#include "report/copy_summary.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "base/units.h"
#include "report/page_tables.h"

namespace camber::report {
namespace {

using copymill::CopyResult;
using copymill::Tick;

constexpr double kTimeWidth = 920, kTimeHeight = 180, kEdge = 60;

std::string svg_open(double width, double height) {
  return fmt::format(
      "<svg class=\"fixed\" viewBox=\"0 0 {:.0f} {:.0f}\" width=\"100%\" role=\"img\" font-size=\"12\" "
      "fill=\"#5c6877\" font-family=\"system-ui, sans-serif\">\n",
      width, height);
}

std::string svg_label(double x, double y, const char* anchor, const std::string& what) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, html_text(what));
}

/// A value over time; least and greatest of each pixel.
std::string over_time(const std::vector<Tick>& ticks, const std::function<double(const Tick&)>& value, double target,
                      const std::string& name) {
  double most = target;
  for (const Tick& t : ticks) most = std::max(most, value(t));
  most = std::max(1.05 * most, 1e-9);
  const double end = ticks.back().t_s, wide = kTimeWidth - 2 * kEdge;
  const auto x = [&](double t) { return kEdge + wide * t / end; };
  const auto y = [&](double v) { return kTimeHeight - v / most * (kTimeHeight - 24); };
  std::string points;
  for (std::size_t k = 0; k < ticks.size();) {
    const double column = std::floor(x(ticks[k].t_s));
    double low = value(ticks[k]), high = low;
    for (; k < ticks.size() && std::floor(x(ticks[k].t_s)) <= column; ++k)
      low = std::min(low, value(ticks[k])), high = std::max(high, value(ticks[k]));
    points += fmt::format("{:.0f},{:.1f} {:.0f},{:.1f} ", column, y(low), column, y(high));
  }
  std::string out = svg_open(kTimeWidth, kTimeHeight + 40);
  for (const double share : {0.0, 0.5, 1.0}) {
    const double v = share * most / 1.05;
    out += fmt::format("<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#e3e8ee\"/>\n", kEdge,
                       kTimeWidth - kEdge, y(v), y(v));
    out += svg_label(kEdge - 6, y(v) + 4, "end", fmt::format("{:.0f}", v));
  }
  out += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"#1668b8\"/>\n", points);
  if (target > 0)
    out += fmt::format(
        "<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#d9622b\" stroke-dasharray=\"6 4\"/>\n", kEdge,
        kTimeWidth - kEdge, y(target), y(target));
  out += svg_label(4, 14, "start", name) + svg_label(kEdge, kTimeHeight + 18, "middle", "0");
  return out + svg_label(kTimeWidth - kEdge, kTimeHeight + 18, "middle", fmt::format("{:.0f} s", end)) + "</svg>\n";
}

/// The tip from above; deeper is darker.
std::string from_above(const std::vector<Tick>& ticks) {
  Vec3 lo = ticks.front().tip_mm, hi = lo;
  for (const Tick& t : ticks) lo = lo.cwiseMin(t.tip_mm), hi = hi.cwiseMax(t.tip_mm);
  const Vec3 size = (hi - lo).cwiseMax(1e-6);
  const double scale = std::min((kTimeWidth - 40) / size.x(), 600 / size.y());
  std::string out = svg_open(kTimeWidth, scale * size.y() + 40);
  constexpr int kShades = 6;
  for (int shade = 0; shade < kShades; ++shade) {
    std::string path;
    bool down = false;
    for (std::size_t k = 1; k < ticks.size(); ++k) {
      const double depth = (hi.z() - ticks[k].tip_mm.z()) / size.z();
      const bool now = std::min(kShades - 1, static_cast<int>(depth * kShades)) == shade;
      if (now) {
        const auto at = [&](const Tick& t) {
          return fmt::format("{:.1f} {:.1f}", 20 + scale * (t.tip_mm.x() - lo.x()),
                             20 + scale * (hi.y() - t.tip_mm.y()));
        };
        path += (down ? "L" : "M" + at(ticks[k - 1]) + "L") + at(ticks[k]);
      }
      down = now;
    }
    if (!path.empty())
      out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"hsl(210,70%,{}%)\" stroke-width=\"0.8\"/>\n", path,
                         80 - 11 * shade);
  }
  return out + "</svg>\n";
}

std::string card(const std::string& title, const std::string& svg, const std::string& note) {
  return fmt::format(
      "<div class=\"card\"><h2>{}</h2>\n<div class=\"wide\">\n{}</div>\n<p class=\"note\">{}</p></div>\n",
      html_text(title), svg, html_text(note));
}

TextTable operations_table(const CopyResult& r) {
  TextTable out{.title = "Operations",
                .columns = {"tool", "mode", "time, s", "removed, mm3", "levels", "passes", "ramps", "force, N",
                            "target, N", "80 to 105 %"},
                .rows = {},
                .note = "The last column: tooth passings at a feed that the rule chose freely."};
  for (const copymill::OperationSummary& o : r.operations) {
    const bool target = o.load.target_N > 0;
    const double share =
        o.load.counted > 0 ? 100.0 * static_cast<double>(o.load.within) / static_cast<double>(o.load.counted) : 0;
    out.rows.push_back({fmt::format("T{}", o.tool), std::string(machine::word_of(o.mode)), number_text(o.time_s, 1),
                        number_text(o.removed_mm3, 1), std::to_string(o.levels), std::to_string(o.passes),
                        std::to_string(o.ramps), number_text(o.load.max_N, 0),
                        target ? number_text(o.load.target_N, 0) : "-", target ? number_text(share, 1) + " %" : "-"});
  }
  return out;
}

TextTable changes_table(const CopyResult& r) {
  constexpr std::size_t kShown = 40;
  TextTable out{.title = "Changes of depths",
                .columns = {"time, s", "tool", "place", "what", "from", "to", "reason"},
                .rows = {},
                .note = "Changes of feed are in --log."};
  for (const copymill::OperationSummary& o : r.operations)
    for (const copymill::Change& c : o.changes) {
      if (c.what == copymill::Quantity::feed || out.rows.size() >= kShown) continue;
      out.rows.push_back({number_text(c.t_s, 2), fmt::format("T{}", o.tool),
                          fmt::format("X{:.1f} Y{:.1f} Z{:.1f}", c.place_mm.x(), c.place_mm.y(), c.place_mm.z()),
                          std::string(name_of(c.what)), number_text(c.from, 2), number_text(c.to, 2),
                          std::string(text_of(c.cause))});
    }
  return out;
}

}  // namespace

void TickPicture::add(const Tick& tick) {
  if (count_ % stride_ == 0 || tick.load_N >= greatest_.load_N) greatest_ = tick;
  if (++count_ % stride_ != 0) return;
  ticks_.push_back(greatest_);
  greatest_ = {};
  if (ticks_.size() < kMost) return;
  for (std::size_t k = 0; 2 * k + 1 < ticks_.size(); ++k)
    ticks_[k] = ticks_[2 * k].load_N > ticks_[2 * k + 1].load_N ? ticks_[2 * k] : ticks_[2 * k + 1];
  ticks_.resize(ticks_.size() / 2);
  stride_ *= 2;
}

std::string copy_page(const CopyResult& r, const TickPicture& picture, const CopyFiles& files,
                      const std::vector<std::string>& warnings) {
  ReportData data;
  data.figures = {{"time", r.time_s, {}, "s", 1, "time_s"},
                  {"left on the part, p95", r.left.p95_um, {}, "um", 1, "left_um.p95"},
                  {"path into the part", r.path_depth_um, {}, "um", 1, "gouge_um"},
                  {"left on the part, at most", r.left.max_um, {}, "um", 1, "left_um.max"},
                  {"no tool reaches", r.left.unreached_mm2, {}, "mm2", 1, "unreached_mm2"},
                  {"removed", r.removed_mm3, {}, "mm3", 1, "removed_mm3"},
                  {"blocks", static_cast<double>(r.blocks), {}, "", 0, "blocks"},
                  {"ticks", static_cast<double>(r.ticks), {}, "", 0, "ticks"}};
  std::string out = page_head("Copy milling of " + files.part, fmt::format("{} to {}", files.job, files.output));
  out += tiles_html(data) + list_html("Warnings", "warnings", warnings);
  double target = 0;
  for (const copymill::OperationSummary& o : r.operations) target = std::max(target, o.load.target_N);
  if (picture.ticks().size() > 1) {
    out += card("Path", from_above(picture.ticks()), "The tip from above; deeper is darker.");
    out += card("Load",
                over_time(
                    picture.ticks(), [](const Tick& t) { return t.load_N; }, target, "lateral force, N"),
                "Of each tooth passing, its greatest lateral force. Dashed: the greatest target of the operations.");
    out += card("Feed",
                over_time(
                    picture.ticks(), [](const Tick& t) { return mm_per_min_from_mm_per_s(t.feed_mm_per_s); }, 0,
                    "feed, mm/min"),
                "The tip's actual speed, rapids included.");
  }
  out += "<div class=\"columns\">\n" + figures_html(data) + table_html(operations_table(r));
  if (const TextTable changes = changes_table(r); !changes.rows.empty()) out += table_html(changes);
  return out + "</div>\n</main>\n</body>\n</html>\n";
}

}  // namespace camber::report
