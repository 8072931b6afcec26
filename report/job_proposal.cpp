#include "report/job_proposal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/numbers.h"
#include "machine/machine_presets.h"
#include "machine/material_presets.h"
#include "machine/program_comments.h"
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

constexpr double kRootStiffness_N_per_um = 20;
constexpr double kRadialRatio = 0.4;

std::string assumed_line(const std::vector<std::string>& keys) {
  return keys.empty() ? std::string()
                      : line(fmt::format("assumed = [\"{}\"]", fmt::join(keys, "\", \"")),
                             "results begin with these: take out what you have put in");
}

std::string number_line(const char* key, const std::optional<double>& value) {
  return value ? fmt::format("{} = {}\n", key, decimal(*value)) : std::string();
}

std::string profile_text(const ToolProposal& tool) {
  std::string out = number_line("diameter_mm", tool.diameter_mm);
  if (tool.type == ToolType::bull) out += number_line("corner_radius_mm", tool.corner_radius_mm);
  if (tool.type == ToolType::tapered_ball) out += number_line("taper_deg", tool.taper_deg);
  if (tool.type == ToolType::chamfer || tool.type == ToolType::drill)
    out += number_line("point_angle_deg", tool.point_angle_deg);
  if (tool.type == ToolType::chamfer) out += number_line("tip_diameter_mm", tool.tip_diameter_mm);
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
std::string tool_text(const nc::ToolUse& use, const ToolProposal& known, const JobProposal& proposal, double depth_mm) {
  const auto cutter = proposal.cutters_mm.find(use.tool);
  const bool by_cycles = cutter != proposal.cutters_mm.end();
  GuessedTool guessed =
      guess_tool(known, use, proposal.moves, depth_mm, by_cycles ? std::optional(cutter->second) : std::nullopt);
  const ToolProposal& tool = guessed.tool;
  const auto note = [&](const char* key, const char* text) {
    return std::ranges::find(guessed.assumed, key) != guessed.assumed.end() ? text : "";
  };
  std::string out = fmt::format("\n[tool.{}]\n", use.tool);
  out += fmt::format("# Line {}: {} cutting moves, {:.0f} mm; feed {} mm/min, spindle {} rpm.\n", use.line,
                     use.cutting_moves, use.cutting_length_mm, range_text(use.feed_mm_per_min, 1),
                     range_text(use.spindle_speed_rpm, 0));
  if (!tool.from.empty()) out += fmt::format("# {}: {}\n", plain(tool.from), plain(tool.what));
  if (!tool.doubt.empty()) out += fmt::format("# CHECK: {}.\n", plain(tool.doubt));
  out += line(fmt::format("type = \"{}\"", type_word(*tool.type)), note("type", "CHECK: no comment names the tool"));
  std::string profile = profile_text(tool);
  if (!*note("diameter_mm", "x")) {
    out += profile;
  } else {
    const std::size_t end = profile.find('\n');
    out += line(profile.substr(0, end), by_cycles
                                            ? "CHECK: no comment gives it; a usual one that fits the cycles"
                                            : "CHECK: no comment gives it; by the distance between passes, else 10") +
           profile.substr(end + 1);
  }
  out += line(fmt::format("flutes = {}", *tool.flutes), note("flutes", "typical: count them"));
  out += line(fmt::format("helix_deg = {}", decimal(guessed.helix_deg)), "typical: see the tool's data sheet");
  out += line(fmt::format("overhang_mm = {}", decimal(*tool.overhang_mm)),
              guessed.overhang_from_source ? "as the source has it; holder face to tip: measure it"
                                           : "typical: holder face to tip; bending grows with its cube: measure it");
  if (!*note("flute_length_mm", "x")) {
    out += machine::body_toml(tool);
  } else if (tool.flute_length_mm && *tool.flute_length_mm <= *tool.overhang_mm) {
    out += line(fmt::format("flute_length_mm = {}", decimal(*tool.flute_length_mm)),
                "typical: DIN 6527, or the depth of the cut");
    if (tool.shank_diameter_mm)
      out += line(fmt::format("shank_diameter_mm = {}", decimal(*tool.shank_diameter_mm)),
                  note("shank_diameter_mm", "typical"));
  }
  out += line("# effective_diameter_ratio = 0.8", "bending diameter of the fluted part / diameter");
  out += tool.youngs_modulus_GPa
             ? line(fmt::format("youngs_modulus_GPa = {}", decimal(*tool.youngs_modulus_GPa)), "by what it is made of")
             : line("# youngs_modulus_GPa = 600.0", "carbide; high-speed steel 210");
  out += line(fmt::format("root_stiffness_N_per_um = {}", decimal(kRootStiffness_N_per_um)),
              "typical of holder and spindle, lateral: measure it (docs/guide/measure-force.md)");
  guessed.assumed.emplace_back("root_stiffness_N_per_um");
  return out + assumed_line(guessed.assumed);
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

/// Returns the lines on what a pass before has left. allowance_mm: of a program that finishes alone; 0: an example.
std::string allowance_text(const StockProposal& stock, double allowance_mm) {
  if (allowance_mm == 0)
    return line("# allowance_mm = 0.2", "what the pass before has left, where it had the same path");
  return fmt::format(
             "# CHECK: this program finishes alone: in the whole blank {}.\n"
             "# So the blank is taken as roughed along the same path, this much short of it; take the key out where "
             "the\n"
             "# program does rough, or give the roughed part: mesh = \"roughed.stl\".\n",
             stock.finishes) +
         line(fmt::format("allowance_mm = {}", decimal(allowance_mm)), "typical: what roughing leaves for finishing");
}

std::string stock_text(const nc::Summary& summary, const std::optional<StockProposal>& stock, double allowance_mm) {
  if (!stock) return line("# box_mm =", "[[x, y, z], [x, y, z]]: corners of the blank; no move of the program cuts");
  std::string out = fmt::format("# Cutting moves of the tip: {} mm.\n", extents_text(summary.cutting));
  std::vector<std::string> assumed;
  if (stock->told.empty() || !stock->placed.empty()) assumed.emplace_back("box_mm");
  if (allowance_mm > 0) assumed.emplace_back("allowance_mm");
  if (!stock->told.empty())
    return out + fmt::format("# {}\n", plain(stock->told)) +
           (stock->placed.empty() ? "" : fmt::format("# Its place: {}.\n", stock->placed)) + box_text(stock->box) +
           (allowance_mm > 0 ? allowance_text(*stock, allowance_mm) : "") + assumed_line(assumed);
  out += fmt::format(
      "# The blank is not known: this box holds what the cutters sweep, 2 mm wider and 1 mm deeper.\n# Its top: {}.\n",
      stock->top);
  if (stock->trimmed) out += "# Sides are taken back from where rapids go down beside the part.\n";
  if (stock->in_the_way)
    out += "# CHECK: rapids run through it, as through every box of this program; give the blank's true shape.\n";
  return out + box_text(stock->box) + allowance_text(*stock, allowance_mm) + assumed_line(assumed);
}

/// Steel, or aluminium where a tool cuts faster than steel is cut.
std::string usual_material(const nc::Summary& summary, const ToolsByNumber& tools, std::string& why) {
  constexpr double kFasterThanSteel_m_per_min = 400;
  double fastest = 0;
  for (const auto& use : summary.tools) {
    const auto at = tools.find(use.tool);
    if (use.cutting_moves == 0 || use.spindle_speed_rpm.empty() || at == tools.end() || !at->second.diameter_mm)
      continue;
    fastest = std::max(fastest, kPi * *at->second.diameter_mm * use.spindle_speed_rpm.max / 1000);
  }
  if (fastest > kFasterThanSteel_m_per_min) {
    why = fmt::format("no file names it; a cutting speed of {:.0f} m/min", fastest);
    return "Al6082-T6";
  }
  why = "no file names it; the commonest";
  return "C45";
}

std::string material_text(const std::string& chosen, const nc::Summary& summary, const ToolsByNumber& tools) {
  std::string why;
  const std::string name = chosen.empty() ? usual_material(summary, tools, why) : chosen;
  const machine::MaterialMatch match = machine::find_material(name);
  const machine::MaterialPreset& preset = *match.preset;
  std::string out =
      "\n[material]\n# Measured on your tool: file = \"material.toml\" (camber fit-force). Other names: "
      "docs/materials.md.\n";
  if (!why.empty()) out += fmt::format("# CHECK: {}. Or camber init --material NAME.\n", why);
  if (!match.note.empty()) out += fmt::format("# CHECK: {}.\n", plain(match.note));
  out += line(fmt::format("preset = {}", quoted(name)),
              fmt::format("{}; within {:g} %", preset.what, preset.scatter_percent));
  std::vector<std::string> assumed;
  if (chosen.empty()) assumed.emplace_back("preset");
  if (!preset.radial_known) {
    out += line(fmt::format("krc_ratio = {}", kRadialRatio), "typical: radial over tangential force, 0.3 to 0.6");
    assumed.emplace_back("krc_ratio");
  }
  return out + assumed_line(assumed);
}

bool turns_the_tool(const JobProposal& proposal) {
  return proposal.summary.rotary > 0 || proposal.summary.tilted_frame > 0;
}

/// A class of machines that can run the program.
std::string usual_machine(const JobProposal& proposal) {
  static const std::regex kRouter(
      R"(VECTRIC|WINCNC|CAMASTER|GRBL|SHAPEOKO|CARBIDE|STOCKMIN|X-?CARVE|ONEFINITY|MACH ?[23]|EASEL|ESTLCAM|OPENBUILDS|LONGMILL)",
      std::regex::icase);
  double rpm = 0, feed_mm_per_min = 0;
  for (const auto& use : proposal.summary.tools) {
    if (!use.spindle_speed_rpm.empty()) rpm = std::max(rpm, use.spindle_speed_rpm.max);
    if (!use.feed_mm_per_min.empty()) feed_mm_per_min = std::max(feed_mm_per_min, use.feed_mm_per_min.max);
  }
  constexpr double kRouter_rpm = 30000, kRouter_mm_per_min = 5000, kVmc_rpm = 12000, kVmc_mm_per_min = 18000,
                   kLinear_rpm = 20000, kOfControl_rpm = 18000;
  const auto comments = machine::commented_lines(proposal.text.source);
  const bool router =
      std::ranges::any_of(comments, [&](const auto& c) { return std::regex_search(c.comment, kRouter); });
  if (router && rpm <= kRouter_rpm && feed_mm_per_min <= kRouter_mm_per_min) return "router";
  if (rpm <= kOfControl_rpm && proposal.text.language != nc::LanguageId::iso)
    return proposal.text.language == nc::LanguageId::heidenhain ? "tnc-640" : "sinumerik-840d";
  if (rpm <= kVmc_rpm && feed_mm_per_min <= kVmc_mm_per_min) return "vmc-40";
  return rpm <= kLinear_rpm ? "vmc-linear" : "hsc-die-mould";
}

std::string machine_text(const JobProposal& proposal) {
  const std::string name =
      proposal.machine.empty() ? std::string(machine::kPresetPrefix) + usual_machine(proposal) : proposal.machine;
  const std::string setting = fmt::format("machine = {}", quoted(name));
  return machine::is_preset(name) ? line(setting, "typical values of a class; yours: docs/guide/machine-file.md")
                                  : setting + "\n";
}

/// The finest voxel of the list whose fields stay small for this blank.
double usual_voxel_mm(const std::optional<StockProposal>& stock) {
  constexpr std::array kVoxels_mm{0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.8, 1.0};
  constexpr double kBytes = 1.5e9, kBandVoxels = 3;
  double voxel = kVoxels_mm.front();
  if (stock)
    for (std::size_t i = 0; i < kVoxels_mm.size(); ++i) {
      voxel = kVoxels_mm[i];
      if (simulate::field_bytes(stock->box.max_mm - stock->box.min_mm, voxel, kBandVoxels) <= kBytes) break;
    }
  return voxel;
}

/// Two voxels at least, so that the field can tell it.
double allowance_mm(const std::optional<StockProposal>& stock) {
  return stock && stock->allowance_mm > 0 ? std::max(stock->allowance_mm, 2 * usual_voxel_mm(stock)) : 0;
}

std::string simulation_text(const std::optional<StockProposal>& stock, bool turned) {
  const double voxel = usual_voxel_mm(stock);
  std::string out = "\n[simulation]\n" + line(fmt::format("voxel_mm = {}", decimal(voxel)),
                                              "by the blank's size; for finishing half the allowance or less");
  if (stock && (turned || stock->in_the_way || stock->told.empty()))
    out += line("collisions = \"warning\"", turned                ? "until the machine and the blank are yours"
                                            : stock->told.empty() ? "until the blank is right"
                                                                  : "rapids run through the blank");
  return out;
}

}  // namespace

std::string job_text(const JobProposal& proposal) {
  std::string out = fmt::format(
      "# A job for camber, begun by camber init. It runs as it stands: what no file says is an assumption, marked\n"
      "# \"typical\" or CHECK and listed in \"assumed\". A \"# key = value\" is the default.\n"
      "program = {}\n",
      quoted(proposal.program));
  if (proposal.inch) out += line(fmt::format("units = \"{}\"", *proposal.inch ? "inch" : "mm"), "of the program");
  out += machine_text(proposal);
  ToolsByNumber by_number;
  for (const auto& tool : proposal.tools)
    if (tool.number) by_number.emplace(*tool.number, tool);
  mill_with_drills(proposal.moves, by_number);
  const std::optional<StockProposal> stock = propose_stock(proposal.text, proposal.moves, by_number);
  std::string cutting, tools;
  for (const auto& use : proposal.summary.tools) {
    if (use.cutting_moves == 0) continue;
    const double top = stock ? stock->box.max_mm.z() : use.cutting.max_mm.z();
    tools += tool_text(use, by_number[use.tool], proposal, std::max(0.0, top - use.cutting.min_mm.z()));
    cutting += (cutting.empty() ? "" : ", ") + std::to_string(use.tool);
  }
  out += line(fmt::format("# operations = {{ tools = [{}] }}", cutting), "only these are simulated and compensated");
  out += tools + material_text(proposal.material, proposal.summary, by_number) + "\n[stock]\n" +
         stock_text(proposal.summary, stock, turns_the_tool(proposal) ? 0 : allowance_mm(stock));
  out += simulation_text(stock, turns_the_tool(proposal)) + "\n[compensation]\n";
  out += line("tolerance_um = 5.0", "95 % of the surface; or profile_um = [-5, 10], the band that the drawing gives");
  return out + "max_shift_mm = 0.1\n";
}

}  // namespace camber::report
