#include "machine/job_tables.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "machine/cutter_parameters.h"
#include "machine/job_keys.h"

namespace camber::machine {
namespace {

/// "bull general" as `"bull" or "general"`.
std::string quoted(std::string_view types) {
  std::string out = "\"";
  for (const char c : types) out += c == ' ' ? std::string("\" or \"") : std::string(1, c);
  return out + "\"";
}

/// Numbers of the profile: asked of the types that need them, refused for the others, whose shape leaves no choice.
void read_profile_numbers(TomlTable& table, Tool& tool, std::string_view type) {
  constexpr double kDrillPoint_rad = rad_from_deg(118);
  if (tool.type == ToolType::drill) tool.point_angle_rad = kDrillPoint_rad;
  for (const auto& k : kProfileKeys) {
    const auto value = table.optional_number(k.number.key, k.number.range);
    if (!k.belongs_to(type)) {
      if (table.has(k.number.key))
        table.error_at_name(
            k.number.key,
            fmt::format("{} does not belong to type \"{}\"; it is for {}", k.number.key, type, quoted(k.types)),
            "key-unused");
      continue;
    }
    if (k.must_have(type) && !table.has(k.number.key)) table.missing(k.number.key, k.number.range.wanted());
    if (value) tool.*k.number.field = k.number.unit.inside_from_file(*value);
  }
}

/// Reports what does not fit together in a profile.
void check_profile(TomlTable& table, const Tool& tool) {
  const double radius = tool.diameter_mm / 2;
  if (!(radius > 0)) return;
  if (tool.type == ToolType::bull && tool.corner_radius_mm > radius)
    table.error_at("corner_radius_mm",
                   fmt::format("corner_radius_mm is {}; at most half the diameter, {}, was expected",
                               tool.corner_radius_mm, radius),
                   "tool-shape");
  if (tool.type == ToolType::chamfer && tool.tip_diameter_mm >= tool.diameter_mm)
    table.error_at("tip_diameter_mm",
                   fmt::format("tip_diameter_mm is {}; less than the diameter, {}, was expected", tool.tip_diameter_mm,
                               tool.diameter_mm),
                   "tool-shape");
  if (tool.type == ToolType::general || tool.type == ToolType::tapered_ball) {
    const std::string fault = profile_fault(parameters_of(tool));
    if (!fault.empty())
      table.error_at_name("type", fmt::format("the profile does not close: {} (docs/cutters.md)", fault), "tool-shape");
  }
}

void read_teeth(TomlTable& table, Tool& tool) {
  const auto degrees =
      table.numbers("pitch_deg", static_cast<std::size_t>(tool.flutes), kPitchDeg,
                    fmt::format("an angle for each of the {} flutes, as in [118, 122, 120],", tool.flutes));
  if (!degrees) return;
  constexpr double kSum_deg = 0.01;
  double sum = 0;
  for (const double d : *degrees) sum += d;
  if (std::abs(sum - 360) > kSum_deg)
    table.error_at("pitch_deg", fmt::format("pitch_deg add up to {}; 360 was expected", sum), "tool-shape");
  for (const double d : *degrees) tool.pitch_rad.push_back(rad_from_deg(d) * 360 / sum);
}

void read_neck(TomlTable& table, Tool& tool) {
  tool.neck_diameter_mm = table.number("neck_diameter_mm", kPositive, 0);
  tool.neck_length_mm = table.number("neck_length_mm", kPositive, 0);
  const bool diameter = table.has("neck_diameter_mm"), length = table.has("neck_length_mm");
  if (diameter && !length) table.missing("neck_length_mm", "the neck's length above the flutes");
  if (length && !diameter) table.missing("neck_diameter_mm", "the neck's diameter");
  if (!length) return;
  if (!table.has("flute_length_mm"))
    table.missing("flute_length_mm", "the length of the flutes, where the neck begins,");
  else if (tool.flute_length_mm && tool.overhang_mm > 0 &&
           *tool.flute_length_mm + tool.neck_length_mm > tool.overhang_mm)
    table.error_at("neck_length_mm",
                   fmt::format("flutes and neck are {} long; at most the overhang, {}, was expected",
                               *tool.flute_length_mm + tool.neck_length_mm, tool.overhang_mm),
                   "tool-shape");
}

void read_holder(TomlTable& table, Tool& tool) {
  const auto rows = table.number_rows("holder_mm", 0, 3, kPositive,
                                      "rows of lower diameter, upper diameter, length from the holder's face up, as in "
                                      "[[32, 32, 20], [32, 50, 15]],");
  for (const auto& row : rows.value_or(std::vector<std::vector<double>>{}))
    tool.holder.push_back({row[0], row[1], row[2]});
}

bool has_typical_flutes(const Tool& tool) {
  return tool.type == ToolType::ball || tool.type == ToolType::flat || tool.type == ToolType::bull;
}

/// Fills in what nobody gave and every tool has: typical values (docs/measured-parts.md). A rigid clamp is never true;
/// a cutter has flutes along about three diameters, above which it is a shank.
void take_typical_values(const TomlTable& table, Tool& tool) {
  constexpr double kRoot_N_per_mm = 20000, kFluteDiameters = 3;
  if (!table.has("root_stiffness_N_per_um")) {
    tool.root_stiffness_N_per_mm = kRoot_N_per_mm;
    tool.typical.emplace_back("root_stiffness_N_per_um = 20");
  }
  const double flutes = kFluteDiameters * tool.diameter_mm;
  if (!has_typical_flutes(tool) || tool.flute_length_mm || tool.overhang_mm <= flutes) return;
  tool.typical_flute_mm = flutes;
  tool.typical.push_back(fmt::format("flute_length_mm = {:.6g}", flutes));
}

void read_lengths(TomlTable& table, Tool& tool) {
  tool.flute_length_mm = table.optional_number("flute_length_mm", kPositive);
  if (const auto stiffness = table.optional_number("axial_stiffness_N_per_um", kPositiveOrInf))
    tool.axial_stiffness_N_per_mm = N_per_mm_from_N_per_um(*stiffness);
  tool.density_kg_per_m3 = table.optional_number("density_kg_per_m3", kPositive);
  tool.shank_diameter_mm = table.number("shank_diameter_mm", kPositive, 0);
  tool.shear = table.boolean("shear", false);
  if (tool.flute_length_mm && tool.overhang_mm > 0 && *tool.flute_length_mm > tool.overhang_mm)
    table.error_at("flute_length_mm",
                   fmt::format("flute_length_mm is {}; at most the overhang, {}, was expected", *tool.flute_length_mm,
                               tool.overhang_mm),
                   "tool-shape");
  if (table.has("shank_diameter_mm") && !table.has("flute_length_mm") && !has_typical_flutes(tool))
    table.warning_at("shank_diameter_mm",
                     "shank_diameter_mm has no effect: without flute_length_mm the whole overhang is fluted",
                     "tool-shape");
}

void check_overhang(TomlTable& table, const Tool& tool) {
  const double least =
      tool.type == ToolType::ball || tool.type == ToolType::tapered_ball ? tool.diameter_mm / 2 : tool.corner_radius_mm;
  if (tool.overhang_mm > 0 && tool.overhang_mm <= least)
    table.error_at(
        "overhang_mm",
        fmt::format("overhang_mm is {}; more than the rounded end, {}, was expected", tool.overhang_mm, least),
        "tool-shape");
}

void warn_of_one_direction(TomlTable& table, const std::vector<Mode>& modes) {
  const auto along_x = [](const Mode& m) { return m.direction.x() != 0; };
  const auto count = std::ranges::count_if(modes, along_x), all = static_cast<std::ptrdiff_t>(modes.size());
  if (count > 0 && count < all) return;
  if (modes.empty()) return;
  table.warning_at("mode",
                   fmt::format("all modes are along {}, so that the tool counts as rigid along {}; modes of both "
                               "directions were expected (fit-modes --direction xy where it is alike in both)",
                               count > 0 ? "x" : "y", count > 0 ? "y" : "x"),
                   "mode-direction");
}

}  // namespace

Tool read_tool(TomlTable table, int number) {
  Tool tool;
  tool.number = number;
  table.text("name", "");  // for the people of the shop, and for `from`
  const auto type = table.required_choice("type", kToolTypeWords);
  for (const auto& k : kToolKeys)
    if ((k.key == "diameter_mm" || k.key == "overhang_mm") && !table.has(k.key)) table.missing(k.key, k.range.wanted());
  read_numbers<Tool>(table, kToolKeys, tool);
  tool.flutes = static_cast<int>(table.required_number("flutes", kFlutes));
  if (type) {
    tool.type = static_cast<ToolType>(*type);
    read_profile_numbers(table, tool, kToolTypeWords[*type]);
  }
  read_lengths(table, tool);
  read_neck(table, tool);
  read_holder(table, tool);
  if (tool.flutes > 0) read_teeth(table, tool);
  tool.modes = read_modes(table);
  if (!table.found_errors()) warn_of_one_direction(table, tool.modes);
  check_overhang(table, tool);
  take_typical_values(table, tool);
  table.ignore("assumed");  // assumptions.h
  if (type) check_profile(table, tool);
  table.finish();
  return tool;
}

std::vector<Mode> read_modes(TomlTable& owner) {
  std::vector<Mode> modes;
  for (TomlTable& table : owner.tables("mode")) {
    Mode mode;
    const auto direction = table.required_choice("direction", kDirectionWords);
    if (direction) mode.direction = *direction == 0 ? Vec2::UnitX() : Vec2::UnitY();
    for (const auto& k : kModeKeys)
      if (!table.has(k.key)) table.missing(k.key, k.range.wanted());
    read_numbers<Mode>(table, kModeKeys, mode);
    table.finish();
    modes.push_back(mode);
  }
  return modes;
}

std::string modes_text(const std::vector<Mode>& modes, std::string_view owner) {
  std::string out;
  for (const Mode& m : modes)
    out += fmt::format("\n[[{}.mode]]\n", owner) +
           toml_line("direction", kDirectionWords[m.direction.x() != 0 ? 0 : 1]) + toml_lines<Mode>(kModeKeys, m);
  return out;
}

}  // namespace camber::machine
