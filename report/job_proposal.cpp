#include "report/job_proposal.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "base/numbers.h"
#include "machine/material_presets.h"

namespace camber::report {
namespace {

using machine::ToolProposal;
using machine::ToolType;

constexpr std::size_t kColumn = 34;  // where comments begin

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) out += c;
  }
  return out + "\"";
}

/// A comment's text: one line, no control characters, no broken UTF-8.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (static_cast<unsigned char>(c) >= 0x20 && static_cast<unsigned char>(c) < 0x7f) out += c;
  const auto from = out.find_first_not_of(" |-");
  return from == std::string::npos ? std::string() : out.substr(from);
}

std::string line(const std::string& setting, const std::string& comment) {
  if (comment.empty()) return setting + "\n";
  const std::size_t pad = setting.size() < kColumn ? kColumn - setting.size() : 1;
  return setting + std::string(pad, ' ') + "# " + comment + "\n";
}

std::string range_text(const nc::Range& range, int decimals) {
  if (range.empty()) return "-";
  const std::string low = format_trimmed(range.min, decimals), high = format_trimmed(range.max, decimals);
  return low == high ? low : low + " to " + high;
}

std::string decimal(double value) {
  const std::string text = format_trimmed(value, 4);
  return text.find('.') == std::string::npos ? text + ".0" : text;
}

const char* type_word(ToolType type) {
  switch (type) {
    case ToolType::ball:
      return "ball";
    case ToolType::flat:
      return "flat";
    case ToolType::bull:
      return "bull";
    case ToolType::drill:
      return "drill";
    case ToolType::tapered_ball:
      return "tapered_ball";
    case ToolType::chamfer:
      return "chamfer";
    case ToolType::general:
      break;
  }
  return "general";
}

/// A number where it is known, else the key in a comment.
std::string number_line(const char* key, const std::optional<double>& value, const std::string& what) {
  return value ? line(fmt::format("{} = {}", key, decimal(*value)), "") : line(fmt::format("# {} =", key), what);
}

std::string tool_text(const nc::ToolUse& use, const ToolProposal& tool) {
  std::string out = fmt::format("\n[tool.{}]\n", use.tool);
  out += fmt::format("# Line {}: {} cutting moves, {:.0f} mm; feed {} mm/min, spindle {} rpm.\n", use.line,
                     use.cutting_moves, use.cutting_length_mm, range_text(use.feed_mm_per_min, 1),
                     range_text(use.spindle_speed_rpm, 0));
  if (!tool.from.empty()) out += fmt::format("# {}: {}\n", plain(tool.from), plain(tool.what));
  if (!tool.doubt.empty()) out += fmt::format("# CHECK: {}.\n", plain(tool.doubt));
  out += tool.type ? line(fmt::format("type = \"{}\"", type_word(*tool.type)), "")
                   : line("# type =", "\"ball\", \"flat\", \"bull\" ... (docs/cutters.md)");
  out += number_line("diameter_mm", tool.diameter_mm, "");
  if (tool.type == ToolType::bull) out += number_line("corner_radius_mm", tool.corner_radius_mm, "");
  out += tool.flutes ? fmt::format("flutes = {}\n", *tool.flutes) : line("# flutes =", "");
  out += line("# helix_deg = 0.0", "");
  out += tool.overhang_mm ? line(fmt::format("overhang_mm = {}", decimal(*tool.overhang_mm)),
                                 "the library's body length; holder face to tip: measure it")
                          : line("# overhang_mm =", "holder face to tip: measure it");
  if (tool.flute_length_mm) out += fmt::format("flute_length_mm = {}\n", decimal(*tool.flute_length_mm));
  if (tool.shank_diameter_mm) out += fmt::format("shank_diameter_mm = {}\n", decimal(*tool.shank_diameter_mm));
  out += line("# effective_diameter_ratio = 0.8", "bending diameter of the fluted part / diameter");
  out += tool.youngs_modulus_GPa
             ? line(fmt::format("youngs_modulus_GPa = {}", decimal(*tool.youngs_modulus_GPa)), "by what it is made of")
             : line("# youngs_modulus_GPa = 600.0", "carbide; high-speed steel 210");
  return out + line("# root_stiffness_N_per_um = inf", "holder and spindle: measure it");
}

std::string extents_text(const nc::Extents& e) {
  std::string out;
  for (int a = 0; a < 3; ++a)
    out += fmt::format("{}{} {} to {}", a > 0 ? ", " : "", "XYZ"[a], decimal(e.min_mm[a]), decimal(e.max_mm[a]));
  return out;
}

/// The box of the cutting moves, wider by the largest known radius and a millimetre deeper.
std::string stock_text(const nc::Summary& summary, double radius_mm) {
  if (summary.cutting.empty()) return line("# box_mm =", "[[x, y, z], [x, y, z]]: corners of the blank");
  const Vec3 low = summary.cutting.min_mm - Vec3(radius_mm, radius_mm, 1),
             high = summary.cutting.max_mm + Vec3(radius_mm, radius_mm, 0);
  const auto corner = [](const Vec3& p) {
    return fmt::format("[{}, {}, {}]", decimal(std::round(10 * p.x()) / 10), decimal(std::round(10 * p.y()) / 10),
                       decimal(std::round(10 * p.z()) / 10));
  };
  return fmt::format("# Cutting moves of the tip: {} mm.\n# box_mm = [{}, {}]\n", extents_text(summary.cutting),
                     corner(low), corner(high)) +
         line("# allowance_mm = 0.2", "what the pass before has left, where it had the same path");
}

std::string material_text() {
  std::string names;
  for (const auto& preset : machine::material_presets())
    names += (names.empty() ? "" : ", ") + std::string(preset.name);
  return "\n[material]\n# Measured on your tool: file = \"material.toml\" (camber fit-force). Or a preset to begin "
         "with:\n# " +
         names +
         ".\n# preset =\n# krc_ratio =                      # radial / tangential force, for presets that give the "
         "tangential one only\n";
}

}  // namespace

std::string job_text(const JobProposal& proposal) {
  std::string out = fmt::format(
      "# A job for camber, begun by camber init. What nobody has said yet stands as \"# key =\": fill it in.\n# A \"# "
      "key = value\" is the default.\n"
      "program = {}\n",
      quoted(proposal.program));
  out += proposal.machine.empty() ? line("# machine =", "\"machine.toml\": camber protocol and fit-feed measure one")
                                  : fmt::format("machine = {}\n", quoted(proposal.machine));
  std::string cutting;
  double radius_mm = 0;
  std::string tools;
  for (const auto& use : proposal.summary.tools) {
    if (use.cutting_moves == 0) continue;
    const auto found =
        std::find_if(proposal.tools.begin(), proposal.tools.end(), [&](const auto& t) { return t.number == use.tool; });
    const ToolProposal tool = found == proposal.tools.end() ? ToolProposal{} : *found;
    tools += tool_text(use, tool);
    cutting += (cutting.empty() ? "" : ", ") + std::to_string(use.tool);
    radius_mm = std::max(radius_mm, tool.diameter_mm.value_or(0) / 2);
  }
  out += line(fmt::format("# operations = {{ tools = [{}] }}", cutting), "only these are simulated and compensated");
  out += tools + material_text() + "\n[stock]\n" + stock_text(proposal.summary, radius_mm);
  out += "\n[simulation]\nvoxel_mm = 0.1\n\n[compensation]\n";
  out += line("tolerance_um = 5.0", "95 % of the surface; or profile_um = [-5, 10], the band that the drawing gives");
  return out + "max_shift_mm = 0.1\n";
}

}  // namespace camber::report
