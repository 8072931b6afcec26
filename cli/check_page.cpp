#include "cli/check_page.h"

#include <fmt/format.h>

#include "base/numbers.h"
#include "report/machine_page.h"
#include "report/program_page.h"

namespace camber::cli {
namespace {

report::TextTable tools_of(const std::vector<nc::ToolUse>& tools) {
  report::TextTable table{
      "Tools", {"tool", "line", "cutting moves", "feed, mm/min", "spindle, rpm", "cut, mm", "cut Z, mm"}, {}, {}};
  for (const nc::ToolUse& t : tools)
    table.rows.push_back({fmt::format("T{}", t.tool), fmt::format("{}", t.line), fmt::format("{}", t.cutting_moves),
                          feeds_text(t), range_text(t.spindle_speed_rpm, 0), fmt::format("{:.1f}", t.cutting_length_mm),
                          cut_depths_text(t)});
  return table;
}

report::TextTable extents_of(const nc::Summary& s) {
  report::TextTable table{"Extents", {"", "X, mm", "Y, mm", "Z, mm"}, {}, {}};
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

report::Figure count(const char* name, std::size_t value, const char* key) {
  return {name, static_cast<double>(value), std::nullopt, "", 0, key};
}

}  // namespace

std::string feeds_text(const nc::ToolUse& t) {
  std::string out = t.feed_mm_per_min.empty() && !t.feed_deg_per_min.empty() ? "" : range_text(t.feed_mm_per_min, 1);
  if (!t.feed_deg_per_min.empty())
    out += fmt::format("{}{} deg/min", out.empty() ? "" : ", ", range_text(t.feed_deg_per_min, 1));
  return out;
}

std::string range_text(const nc::Range& r, int decimals) {
  if (r.empty()) return "-";
  const std::string low = format_trimmed(r.min, decimals), high = format_trimmed(r.max, decimals);
  return low == high ? low : fmt::format("{} to {}", low, high);
}

std::string cut_depths_text(const nc::ToolUse& tool) {
  if (tool.cutting.empty()) return "-";
  return fmt::format("{:.2f} to {:.2f}", tool.cutting.min_mm.z(), tool.cutting.max_mm.z());
}

namespace {

std::vector<report::Figure> figures_of(const nc::Summary& s, const Diagnostics& found) {
  std::vector<report::Figure> figures = {count("blocks", s.blocks, "blocks"),
                                         {"cutting", s.cutting_length_mm, std::nullopt, "mm", 1, "cutting_length_mm"},
                                         {"rapid", s.rapid_length_mm, std::nullopt, "mm", 1, "rapid_length_mm"},
                                         count("warnings", found.warnings(), "warnings"),
                                         count("rapid moves", s.rapids, "moves.rapid"),
                                         count("lines", s.lines, "moves.linear"),
                                         count("arcs", s.arcs, "moves.arc"),
                                         count("dwells", s.dwells, "moves.dwell"),
                                         {"dwell", s.dwell_s, std::nullopt, "s", 1, "dwell_s"}};
  if (s.rotary > 0) figures.push_back(count("moves of rotary axes", s.rotary, "moves.rotary"));
  return figures;
}

/// The machine along the program.
std::string machine_check_page(const report::ProgramPage& program, const CheckPicture& picture) {
  report::MachinePage page;
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
  return report::machine_page(*picture.machine, picture.track.samples, page);
}

}  // namespace

std::string check_page(const CheckCommand& command, const nc::Summary& s, const Diagnostics& found,
                       const CheckPicture& picture) {
  report::ProgramPage page;
  page.title = "Program " + command.program;
  page.subtitle = fmt::format("{}camber {}",
                              !command.job.empty()       ? "with the job " + command.job + ", "
                              : !command.machine.empty() ? "on the machine " + command.machine + ", "
                                                         : "",
                              CAMBER_VERSION);
  page.figures = figures_of(s, found);
  page.tables = {tools_of(s.tools), extents_of(s)};
  for (const Diagnostic& d : found.all()) page.warnings.push_back(to_string(d));
  if (picture.machine) return machine_check_page(page, picture);
  page.picture = picture.path;
  if (picture.path.speed_mm_per_min.empty())
    page.notes.push_back("Without a machine file the picture holds programmed feeds alone and draws rapids straight.");
  else
    page.notes.push_back(
        "The picture is the path that the control plans: corners rounded, rapids bent, feeds as its limits allow.");
  return report::program_page(page);
}

}  // namespace camber::cli
