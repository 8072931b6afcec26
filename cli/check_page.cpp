#include "cli/check_page.h"

#include <fmt/format.h>

#include "base/numbers.h"
#include "report/program_page.h"

namespace camber::cli {
namespace {

report::TextTable tools_of(const std::vector<nc::ToolUse>& tools) {
  report::TextTable table{
      "Tools", {"tool", "line", "cutting moves", "feed, mm/min", "spindle, rpm", "cut, mm", "cut Z, mm"}, {}, {}};
  for (const nc::ToolUse& t : tools)
    table.rows.push_back({fmt::format("T{}", t.tool), fmt::format("{}", t.line), fmt::format("{}", t.cutting_moves),
                          range_text(t.feed_mm_per_min, 1), range_text(t.spindle_speed_rpm, 0),
                          fmt::format("{:.1f}", t.cutting_length_mm), cut_depths_text(t)});
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

std::string range_text(const nc::Range& r, int decimals) {
  if (r.empty()) return "-";
  const std::string low = format_trimmed(r.min, decimals), high = format_trimmed(r.max, decimals);
  return low == high ? low : fmt::format("{} to {}", low, high);
}

std::string cut_depths_text(const nc::ToolUse& tool) {
  if (tool.cutting.empty()) return "-";
  return fmt::format("{:.2f} to {:.2f}", tool.cutting.min_mm.z(), tool.cutting.max_mm.z());
}

std::string check_page(const CheckCommand& command, const nc::Summary& s, const Diagnostics& found,
                       const report::PathPicture& picture) {
  report::ProgramPage page;
  page.title = "Program " + command.program;
  page.subtitle = fmt::format("{}camber {}",
                              !command.job.empty()       ? "with the job " + command.job + ", "
                              : !command.machine.empty() ? "on the machine " + command.machine + ", "
                                                         : "",
                              CAMBER_VERSION);
  page.figures = {count("blocks", s.blocks, "blocks"),
                  {"cutting", s.cutting_length_mm, std::nullopt, "mm", 1, "cutting_length_mm"},
                  {"rapid", s.rapid_length_mm, std::nullopt, "mm", 1, "rapid_length_mm"},
                  count("warnings", found.warnings(), "warnings"),
                  count("rapid moves", s.rapids, "moves.rapid"),
                  count("lines", s.lines, "moves.linear"),
                  count("arcs", s.arcs, "moves.arc"),
                  count("dwells", s.dwells, "moves.dwell"),
                  {"dwell", s.dwell_s, std::nullopt, "s", 1, "dwell_s"}};
  page.picture = picture;
  page.tables = {tools_of(s.tools), extents_of(s)};
  for (const Diagnostic& d : found.all()) page.warnings.push_back(to_string(d));
  if (picture.speed_mm_per_min.empty() && !(command.machine.empty() && command.job.empty()))
    page.notes.push_back(
        "The program has rotary axes: the picture shows X, Y and Z as programmed, with programmed feeds, and rapids "
        "as straight lines.");
  else if (picture.speed_mm_per_min.empty())
    page.notes.push_back("Without a machine file the picture holds programmed feeds alone and draws rapids straight.");
  else
    page.notes.push_back(
        "The picture is the path that the control plans: corners rounded, rapids bent, feeds as its limits allow.");
  return report::program_page(page);
}

}  // namespace camber::cli
