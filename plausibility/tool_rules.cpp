#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "checks/setup_checks.h"
#include "machine/job_keys.h"
#include "plausibility/rules.h"

namespace camber::plausibility {
namespace {

constexpr double kRigidFrom_GPa = 1e8, kRigidTo_GPa = 1e10;

using machine::Tool;
using machine::ToolProposal;
using machine::ToolType;

std::string_view word(ToolType type) { return machine::kToolTypeWords[static_cast<std::size_t>(type)]; }

/// Drills that mill are spotting or engraving tools; every profile may be written as "general".
bool same_kind(ToolType job, ToolType comment) {
  const auto kind = [](ToolType t) {
    if (t == ToolType::tapered_ball) return ToolType::ball;
    return t == ToolType::chamfer ? ToolType::drill : t;
  };
  return job == ToolType::general || kind(job) == kind(comment);
}

bool near(double a, double b, double fraction) { return std::abs(a - b) <= fraction * std::max(a, b); }

/// Names the mistake that usually makes the factor between two lengths.
std::string factor_hint(double job, double comment) {
  constexpr double kNear = 0.04;
  if (near(job * kMmPerInch, comment, kNear)) return " (is it in inches?)";
  if (near(job, comment * kMmPerInch, kNear)) return " (an inch too often?)";
  if (near(2 * job, comment, kNear)) return " (a radius?)";
  if (near(job, 2 * comment, kNear)) return " (twice?)";
  return {};
}

/// Another tool of the comments that this one is.
std::string other_tool_hint(const Evidence& e, const Tool& tool) {
  constexpr double kNear = 0.02;
  for (const ToolProposal& other : e.said)
    if (other.number && *other.number != tool.number && other.type && same_kind(tool.type, *other.type) &&
        other.diameter_mm && near(*other.diameter_mm, tool.diameter_mm, kNear))
      return fmt::format("; it is like T{} there", *other.number);
  return {};
}

struct Contradiction {
  Severity severity = Severity::warning;
  std::string job, comment;  ///< "diameter_mm = 3.2", "3.175 mm"
};

/// The gravest one.
std::optional<Contradiction> contradiction(const Tool& tool, const ToolProposal& said) {
  constexpr double kOther = 0.08, kRounded = 0.02, kCorner = 0.2;
  const Severity grave = said.doubt.empty() ? Severity::error : Severity::warning;
  if (said.type && !same_kind(tool.type, *said.type)) {
    // A corner of a few hundredths is often left out.
    const bool small_corner = (tool.type == ToolType::flat && *said.type == ToolType::bull) ||
                              (tool.type == ToolType::bull && *said.type == ToolType::flat);
    const double corner = tool.type == ToolType::bull ? tool.corner_radius_mm : said.corner_radius_mm.value_or(0);
    const bool spotting = *said.type == ToolType::drill || *said.type == ToolType::chamfer;
    if (!small_corner || corner > 0.05 * tool.diameter_mm)
      return Contradiction{spotting ? Severity::warning : grave, fmt::format("type = \"{}\"", word(tool.type)),
                           fmt::format("\"{}\"", word(*said.type))};
  }
  if (said.diameter_mm && !near(tool.diameter_mm, *said.diameter_mm, kRounded))
    return Contradiction{
        near(tool.diameter_mm, *said.diameter_mm, kOther) ? Severity::warning : grave,
        fmt::format("diameter_mm = {:g}", tool.diameter_mm),
        fmt::format("{:.4g} mm{}", *said.diameter_mm, factor_hint(tool.diameter_mm, *said.diameter_mm))};
  if (tool.type == ToolType::bull && said.corner_radius_mm &&
      !near(tool.corner_radius_mm, *said.corner_radius_mm, kCorner))
    return Contradiction{
        grave, fmt::format("corner_radius_mm = {:g}", tool.corner_radius_mm),
        fmt::format("{:.4g} mm{}", *said.corner_radius_mm, factor_hint(tool.corner_radius_mm, *said.corner_radius_mm))};
  if (said.flutes && *said.flutes != tool.flutes)
    return Contradiction{Severity::warning, fmt::format("flutes = {}", tool.flutes), fmt::format("{}", *said.flutes)};
  return std::nullopt;
}

std::string one_line(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (static_cast<unsigned char>(c) >= 0x20 && static_cast<unsigned char>(c) < 0x7f) out += c;
  const auto from = out.find_first_not_of(" |-"), to = out.find_last_not_of(" |-");
  return from == std::string::npos ? std::string() : out.substr(from, to - from + 1);
}

}  // namespace

void look_at_comments(const Evidence& e, Diagnostics& diagnostics) {
  for (const ToolWork& work : e.tools) {
    if (!work.said) continue;
    const auto found = contradiction(*work.tool, *work.said);
    if (!found) continue;
    diagnostics.add(e.at_job(found->severity,
                             fmt::format("T{}: {} in the job, but {} in the program's comment \"{}\" ({}){}; the "
                                         "tool of the program was expected",
                                         work.number, found->job, found->comment, one_line(work.said->what),
                                         work.said->from, other_tool_hint(e, *work.tool)),
                             "tool-comment"));
  }
}

void look_at_overhang(const Evidence& e, Diagnostics& diagnostics) {
  constexpr double kLongest_mm = 400;          // of any milling tool
  constexpr double kShortest = 1, kWide = 20;  // diameters; mm
  for (const ToolWork& work : e.tools) {
    if (!work.mills) continue;
    const Tool& tool = *work.tool;
    const double slender = checks::slenderness(tool);
    const auto say = [&](Severity severity, std::string why) {
      diagnostics.add(e.at_job(
          severity, fmt::format("T{}: overhang_mm = {:g} is {}", work.number, tool.overhang_mm, why), "tool-slender"));
    };
    if (tool.overhang_mm > kLongest_mm)
      say(Severity::error, fmt::format("longer than any milling tool; up to {:g} mm was expected", kLongest_mm));
    else if (slender > checks::kMaxSlenderness)
      say(Severity::error,
          fmt::format("{:.1f} times its diameter; no more than {:g} times was expected: a longer tool is "
                      "no static beam (diameter_mm and overhang_mm are in mm)",
                      slender, checks::kMaxSlenderness));
    else if (tool.diameter_mm <= kWide && tool.overhang_mm < kShortest * tool.diameter_mm)
      say(Severity::warning, fmt::format("less than its diameter, {:g} mm; at least that was expected (holder face to "
                                         "tip)",
                                         tool.diameter_mm));
  }
}

void look_at_proportions(const Evidence& e, Diagnostics& diagnostics) {
  struct Usual {
    const char* key;
    double value, least, greatest;
    const char* unit;
    bool given;
  };
  for (const ToolWork& work : e.tools) {
    const Tool& t = *work.tool;
    const double d = t.diameter_mm;
    const auto odd = [&](Severity severity, const Usual& u) {
      if (!u.given || !std::isfinite(u.value) || (u.value >= u.least && u.value <= u.greatest)) return;
      diagnostics.add(
          e.at_job(severity,
                   fmt::format("T{}: {} = {:g} is not that of a milling cutter of {:g} mm; {:g} to {:g}{} was expected",
                               work.number, u.key, u.value, d, u.least, u.greatest, u.unit),
                   "tool-proportions"));
    };
    if (d < 0.1 || d > 250)
      diagnostics.add(e.at_job(Severity::error,
                               fmt::format("T{}: diameter_mm = {:g} is not that of a milling cutter; 0.1 to 250 mm was "
                                           "expected (is it in inches?)",
                                           work.number, d),
                               "tool-proportions"));
    odd(Severity::warning,
        {"flutes", static_cast<double>(t.flutes), 1, std::floor(std::max(6.0, 4 + 0.6 * d)), "", true});
    // 1e8 GPa and more is written to make a tool rigid; MPa and Pa by mistake lie outside.
    const double modulus_GPa = t.youngs_modulus_MPa / 1000;
    odd(Severity::error,
        {"youngs_modulus_GPa", modulus_GPa, 50, 1200, "", modulus_GPa < kRigidFrom_GPa || modulus_GPa > kRigidTo_GPa});
    odd(Severity::warning, {"root_stiffness_N_per_um", t.root_stiffness_N_per_mm / 1000, 0.5, 1000, " (or inf)", true});
    odd(Severity::warning, {"flute_length_mm", t.flute_length_mm.value_or(d), 0.1 * d, std::max(12 * d, 10.0), "",
                            t.flute_length_mm.has_value()});
    odd(Severity::warning,
        {"shank_diameter_mm", t.shank_diameter_mm, 0.3 * d, std::max(3 * d, 12.0), "", t.shank_diameter_mm > 0});
    odd(Severity::warning, {"runout_um", 1000 * t.runout_mm, 0, std::max(50.0, 20 * d), "", true});
    odd(Severity::warning, {"effective_diameter_ratio", t.effective_diameter_ratio, 0.4, 1, "", true});
  }
}

namespace {

/// A cutter with a flat bottom on a path that rises and falls as over a curved surface.
void look_at_flat(const Evidence& e, const ToolWork& work, Diagnostics& diagnostics) {
  constexpr double kSloping = 0.5, kUpAndDown = 0.15;
  const double sloping = work.sloping_mm / work.milling_mm, rising = work.rising_mm / std::max(1e-9, work.sloping_mm);
  if (sloping < kSloping || rising < kUpAndDown || rising > 1 - kUpAndDown) return;
  diagnostics.add(e.at_move(
      Severity::warning, work.first_move,
      fmt::format("T{} is \"{}\" in the job, but {:.0f} % of its path rises and falls as over a curved surface; a ball "
                  "or bull end mill was expected",
                  work.number, word(work.tool->type), 100 * sloping),
      "tool-path"));
}

/// A ball on a path at few heights, deeper than its radius.
void look_at_ball(const Evidence& e, const ToolWork& work, Diagnostics& diagnostics) {
  constexpr double kLevel = 0.9, kDeep = 0.8;
  const double radius = work.tool->diameter_mm / 2, depth = work.depth_mm.median();
  if (work.depth_mm.empty() || work.level_mm < kLevel * work.milling_mm || depth < kDeep * radius) return;
  diagnostics.add(e.at_move(
      Severity::warning, work.first_move,
      fmt::format("T{} is \"ball\" in the job, but {:.0f} % of its path is level and cuts {:.2g} mm deep with a radius "
                  "of {:g} mm, as end mills with a flat bottom do; a ball end mill's path was expected",
                  work.number, 100 * work.level_mm / work.milling_mm, depth, radius),
      "tool-path"));
}

}  // namespace

void look_at_path_shape(const Evidence& e, Diagnostics& diagnostics) {
  for (const ToolWork& work : e.tools) {
    const Tool& tool = *work.tool;
    constexpr double kRounded = 0.2;         // corner over radius from which bull end mills follow surfaces
    const bool mills = work.milling_mm > 0;  // along a program's path
    const bool flat = tool.type == ToolType::flat ||
                      (tool.type == ToolType::bull && tool.corner_radius_mm < kRounded * tool.diameter_mm / 2);
    if (mills && flat) look_at_flat(e, work, diagnostics);
    if (mills && tool.type == ToolType::ball) look_at_ball(e, work, diagnostics);
  }
}

}  // namespace camber::plausibility
