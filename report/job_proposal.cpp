#include "report/job_proposal.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/numbers.h"
#include "machine/material_presets.h"
#include "report/stock_proposal.h"
#include "simulate/memory.h"

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

constexpr double kFaceMill_mm = 32;       // and wider
constexpr double kOverhangDiameters = 4;  // typical
constexpr double kClearOfCut_mm = 5;      // of the holder above the blank
constexpr double kRootStiffness_N_per_um = 20, kHelix_deg = 30;
constexpr double kRadialRatio = 0.4;

int typical_flutes(const ToolProposal& tool) {
  if (tool.type == ToolType::drill || tool.type == ToolType::ball) return 2;
  return tool.diameter_mm.value_or(0) >= kFaceMill_mm ? 5 : 4;
}

double typical_helix_deg(const ToolProposal& tool) {
  const bool face_mill = tool.diameter_mm.value_or(0) >= kFaceMill_mm;
  return face_mill || tool.type == ToolType::chamfer ? 0 : kHelix_deg;
}

/// Long enough for the flutes and for the deepest cut below the blank's top.
double typical_overhang_mm(const ToolProposal& tool, double depth_mm) {
  const double least = std::max(depth_mm, tool.flute_length_mm.value_or(0)) + kClearOfCut_mm;
  return std::ceil(std::max(kOverhangDiameters * tool.diameter_mm.value_or(0), least));
}

std::string profile_text(const ToolProposal& tool) {
  std::string out = number_line("diameter_mm", tool.diameter_mm, "");
  if (tool.type == ToolType::bull) out += number_line("corner_radius_mm", tool.corner_radius_mm, "");
  if (tool.type == ToolType::tapered_ball)
    out += number_line("taper_deg", tool.taper_deg, "between the wall and the axis");
  if (tool.type == ToolType::chamfer && tool.tip_diameter_mm)
    out += fmt::format("tip_diameter_mm = {}\n", decimal(*tool.tip_diameter_mm));
  if (tool.point_angle_deg)
    out += fmt::format("point_angle_deg = {}\n", decimal(*tool.point_angle_deg));
  else if (tool.type == ToolType::chamfer)
    out += line("point_angle_deg = 90.0", "typical: between opposite sides of the cone");
  return out;
}

/// Drills that the program mills with are spotting or engraving tools.
void mill_with_drills(const nc::Interpretation& moves, ToolsByNumber& tools) {
  for (const nc::Move& m : moves.moves) {
    const bool along = m.kind == nc::MoveKind::arc || (m.end_mm - m.start_mm).head<2>().norm() > 0;
    if ((m.kind != nc::MoveKind::linear && m.kind != nc::MoveKind::arc) || m.reference || m.cycle != 0 || !along)
      continue;
    const auto tool = tools.find(moves.state_of(m).tool);
    if (tool == tools.end() || tool->second.type != ToolType::drill) continue;
    tool->second.type = ToolType::chamfer;
    tool->second.doubt = fmt::format("the program mills with this drill from line {} on", m.block + 1);
  }
}

/// depth_mm: of the tool's lowest cut below the blank's top.
std::string tool_text(const nc::ToolUse& use, const ToolProposal& tool, double depth_mm) {
  std::string out = fmt::format("\n[tool.{}]\n", use.tool);
  out += fmt::format("# Line {}: {} cutting moves, {:.0f} mm; feed {} mm/min, spindle {} rpm.\n", use.line,
                     use.cutting_moves, use.cutting_length_mm, range_text(use.feed_mm_per_min, 1),
                     range_text(use.spindle_speed_rpm, 0));
  if (!tool.from.empty()) out += fmt::format("# {}: {}\n", plain(tool.from), plain(tool.what));
  if (!tool.doubt.empty()) out += fmt::format("# CHECK: {}.\n", plain(tool.doubt));
  out += tool.type ? line(fmt::format("type = \"{}\"", type_word(*tool.type)), "")
                   : line("# type =", "\"ball\", \"flat\", \"bull\" ... (docs/cutters.md)");
  out += profile_text(tool);
  out += tool.flutes ? fmt::format("flutes = {}\n", *tool.flutes)
                     : line(fmt::format("flutes = {}", typical_flutes(tool)), "typical: count them");
  out += line(fmt::format("helix_deg = {}", decimal(typical_helix_deg(tool))), "typical: see the tool's data sheet");
  out += tool.overhang_mm ? line(fmt::format("overhang_mm = {}", decimal(*tool.overhang_mm)),
                                 "the library's body length; holder face to tip: measure it")
                          : line(fmt::format("overhang_mm = {}", decimal(typical_overhang_mm(tool, depth_mm))),
                                 "typical: holder face to tip; bending grows with its cube: measure it");
  out += machine::body_toml(tool);
  out += line("# effective_diameter_ratio = 0.8", "bending diameter of the fluted part / diameter");
  out += tool.youngs_modulus_GPa
             ? line(fmt::format("youngs_modulus_GPa = {}", decimal(*tool.youngs_modulus_GPa)), "by what it is made of")
             : line("# youngs_modulus_GPa = 600.0", "carbide; high-speed steel 210");
  return out + line(fmt::format("root_stiffness_N_per_um = {}", decimal(kRootStiffness_N_per_um)),
                    "typical of holder and spindle, lateral: measure it (docs/guide/measure-force.md)");
}

