#include "machine/tool_reader.h"

#include <fmt/format.h>

#include "machine/job_keys.h"

namespace camber::machine {
namespace {

/// Corner radius: asked of a bull-nose cutter, refused for the others, whose shape leaves no choice.
void read_corner_radius(TomlTable& table, Tool& tool, std::string_view type) {
  const auto radius = table.optional_number("corner_radius_mm", kPositive);
  if (tool.type != ToolType::bull) {
    if (table.has("corner_radius_mm"))
      table.error_at_name("corner_radius_mm",
                          fmt::format("corner_radius_mm does not belong to type \"{}\"; it is for \"bull\"", type),
                          "key-unused");
    return;
  }
  if (!table.has("corner_radius_mm")) table.missing("corner_radius_mm", kPositive.wanted());
  if (!radius) return;
  tool.corner_radius_mm = *radius;
  if (tool.diameter_mm > 0 && *radius > tool.diameter_mm / 2)
    table.error_at("corner_radius_mm",
                   fmt::format("corner_radius_mm is {}; at most half the diameter, {}, was expected", *radius,
                               tool.diameter_mm / 2),
                   "tool-shape");
}

void read_lengths(TomlTable& table, Tool& tool) {
  tool.flute_length_mm = table.optional_number("flute_length_mm", kPositive);
  tool.shank_diameter_mm = table.number("shank_diameter_mm", kPositive, 0);
  if (tool.flute_length_mm && tool.overhang_mm > 0 && *tool.flute_length_mm > tool.overhang_mm)
    table.error_at("flute_length_mm",
                   fmt::format("flute_length_mm is {}; at most the overhang, {}, was expected", *tool.flute_length_mm,
                               tool.overhang_mm),
                   "tool-shape");
  if (table.has("shank_diameter_mm") && !table.has("flute_length_mm"))
    table.warning_at("shank_diameter_mm",
                     "shank_diameter_mm has no effect: without flute_length_mm the whole overhang is fluted",
                     "tool-shape");
}

void check_overhang(TomlTable& table, const Tool& tool) {
  const double least = tool.type == ToolType::ball ? tool.diameter_mm / 2 : tool.corner_radius_mm;
  if (tool.overhang_mm > 0 && tool.overhang_mm <= least)
    table.error_at(
        "overhang_mm",
        fmt::format("overhang_mm is {}; more than the rounded end, {}, was expected", tool.overhang_mm, least),
        "tool-shape");
}

}  // namespace

Tool read_tool(TomlTable table, int number) {
  Tool tool;
  tool.number = number;
  const auto type = table.required_choice("type", kToolTypeWords);
  for (const auto& k : kToolKeys)
    if ((k.key == "diameter_mm" || k.key == "overhang_mm") && !table.has(k.key)) table.missing(k.key, k.range.wanted());
  read_numbers<Tool>(table, kToolKeys, tool);
  tool.flutes = static_cast<int>(table.required_number("flutes", kFlutes));
  if (type) {
    tool.type = static_cast<ToolType>(*type);
    read_corner_radius(table, tool, kToolTypeWords[*type]);
  }
  read_lengths(table, tool);
  check_overhang(table, tool);
  table.finish();
  return tool;
}

}  // namespace camber::machine
