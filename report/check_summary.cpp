#include "report/check_summary.h"

#include <fmt/format.h>

#include "base/json.h"
#include "base/numbers.h"
#include "nc/language.h"
#include "report/machine_page.h"

namespace camber::report {
namespace {

/// "mm", "inch" or "mm and inch".
std::string unit_text(const nc::Summary& s) {
  if (s.has_mm && s.has_inch) return "mm and inch";
  return s.has_inch ? "inch" : "mm";
}

/// "100 to 400", "400", or "-".
std::string range_text(const nc::Range& r, int decimals) {
  if (r.empty()) return "-";
  const std::string low = format_trimmed(r.min, decimals), high = format_trimmed(r.max, decimals);
  return low == high ? low : fmt::format("{} to {}", low, high);
}

/// Feeds of a tool: mm/min, and degrees/min of moves of rotary axes alone.
std::string tool_feeds_text(const nc::ToolUse& t) {
  std::string out = t.feed_mm_per_min.empty() && !t.feed_deg_per_min.empty() ? "" : range_text(t.feed_mm_per_min, 1);
  if (!t.feed_deg_per_min.empty())
    out += fmt::format("{}{} deg/min", out.empty() ? "" : ", ", range_text(t.feed_deg_per_min, 1));
  return out;
}

/// Lowest and highest Z of a tool's cutting moves.
std::string cut_depths_text(const nc::ToolUse& tool) {
  if (tool.cutting.empty()) return "-";
  return fmt::format("{:.2f} to {:.2f}", tool.cutting.min_mm.z(), tool.cutting.max_mm.z());
}

// --- JSON ------------------------------------------------------------------------------------------------------

Json extents_json(const nc::Extents& e) {
  if (e.empty()) return nullptr;
  return {{"min", {e.min_mm.x(), e.min_mm.y(), e.min_mm.z()}}, {"max", {e.max_mm.x(), e.max_mm.y(), e.max_mm.z()}}};
}

Json range_json(const nc::Range& r) {
  if (r.empty()) return nullptr;
  return {{"min", r.min}, {"max", r.max}};
}

Json tool_use_json(const nc::ToolUse& t) {
  Json out = {{"tool", t.tool},
              {"line", t.line},
              {"calls", t.calls},
              {"cutting_moves", t.cutting_moves},
              {"cutting_length_mm", t.cutting_length_mm},
              {"rapid_length_mm", t.rapid_length_mm},
              {"feed_mm_per_min", range_json(t.feed_mm_per_min)},
              {"spindle_speed_rpm", range_json(t.spindle_speed_rpm)},
              {"cutting_extents_mm", extents_json(t.cutting)}};
  if (!t.feed_deg_per_min.empty()) out["feed_deg_per_min"] = range_json(t.feed_deg_per_min);
  return out;
}

Json diagnostic_json(const Diagnostic& d) {
  return {{"severity", d.severity == Severity::error ? "error" : "warning"},
          {"file", d.location.file},
          {"line", d.location.line},
          {"column", d.location.column},
          {"message", d.message},
          {"check", d.check}};
}

// --- text ------------------------------------------------------------------------------------------------------

std::string extents_text(const nc::Extents& e) {
  if (e.empty()) return "none";
  std::string out;
  for (int axis = 0; axis < 3; ++axis)
    out += fmt::format("{}{} {:.3f} to {:.3f}", axis > 0 ? "  " : "", "XYZ"[axis], e.min_mm[axis], e.max_mm[axis]);
  return out;
}

std::string tool_use_table(const std::vector<nc::ToolUse>& tools) {
  if (tools.empty()) return {};
  constexpr const char* kRow = "{:>4} {:>6} {:>6} {:>16} {:>14} {:>9} {}\n";
  std::string out =
      "\n" + fmt::format(kRow, "tool", "line", "moves", "feed mm/min", "spindle rpm", "cut mm", "cut Z mm");
  for (const auto& t : tools) {
    const std::string z = cut_depths_text(t);
    out += fmt::format(kRow, fmt::format("T{}", t.tool), t.line, t.cutting_moves, tool_feeds_text(t),
                       range_text(t.spindle_speed_rpm, 0), fmt::format("{:.1f}", t.cutting_length_mm), z);
  }
  return out;
}

// --- page ------------------------------------------------------------------------------------------------------

TextTable tools_page_table(const std::vector<nc::ToolUse>& tools) {
  TextTable table{
      "Tools", {"tool", "line", "cutting moves", "feed, mm/min", "spindle, rpm", "cut, mm", "cut Z, mm"}, {}, {}};
  for (const nc::ToolUse& t : tools)
    table.rows.push_back({fmt::format("T{}", t.tool), fmt::format("{}", t.line), fmt::format("{}", t.cutting_moves),
                          tool_feeds_text(t), range_text(t.spindle_speed_rpm, 0),
                          fmt::format("{:.1f}", t.cutting_length_mm), cut_depths_text(t)});
  return table;
}

TextTable extents_page_table(const nc::Summary& s) {
  TextTable table{"Extents", {"", "X, mm", "Y, mm", "Z, mm"}, {}, {}};
  const auto add = [&](const char* name, const nc::Extents& e) {
    if (e.empty()) return;
    std::vector<std::string> row{name};
    for (int a = 0; a < 3; ++a) row.push_back(fmt::format("{:.3f} to {:.3f}", e.min_mm[a] + 0.0, e.max_mm[a] + 0.0));
    table.rows.push_back(std::move(row));
  };
  add("cutting", s.cutting);
  add("rapid", s.rapid);
  return table;
}

Figure count_figure(const char* name, std::size_t value, const char* key) {
  return {name, static_cast<double>(value), std::nullopt, "", 0, key};
}

std::vector<Figure> check_figures(const nc::Summary& s, const Diagnostics& found) {
  std::vector<Figure> figures = {count_figure("blocks", s.blocks, "blocks"),
                                 {"cutting", s.cutting_length_mm, std::nullopt, "mm", 1, "cutting_length_mm"},
                                 {"rapid", s.rapid_length_mm, std::nullopt, "mm", 1, "rapid_length_mm"},
                                 count_figure("warnings", found.warnings(), "warnings"),
                                 count_figure("rapid moves", s.rapids, "moves.rapid"),
                                 count_figure("lines", s.lines, "moves.linear"),
                                 count_figure("arcs", s.arcs, "moves.arc"),
                                 count_figure("dwells", s.dwells, "moves.dwell"),
                                 {"dwell", s.dwell_s, std::nullopt, "s", 1, "dwell_s"}};
  if (s.rotary > 0) figures.push_back(count_figure("moves of rotary axes", s.rotary, "moves.rotary"));
  return figures;
}

/// The machine along the program.
std::string machine_check_page(const ProgramPage& program, const CheckPicture& picture) {
  MachinePage page;
  page.title = program.title;
  page.subtitle = program.subtitle;
  page.figures = program.figures;
  page.tables = program.tables;
  page.warnings = program.warnings;
  page.part = picture.part;
  page.work_origin_mm = picture.work_origin_mm;
  page.tool_diameter_mm = picture.tool_diameter_mm;
  page.notes = {
      "Positions are those of the program; times follow from its feeds and from rapids at the speed of the slowest "
      "axis, without acceleration."};
  if (picture.offset_assumed)
    page.notes.push_back(
        "The work offset is not known (--work-offset G54=X,Y,Z, or G10 L2) and is taken as zero; the travel of X, Y "
        "and Z "
        "is left out.");
  if (picture.track.unknown_moves > 0 && !picture.track.samples.empty())
    page.notes.push_back(fmt::format("{} moves are not shown, as the position of X, Y or Z at their end is not known.",
                                     picture.track.unknown_moves));
  return machine_page(*picture.machine, picture.track.samples, page);
}

}  // namespace

std::string check_json(const CheckSummary& summary, const Diagnostics& found) {
  const nc::Program& text = *summary.text;
  const nc::Summary& s = summary.program;
  Json tools = Json::array(), list = Json::array();
  for (const auto& t : s.tools) tools.push_back(tool_use_json(t));
  for (const auto& d : found.all()) list.push_back(diagnostic_json(d));
  Json report = {{"program", text.source.name()},
                 {"language", nc::language_of(text).name},
                 {"language_shown_by", text.language_reason},
                 {"blocks", s.blocks},
                 {"blocks_with_words", s.blocks_with_words},
                 {"unit", unit_text(s)},
                 {"moves",
                  {{"rapid", s.rapids},
                   {"linear", s.lines},
                   {"arc", s.arcs},
                   {"dwell", s.dwells},
                   {"canned", s.canned},
                   {"cutter_radius", s.cutter_radius},
                   {"high_speed_contouring", s.high_speed_contouring},
                   {"rotary", s.rotary},
                   {"tip_control", s.tip_control},
                   {"tilted_frame", s.tilted_frame},
                   {"dynamic_offset", s.dynamic_offset},
                   {"reference", s.reference}}},
                 {"cutting_length_mm", s.cutting_length_mm},
                 {"rapid_length_mm", s.rapid_length_mm},
                 {"dwell_s", s.dwell_s},
                 {"cutting_extents_mm", extents_json(s.cutting)},
                 {"rapid_extents_mm", extents_json(s.rapid)},
                 {"tools", tools},
                 {"warnings", found.warnings()},
                 {"diagnostics", list}};
  for (const kinematics::FeedMeaningUse& use : summary.feed_meanings)
    report["feed_meanings"].push_back(
        {{"meaning", kinematics::kFeedMeaningTexts[static_cast<std::size_t>(use.meaning)].name},
         {"moves", use.moves},
         {"first_line", use.first_line}});
  if (summary.memory_bytes) report["memory_GB"] = *summary.memory_bytes / 1e9;
  return report.dump(2) + "\n";
}

std::string check_text(const CheckSummary& summary, const Diagnostics& found) {
  const nc::Program& text = *summary.text;
  const nc::Summary& s = summary.program;
  std::string out = fmt::format("{}: {} blocks, {} of them with words, {}\n", text.source.name(), s.blocks,
                                s.blocks_with_words, unit_text(s));
  out += fmt::format("language  {} ({})\n", nc::language_of(text).title, text.language_reason);
  out += fmt::format("moves     {} rapid, {} linear, {} arc, {} dwell", s.rapids, s.lines, s.arcs, s.dwells);
  const auto of_them = [&out](std::size_t count, const char* what) {
    if (count > 0) out += fmt::format("\n          {} of them {}", count, what);
  };
  of_them(s.canned, "by cycles");
  of_them(s.cutter_radius, "under cutter radius compensation");
  of_them(s.high_speed_contouring, "in high speed contouring");
  of_them(s.rotary, "turning rotary axes");
  of_them(s.tip_control, "under tool-centre-point control");
  of_them(s.tilted_frame, "in a tilted frame (G68.2)");
  of_them(s.dynamic_offset, "under the dynamic work offset (G254)");
  of_them(s.reference, "to or from the reference point");
  out += fmt::format("\ncutting   {:.1f} mm\n        {}\n", s.cutting_length_mm, extents_text(s.cutting));
  out += fmt::format("rapid     {:.1f} mm\n        {}\n", s.rapid_length_mm, extents_text(s.rapid));
  if (s.dwells > 0) out += fmt::format("dwell     {} s\n", format_trimmed(s.dwell_s, 3));
  for (const kinematics::FeedMeaningUse& use : summary.feed_meanings)
    out += fmt::format("F         {}: {} block{}, first in line {}\n",
                       kinematics::kFeedMeaningTexts[static_cast<std::size_t>(use.meaning)].text, use.moves,
                       use.moves == 1 ? "" : "s", use.first_line);
  out += tool_use_table(s.tools);
  if (summary.memory_bytes) out += fmt::format("memory    about {:.2g} GB for predict\n", *summary.memory_bytes / 1e9);
  const std::size_t warnings = found.warnings();
  out += fmt::format("\n{}\n",
                     warnings == 0 ? "no warnings" : fmt::format("{} warning{}", warnings, warnings == 1 ? "" : "s"));
  return out;
}

std::string check_page(const CheckSummary& summary, const std::string& checked_with, const Diagnostics& found,
                       const CheckPicture& picture) {
  const nc::Summary& s = summary.program;
  ProgramPage page;
  page.title = "Program " + summary.text->source.name();
  page.subtitle = fmt::format("{}{}camber {}", checked_with, checked_with.empty() ? "" : ", ", CAMBER_VERSION);
  page.figures = check_figures(s, found);
  page.tables = {tools_page_table(s.tools), extents_page_table(s)};
  for (const Diagnostic& d : found.all()) page.warnings.push_back(to_string(d));
  if (picture.machine) return machine_check_page(page, picture);
  page.picture = picture.path;
  if (picture.path.speed_mm_per_min.empty())
    page.notes.push_back("Without a machine file the picture holds programmed feeds alone and draws rapids straight.");
  else
    page.notes.push_back(
        "The picture is the path that the control plans: corners rounded, rapids bent, feeds as its limits allow.");
  return program_page(page);
}

}  // namespace camber::report
