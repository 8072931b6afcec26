#include "report/check_summary.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/numbers.h"
#include "base/units.h"
#include "checks/tool_outline.h"
#include "machine/assumptions.h"
#include "report/page_parts.h"
#include "report/page_tables.h"

namespace camber::report {
namespace {

using checks::OutlineRing;

constexpr double kPageWidth_mm = 186;   // A4 less its margins
constexpr double kToolHeight_mm = 100;  // of the drawings
constexpr double kViewWidth_mm = 88, kViewHeight_mm = 60;
constexpr double kNominalHolder_mm = 8;  // drawn where the job has no holder

constexpr std::string_view kStyle = R"css(
@page { size: A4 portrait; margin: 12mm; }
* { box-sizing: border-box; }
body { width: 186mm; margin: 6mm auto; font: 9pt/1.35 "DejaVu Sans", "Helvetica", "Arial", sans-serif; color: #000; background: #fff; }
h1 { font-size: 14pt; margin: 0 0 1mm; } h2 { font-size: 10.5pt; margin: 4mm 0 1.5mm; border-bottom: .3mm solid #000; }
p { margin: 0 0 1.5mm; } .assumed { border: .4mm solid #000; padding: 1.5mm 2mm; }
table { border-collapse: collapse; width: 100%; font-size: 8pt; } tr { break-inside: avoid; }
th, td { border: .2mm solid #777; padding: .6mm 1.2mm; text-align: left; vertical-align: top; } td.n, th.n { text-align: right; }
thead { display: table-header-group; } .views, .tools { display: flex; flex-wrap: wrap; gap: 4mm; }
figure { margin: 0; break-inside: avoid; } figcaption { font-size: 7.5pt; } svg { display: block; overflow: visible; }
.line { fill: none; stroke: #000; stroke-width: .25; } .thin { fill: none; stroke: #000; stroke-width: .12; }
.dash { fill: none; stroke: #000; stroke-width: .15; stroke-dasharray: 1.2 .8; } .cutter { fill: #ddd; stroke: #000; stroke-width: .25; }
.shank { fill: #fff; stroke: #000; stroke-width: .25; } .holder { fill: #bbb; stroke: #000; stroke-width: .25; } .label { font-size: 2.6px; }
)css";

std::string number(double value, int decimals = 3) {
  return std::isfinite(value) ? format_trimmed(value, decimals) : "no limit";
}

std::string file_name(const std::string& path) {
  return path.starts_with("preset:") ? path : std::filesystem::path(path).filename().string();
}

std::string clock(double seconds) {
  const auto s = static_cast<long long>(std::llround(seconds));
  return s >= 3600 ? fmt::format("{}:{:02}:{:02} h", s / 3600, s / 60 % 60, s % 60)
                   : fmt::format("{}:{:02} min", s / 60, s % 60);
}

std::string range_text(const nc::Range& r, int decimals) {
  if (r.empty()) return "-";
  const std::string low = format_trimmed(r.min, decimals), high = format_trimmed(r.max, decimals);
  return low == high ? low : low + " to " + high;
}

std::string row(const std::vector<std::string>& cells, const char* tag = "td") {
  std::string out = "<tr>";
  for (const std::string& cell : cells) out += fmt::format("<{0}>{1}</{0}>", tag, html_text(cell));
  return out + "</tr>\n";
}

std::string table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  std::string out = "<table>\n<thead>" + row(head, "th") + "</thead>\n<tbody>\n";
  for (const auto& cells : rows) out += row(cells);
  return out + "</tbody>\n</table>\n";
}

std::string work_offset_name(int offset) {
  if (offset >= 540000) return fmt::format("G54.1 P{}", offset - 540000);
  return offset >= 590 ? fmt::format("G59.{}", offset % 10) : fmt::format("G{}", offset);
}

/// Numbers of H and D words while a tool is in, by tool.
struct Offsets {
  std::map<int, std::set<int>> length, radius;
  std::set<int> work;
};

void add_offsets(const SheetProgram& program, Offsets& out) {
  std::map<std::uint32_t, int> tool_of_block;
  for (const nc::Move& m : program.moves.moves) {
    const nc::ModalState& state = program.moves.state_of(m);
    tool_of_block.emplace(m.block, state.tool);
    if (m.kind != nc::MoveKind::dwell) out.work.insert(state.work_offset);
  }
  for (std::size_t b = 0; b < program.text.blocks.size(); ++b) {
    const nc::Block& block = program.text.blocks[b];
    auto at = tool_of_block.lower_bound(static_cast<std::uint32_t>(b));
    if (at == tool_of_block.end()) continue;
    for (std::size_t w = block.first_word; w < block.first_word + block.word_count; ++w) {
      const nc::Word& word = program.text.words[w];
      if ((word.letter != 'H' && word.letter != 'D') || !(word.value > 0)) continue;
      (word.letter == 'H' ? out.length : out.radius)[at->second].insert(static_cast<int>(word.value));
    }
  }
}

std::string numbers(char letter, const std::map<int, std::set<int>>& of, int tool) {
  const auto at = of.find(tool);
  if (at == of.end()) return "-";
  std::vector<std::string> out;
  for (const int n : at->second) out.push_back(fmt::format("{}{}", letter, n));
  return fmt::format("{}", fmt::join(out, " "));
}

/// A use of one tool over all programs.
struct Use {
  nc::Range feed_mm_per_min, speed_rpm;
  nc::Extents cutting;
  double time_s = 0, cutting_mm = 0;
  std::vector<std::string> lines;
};

std::map<int, Use> uses_of(const SetupSheet& sheet) {
  std::map<int, Use> out;
  for (const SheetProgram& p : sheet.programs) {
    for (const nc::ToolUse& t : p.summary.tools) {
      if (t.cutting_moves == 0) continue;
      Use& use = out[t.tool];
      for (const auto& [from, to] :
           {std::pair{&t.feed_mm_per_min, &use.feed_mm_per_min}, std::pair{&t.spindle_speed_rpm, &use.speed_rpm}})
        if (!from->empty()) to->add(from->min), to->add(from->max);
      use.cutting.add(t.cutting.min_mm);
      use.cutting.add(t.cutting.max_mm);
      use.cutting_mm += t.cutting_length_mm;
      use.lines.push_back(sheet.programs.size() > 1 ? fmt::format("{}:{}", file_name(p.text.source.name()), t.line)
                                                    : fmt::format("{}", t.line));
    }
    for (const feedmodel::CycleUse& t : p.time.tools)
      if (const auto at = out.find(t.tool); at != out.end()) at->second.time_s += t.time.total_s();
  }
  return out;
}

nc::Extents all_extents(const SetupSheet& sheet, nc::Extents nc::Summary::*of) {
  nc::Extents out;
  for (const SheetProgram& p : sheet.programs) {
    const nc::Extents& e = p.summary.*of;
    if (e.empty()) continue;
    out.add(e.min_mm);
    out.add(e.max_mm);
  }
  return out;
}

std::string tool_name(const machine::Tool& t) {
  switch (t.type) {
    case machine::ToolType::ball:
      return "ball end mill";
    case machine::ToolType::flat:
      return "flat end mill";
    case machine::ToolType::bull:
      return fmt::format("bull nose R{}", number(t.corner_radius_mm));
    case machine::ToolType::drill:
      return fmt::format("drill {} deg", number(deg_from_rad(t.point_angle_rad), 1));
    case machine::ToolType::tapered_ball:
      return fmt::format("tapered ball {} deg", number(deg_from_rad(t.taper_rad), 2));
    case machine::ToolType::chamfer:
      return fmt::format("chamfer cutter {} deg", number(deg_from_rad(t.point_angle_rad), 1));
    case machine::ToolType::general:
      break;
  }
  return "profile cutter";
}

/// Half of the outline of a part of the tool, lower end first.
struct Part {
  OutlineRing::Part part;
  std::vector<Vec2> points;
};

std::vector<Part> parts_of(const machine::Tool& tool, double top_mm) {
  std::vector<Part> out;
  for (const OutlineRing& ring : checks::tool_outline(tool, std::max(0.05, tool.diameter_mm / 60), top_mm)) {
    if (out.empty() || out.back().part != ring.part) out.push_back({ring.part, {}});
    out.back().points.emplace_back(ring.radius_mm, ring.height_mm);
  }
  return out;
}

double height_of(const machine::Tool& tool) {
  double height = tool.overhang_mm + kNominalHolder_mm;
  if (!tool.holder.empty()) {
    height = tool.overhang_mm;
    for (const machine::HolderPart& h : tool.holder) height += h.length_mm;
  }
  return height;
}

double width_of(const machine::Tool& tool) {
  double width = std::max({tool.diameter_mm, tool.shank_diameter_mm, 1.0});
  for (const machine::HolderPart& h : tool.holder) width = std::max({width, h.lower_diameter_mm, h.upper_diameter_mm});
  return tool.holder.empty() ? 1.6 * width : width;
}

constexpr const char* kPartClass[] = {"cutter", "shank", "holder"};

std::string tool_drawing(const machine::Tool& tool, double scale) {
  const double height = height_of(tool), width = width_of(tool);
  const double w = width * scale + 16, h = height * scale + 2, middle = width * scale / 2 + 1;
  const auto at = [&](double r, double z) {
    return fmt::format("{:.3f},{:.3f}", middle + r * scale, h - 1 - z * scale);
  };
  std::string out =
      fmt::format("<svg width=\"{0:.2f}mm\" height=\"{1:.2f}mm\" viewBox=\"0 0 {0:.2f} {1:.2f}\">\n", w, h);
  for (const Part& part : parts_of(tool, height)) {
    std::string points;
    for (const Vec2& p : part.points) points += at(p.x(), p.y()) + " ";
    for (auto p = part.points.rbegin(); p != part.points.rend(); ++p) points += at(-p->x(), p->y()) + " ";
    out +=
        fmt::format("<polygon class=\"{}\" points=\"{}\"/>\n", kPartClass[static_cast<std::size_t>(part.part)], points);
  }
  if (tool.holder.empty()) {
    const double r = 0.8 * std::max(tool.diameter_mm, tool.shank_diameter_mm);
    out += fmt::format("<polyline class=\"dash\" points=\"{} {} {} {}\"/>\n", at(-r, height), at(-r, tool.overhang_mm),
                       at(r, tool.overhang_mm), at(r, height));
  }
  out += fmt::format("<polyline class=\"dash\" points=\"{} {}\"/>\n", at(0, -0.5), at(0, height));
  // The overhang, from the holder's face to the tip.
  const double side = width / 2 + 2 / scale;
  for (const double z : {0.0, tool.overhang_mm})
    out += fmt::format("<polyline class=\"thin\" points=\"{} {}\"/>\n", at(0, z), at(side + 1 / scale, z));
  out += fmt::format("<polyline class=\"line\" points=\"{} {}\"/>\n", at(side, 0), at(side, tool.overhang_mm));
  out += fmt::format("<text class=\"label\" x=\"{:.2f}\" y=\"{:.2f}\">{}</text>\n</svg>\n", middle + side * scale + 1,
                     h - 1 - tool.overhang_mm * scale / 2, number(tool.overhang_mm, 2));
  return out;
}

/// 1:1, or the largest of the usual reductions with which all drawings fit; enlarged where all tools are small.
double scale_of(const std::vector<const machine::Tool*>& tools, std::string& name) {
  double tallest = 1, widest = 1;
  for (const machine::Tool* t : tools)
    tallest = std::max(tallest, height_of(*t)), widest = std::max(widest, width_of(*t));
  for (const auto& [scale, text] :
       {std::pair{2.0, "2:1"}, {1.0, "1:1"}, {0.5, "1:2"}, {0.2, "1:5"}, {0.1, "1:10"}, {0.05, "1:20"}})
    if (tallest * scale <= kToolHeight_mm && widest * scale <= kPageWidth_mm / 2) return name = text, scale;
  return name = "1:50", 0.02;
}

std::optional<machine::Box> stock_box(const machine::StockDescription& stock) {
  if (stock.box) return stock.box;
  if (!stock.cylinder) return std::nullopt;
  const double r = stock.cylinder->diameter_mm / 2;
  return machine::Box{stock.cylinder->base_mm - Vec3(r, r, 0),
                      stock.cylinder->base_mm + Vec3(r, r, stock.cylinder->height_mm)};
}

/// The blank and the path from above (axes 0, 1) or from the front (0, 2), with the program's zero.
std::string view(const machine::StockDescription& stock, const std::optional<machine::Box>& box,
                 const nc::Extents& cutting, int up, const char* caption) {
  nc::Extents all;
  all.add(Vec3::Zero());
  if (box) all.add(box->min_mm), all.add(box->max_mm);
  if (!cutting.empty()) all.add(cutting.min_mm), all.add(cutting.max_mm);
  const Vec3 size = (all.max_mm - all.min_mm).cwiseMax(1e-3);
  const double scale = std::min(kViewWidth_mm / size.x(), kViewHeight_mm / size[up]);
  const double w = size.x() * scale + 6, h = size[up] * scale + 6;
  const auto x = [&](double v) { return 3 + (v - all.min_mm.x()) * scale; };
  const auto y = [&](double v) { return h - 3 - (v - all.min_mm[up]) * scale; };
  const auto rectangle = [&](const Vec3& low, const Vec3& high, const char* style) {
    return fmt::format("<rect class=\"{}\" x=\"{:.3f}\" y=\"{:.3f}\" width=\"{:.3f}\" height=\"{:.3f}\"/>\n", style,
                       x(low.x()), y(high[up]), (high.x() - low.x()) * scale, (high[up] - low[up]) * scale);
  };
  std::string out =
      fmt::format("<figure><svg width=\"{0:.2f}mm\" height=\"{1:.2f}mm\" viewBox=\"0 0 {0:.2f} {1:.2f}\">\n", w, h);
  if (stock.cylinder && up == 1)
    out += fmt::format("<circle class=\"line\" cx=\"{:.3f}\" cy=\"{:.3f}\" r=\"{:.3f}\"/>\n",
                       x(stock.cylinder->base_mm.x()), y(stock.cylinder->base_mm.y()),
                       stock.cylinder->diameter_mm / 2 * scale);
  else if (box)
    out += rectangle(box->min_mm, box->max_mm, "line");
  if (!cutting.empty()) out += rectangle(cutting.min_mm, cutting.max_mm, "dash");
  out += fmt::format(
      "<circle class=\"line\" cx=\"{0:.3f}\" cy=\"{1:.3f}\" r=\"1.2\"/><polyline class=\"line\" "
      "points=\"{2:.3f},{1:.3f} "
      "{3:.3f},{1:.3f}\"/><polyline class=\"line\" points=\"{0:.3f},{4:.3f} {0:.3f},{5:.3f}\"/>\n",
      x(0), y(0), x(0) - 2, x(0) + 2, y(0) - 2, y(0) + 2);
  return out + fmt::format("</svg><figcaption>{}</figcaption></figure>\n", caption);
}

std::string point(const Vec3& p) { return fmt::format("X {} Y {} Z {}", number(p.x()), number(p.y()), number(p.z())); }

std::string stock_section(const SetupSheet& sheet) {
  const machine::StockDescription& stock = sheet.job.stock;
  const auto box = stock_box(stock);
  std::string text;
  if (stock.cylinder)
    text = fmt::format("Cylinder D {} x {} mm, base at {}", number(stock.cylinder->diameter_mm),
                       number(stock.cylinder->height_mm), point(stock.cylinder->base_mm));
  else if (box)
    text = fmt::format("Box {} x {} x {} mm, from {} to {}", number(box->max_mm.x() - box->min_mm.x()),
                       number(box->max_mm.y() - box->min_mm.y()), number(box->max_mm.z() - box->min_mm.z()),
                       point(box->min_mm), point(box->max_mm));
  else
    text = "As in " + file_name(stock.mesh.empty() ? stock.vdb : stock.mesh);
  if (stock.allowance_mm > 0) text += fmt::format("; cut before, with {} mm left", number(stock.allowance_mm));
  if (machine::assumed_keys(sheet.job.path).contains("stock")) text += " (assumed)";
  const nc::Extents cutting = all_extents(sheet, &nc::Summary::cutting);
  return "<h2>Blank and program zero</h2>\n<p>" + html_text(text) +
         ". Circle and cross: program zero; dashed: tips while cutting.</p>\n<div class=\"views\">\n" +
         view(stock, box, cutting, 1, "from above, X to the right, Y up") +
         view(stock, box, cutting, 2, "from the front, X to the right, Z up") + "</div>\n";
}

std::string tool_section(const SetupSheet& sheet, const std::map<int, Use>& uses, const Offsets& offsets) {
  const auto assumed = machine::assumed_keys(sheet.job.path);
  std::vector<std::vector<std::string>> rows;
  std::vector<const machine::Tool*> drawn;
  for (const auto& [number_of, use] : uses) {
    const auto at = sheet.job.tools.find(number_of);
    const std::string t = fmt::format("T{}", number_of);
    const std::string length = numbers('H', offsets.length, number_of),
                      radius = numbers('D', offsets.radius, number_of);
    if (at == sheet.job.tools.end()) {
      rows.push_back({t, "not in the job", "", "", "", length, radius, range_text(use.speed_rpm, 0),
                      range_text(use.feed_mm_per_min, 1), number(use.cutting.min_mm.z()), clock(use.time_s)});
      continue;
    }
    const machine::Tool& tool = at->second;
    drawn.push_back(&tool);
    const auto keys = assumed.find(fmt::format("tool.{}", number_of));
    const bool guessed = keys != assumed.end() && std::ranges::find(keys->second, "overhang_mm") != keys->second.end();
    rows.push_back({t, tool_name(tool), number(tool.diameter_mm), fmt::format("{}", tool.flutes),
                    number(tool.overhang_mm, 2) + (guessed ? " (assumed)" : ""), length, radius,
                    range_text(use.speed_rpm, 0), range_text(use.feed_mm_per_min, 1), number(use.cutting.min_mm.z()),
                    clock(use.time_s)});
  }
  std::string out = "<h2>Tools</h2>\n" + table({"tool", "type", "D mm", "flutes", "overhang mm", "length offset",
                                                "radius offset", "S rpm", "F mm/min", "lowest Z mm", "time"},
                                               rows);
  std::string scale_name;
  const double scale = scale_of(drawn, scale_name);
  out +=
      fmt::format("<p>Drawn {}; the figure beside each is its overhang, from the holder's face to the tip, mm.</p>\n",
                  scale_name) +
      "<div class=\"tools\">\n";
  for (const machine::Tool* tool : drawn)
    out += "<figure>" + tool_drawing(*tool, scale) +
           fmt::format("<figcaption>T{} {} D {}</figcaption></figure>\n", tool->number, html_text(tool_name(*tool)),
                       number(tool->diameter_mm));
  return out + "</div>\n";
}

std::string travel_text(const std::array<double, 2>& travel) {
  if (!std::isfinite(travel[0]) && !std::isfinite(travel[1])) return "no limit";
  return fmt::format("{} to {}", number(travel[0]), number(travel[1]));
}

std::string limits_section(const SetupSheet& sheet, const std::map<int, Use>& uses) {
  const machine::Machine& m = sheet.job.machine;
  nc::Extents tips = all_extents(sheet, &nc::Summary::cutting);
  const nc::Extents rapid = all_extents(sheet, &nc::Summary::rapid);
  if (!rapid.empty()) tips.add(rapid.min_mm), tips.add(rapid.max_mm);
  const nc::Extents cutting = all_extents(sheet, &nc::Summary::cutting);
  std::vector<std::vector<std::string>> rows;
  for (int a = 0; a < 3; ++a) {
    const machine::Axis& axis = m.axis[static_cast<std::size_t>(a)];
    const auto of = [a](const nc::Extents& e) {
      return e.empty() ? std::string("-") : fmt::format("{} to {}", number(e.min_mm[a]), number(e.max_mm[a]));
    };
    rows.push_back({std::string(1, "XYZ"[a]), of(cutting), of(tips),
                    axis.given ? travel_text(axis.travel_mm) : "no such axis",
                    number(mm_per_min_from_mm_per_s(std::min(axis.max_velocity_mm_per_s, axis.max_feed_mm_per_s)), 0)});
  }
  nc::Range feed, speed;
  for (const auto& [t, use] : uses) {
    if (!use.feed_mm_per_min.empty()) feed.add(use.feed_mm_per_min.max);
    if (!use.speed_rpm.empty()) speed.add(use.speed_rpm.max);
  }
  return "<h2>Limits</h2>\n" +
         table({"axis", "cutting, tip mm", "all moves, tip mm", "travel of the machine mm", "greatest feed mm/min"},
               rows) +
         fmt::format(
             "<p>Greatest feed of the program {} mm/min; greatest spindle speed {} rpm, of the machine {} rpm. "
             "Travel is in machine coordinates, the path in the work offset.</p>\n",
             feed.empty() ? "-" : number(feed.max, 1), speed.empty() ? "-" : number(speed.max, 0),
             number(m.spindle.max_rpm, 0));
}

std::string times_section(const SetupSheet& sheet) {
  std::vector<std::vector<std::string>> rows;
  double total_s = 0;
  for (const SheetProgram& p : sheet.programs) {
    const feedmodel::CycleUse& all = p.time.all;
    rows.push_back({file_name(p.text.source.name()), fmt::format("{}", all.tool_changes), clock(all.time.cutting_s),
                    clock(all.time.total_s() - all.time.cutting_s), clock(all.time.total_s())});
    total_s += all.time.total_s();
  }
  if (rows.size() > 1) rows.push_back({"all", "", "", "", clock(total_s)});
  return "<h2>Times</h2>\n" + table({"program", "tool changes", "cutting", "other", "total"}, rows);
}

std::string head(const SetupSheet& sheet) {
  std::vector<std::string> names;
  for (const SheetProgram& p : sheet.programs) names.push_back(file_name(p.text.source.name()));
  const std::string title = fmt::format("Set-up sheet: {}", fmt::join(names, ", "));
  std::string out = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  out += kPagePolicy;
  out +=
      fmt::format("<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n", html_text(title), kStyle);
  const machine::Job& job = sheet.job;
  const bool inch = std::ranges::any_of(sheet.programs, [](const SheetProgram& p) { return p.summary.has_inch; });
  const bool mm = std::ranges::any_of(sheet.programs, [](const SheetProgram& p) { return p.summary.has_mm; });
  out += fmt::format("<p>Job {}; machine {}; material {}; programs in {}. All lengths on this sheet are in mm.</p>\n",
                     html_text(file_name(job.path)), html_text(file_name(job.machine_path)),
                     html_text(job.material.preset.empty() ? "as in the job" : std::string(job.material.preset)),
                     mm && inch ? "mm and inch"
                     : inch     ? "inch"
                                : "mm");
  const auto assumed = machine::assumptions(job);
  if (!assumed.empty())
    out += "<p class=\"assumed\"><b>Assumed, not given:</b> " + html_text(fmt::format("{}", fmt::join(assumed, "; "))) +
           "</p>\n";
  return out;
}

std::string offsets_section(const Offsets& offsets) {
  std::vector<std::string> names;
  for (const int work : offsets.work) names.push_back(work_offset_name(work));
  std::vector<std::vector<std::string>> rows;
  for (const std::string& name : names) rows.push_back({name, "", "", "", ""});
  return "<h2>Work offsets</h2>\n<p>Called by the program; write in what is set.</p>\n" +
         table({"offset", "X", "Y", "Z", "set, checked by"}, rows);
}

}  // namespace

std::string setup_sheet_html(const SetupSheet& sheet) {
  const std::map<int, Use> uses = uses_of(sheet);
  Offsets offsets;
  for (const SheetProgram& p : sheet.programs) add_offsets(p, offsets);
  std::string out = head(sheet) + stock_section(sheet) + offsets_section(offsets) + tool_section(sheet, uses, offsets) +
                    limits_section(sheet, uses) + times_section(sheet);
  if (!sheet.warnings.empty()) {
    out += "<h2>Warnings of the check</h2>\n<ul>\n";
    for (const std::string& warning : sheet.warnings) out += "<li>" + html_text(warning) + "</li>\n";
    out += "</ul>\n";
  }
  return out + "</body>\n</html>\n";
}

}  // namespace camber::report