std::string extents_text(const nc::Extents& e) {
  std::string out;
  for (int a = 0; a < 3; ++a)
    out += fmt::format("{}{} {} to {}", a > 0 ? ", " : "", "XYZ"[a], decimal(e.min_mm[a]), decimal(e.max_mm[a]));
  return out;
}

std::string box_text(const machine::Box& box) {
  const auto corner = [](const Vec3& p) {
    return fmt::format("[{}, {}, {}]", decimal(p.x()), decimal(p.y()), decimal(p.z()));
  };
  return fmt::format("box_mm = [{}, {}]\n", corner(box.min_mm), corner(box.max_mm));
}

std::string stock_text(const nc::Summary& summary, const std::optional<StockProposal>& stock) {
  if (!stock) return line("# box_mm =", "[[x, y, z], [x, y, z]]: corners of the blank");
  std::string out = fmt::format(
      "# Cutting moves of the tip: {} mm.\n# The blank is not known: this box holds what the cutters sweep, 2 mm wider "
      "and 1 mm deeper.\n# Its top: {}.\n",
      extents_text(summary.cutting), stock->top);
  if (stock->trimmed) out += "# Sides are taken back from where rapids go down beside the part.\n";
  if (stock->in_the_way)
    out += "# CHECK: rapids run through it, as through every box of this program; give the blank's true shape.\n";
  return out + box_text(stock->box) +
         line("# allowance_mm = 0.2", "what the pass before has left, where it had the same path");
}

std::string material_text(const std::string& chosen) {
  std::string full, tangential;
  for (const auto& preset : machine::material_presets()) {
    std::string& names = preset.radial_known ? full : tangential;
    names += (names.empty() ? "" : ", ") + std::string(preset.name);
  }
  std::string out = fmt::format(
      "\n[material]\n# Measured on your tool: file = \"material.toml\" (camber fit-force). Or a preset to begin with:\n"
      "# {};\n# of the tangential force alone, so with krc_ratio: {}.\n",
      full, tangential);
  const machine::MaterialPreset* preset = machine::find_preset(chosen);
  out += preset ? line(fmt::format("preset = \"{}\"", preset->name), std::string(preset->what)) : "# preset =\n";
  const bool active = preset && !preset->radial_known;
  return out + line(fmt::format("{}krc_ratio = {}", active ? "" : "# ", kRadialRatio),
                    "typical: radial over tangential force, 0.3 to 0.6");
}

/// The finest voxel of the list whose fields stay small for this blank.
std::string simulation_text(const std::optional<StockProposal>& stock) {
  constexpr std::array kVoxels_mm{0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.8, 1.0};
  constexpr double kBytes = 1.5e9, kBandVoxels = 3;
  double voxel = kVoxels_mm.front();
  if (stock)
    for (std::size_t i = 0; i < kVoxels_mm.size(); ++i) {
      voxel = kVoxels_mm[i];
      if (simulate::field_bytes(stock->box.max_mm - stock->box.min_mm, voxel, kBandVoxels) <= kBytes) break;
    }
  std::string out = "\n[simulation]\n" + line(fmt::format("voxel_mm = {}", decimal(voxel)),
                                              "by the blank's size; for finishing half the allowance or less");
  if (stock && stock->in_the_way) out += line("collisions = \"warning\"", "until the blank is right");
  return out;
}

}  // namespace

std::string job_text(const JobProposal& proposal) {
  std::string out = fmt::format(
      "# A job for camber, begun by camber init. What stands as \"# key =\" is not known: fill it in. What is marked\n"
      "# \"typical\" is an assumption: put in your own value. A \"# key = value\" is the default.\n"
      "program = {}\n",
      quoted(proposal.program));
  if (proposal.inch) out += line(fmt::format("units = \"{}\"", *proposal.inch ? "inch" : "mm"), "of the program");
  out += proposal.machine.empty() ? line("# machine =", "\"machine.toml\": camber protocol and fit-feed measure one")
                                  : fmt::format("machine = {}\n", quoted(proposal.machine));
  ToolsByNumber by_number;
  for (const auto& tool : proposal.tools)
    if (tool.number) by_number.emplace(*tool.number, tool);
  mill_with_drills(proposal.moves, by_number);
  const std::optional<StockProposal> stock = propose_stock(proposal.text, proposal.moves, by_number);
  std::string cutting, tools;
  for (const auto& use : proposal.summary.tools) {
    if (use.cutting_moves == 0) continue;
    const double top = stock ? stock->box.max_mm.z() : use.cutting.max_mm.z();
    tools += tool_text(use, by_number[use.tool], top - use.cutting.min_mm.z());
    cutting += (cutting.empty() ? "" : ", ") + std::to_string(use.tool);
  }
  out += line(fmt::format("# operations = {{ tools = [{}] }}", cutting), "only these are simulated and compensated");
  out += tools + material_text(proposal.preset) + "\n[stock]\n" + stock_text(proposal.summary, stock);
  out += simulation_text(stock) + "\n[compensation]\n";
  out += line("tolerance_um = 5.0", "95 % of the surface; or profile_um = [-5, 10], the band that the drawing gives");
  return out + "max_shift_mm = 0.1\n";
}

}  // namespace camber::report
