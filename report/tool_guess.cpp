#include "report/job_proposal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <fmt/format.h>

namespace camber::report {
namespace {

using machine::ToolProposal;
using machine::ToolType;

constexpr double kFaceMill_mm = 32;   // and wider
constexpr double kClearOfCut_mm = 5;  // of the holder above the blank
constexpr double kHelix_deg = 30, kVBit_deg = 90, kTaper_deg = 3;
constexpr double kSmallShank_mm = 6;  // DIN 6535: the smallest
constexpr double kReachDiameters = 6;

struct Row {
  double diameter_mm, length_mm;
};
/// DIN 6527 L less DIN 6535: from the end of the clamped shank to the tip.
constexpr std::array<Row, 7> kEndMills{{{6, 21}, {8, 27}, {10, 32}, {12, 38}, {16, 44}, {20, 54}, {25, 65}}};
/// DIN 6537 K less DIN 6535.
constexpr std::array<Row, 7> kDrills{{{3, 26}, {6, 30}, {8, 43}, {10, 49}, {12, 57}, {16, 67}, {20, 81}}};
/// ISO 6462, height of the cutter.
constexpr std::array<Row, 4> kFaceMills{{{63, 40}, {100, 50}, {200, 63}, {500, 70}}};
/// Flutes, DIN 6527 L.
constexpr std::array<Row, 6> kFlutes{{{1, 3}, {2, 6}, {3, 8}, {4, 11}, {5, 13}, {6, 13}}};
constexpr std::array kStandardDiameters_mm{1.0,  1.5,  2.0,  3.0,  4.0,  5.0,  6.0,  8.0,  10.0, 12.0, 14.0,
                                           16.0, 18.0, 20.0, 25.0, 32.0, 40.0, 50.0, 63.0, 80.0, 100.0};

/// The row of the next larger diameter; beyond the last in proportion.
double in_table(std::span<const Row> rows, double diameter_mm) {
  for (const Row& row : rows)
    if (diameter_mm <= row.diameter_mm * (1 + 1e-6)) return row.length_mm;
  return rows.back().length_mm * diameter_mm / rows.back().diameter_mm;
}

bool cuts_level(const nc::Move& m) {
  return m.kind == nc::MoveKind::linear && !m.reference && m.cycle == 0 &&
         std::abs(m.end_mm.z() - m.start_mm.z()) < 1e-3;
}

/// The usual distance between parallel passes that are joined by a short move across; 0: there are none.
double step_over_mm(const nc::Interpretation& moves, int tool) {
  constexpr double kLong_mm = 5, kAcross = 0.05;
  std::vector<double> steps;
  const nc::Move* pass = nullptr;
  const nc::Move* across = nullptr;
  for (const nc::Move& m : moves.moves) {
    if (!cuts_level(m) || moves.state_of(m).tool != tool) {
      pass = across = nullptr;
      continue;
    }
    const Vec3 v = m.end_mm - m.start_mm;
    const double length = v.norm();
    if (length < 1e-6) continue;
    if (!pass) {
      if (length > kLong_mm) pass = &m;
      continue;
    }
    const Vec3 along = (pass->end_mm - pass->start_mm).normalized();
    if (!across) {
      if (std::abs(along.dot(v)) < kAcross * length)
        across = &m;
      else
        pass = length > kLong_mm ? &m : nullptr;
      continue;
    }
    const double step = (across->end_mm - across->start_mm).norm();
    if (along.dot(v) < -(1 - kAcross) * length && length > 2 * step) steps.push_back(step);
    pass = length > kLong_mm ? &m : nullptr;
    across = nullptr;
  }
  if (steps.size() < 2) return 0;
  std::ranges::nth_element(steps, steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2));
  return steps[steps.size() / 2];
}

bool only_drills(const nc::Interpretation& moves, int tool) {
  bool cuts = false;
  for (const nc::Move& m : moves.moves) {
    if ((m.kind != nc::MoveKind::linear && m.kind != nc::MoveKind::arc) || m.reference) continue;
    if (moves.state_of(m).tool != tool) continue;
    if (m.cycle == 0) return false;
    cuts = true;
  }
  return cuts;
}

double standard_diameter_mm(double step_mm) {
  constexpr double kStepFraction = 0.75;
  if (step_mm <= 0) return kUsualDiameter_mm;
  const auto at =
      std::ranges::find_if(kStandardDiameters_mm, [&](double d) { return d >= step_mm / kStepFraction - 0.5; });
  return at == kStandardDiameters_mm.end() ? kStandardDiameters_mm.back() : *at;
}

int typical_flutes(const ToolProposal& tool) {
  if (tool.type == ToolType::drill || tool.type == ToolType::ball || tool.type == ToolType::tapered_ball) return 2;
  return *tool.diameter_mm >= kFaceMill_mm ? 5 : 4;
}

double typical_overhang_mm(const ToolProposal& tool) {
  const double diameter_mm = *tool.diameter_mm;
  if (tool.type == ToolType::drill) return in_table(kDrills, diameter_mm);
  return diameter_mm >= kFaceMill_mm ? in_table(kFaceMills, diameter_mm) : in_table(kEndMills, diameter_mm);
}

/// Fills in the sizes that the shape of the tool's type needs.
void fill_profile(ToolProposal& tool, std::vector<std::string>& assumed) {
  const auto take = [&](std::optional<double>& value, double guess, const char* key) {
    if (value) return;
    value = guess;
    assumed.emplace_back(key);
  };
  if (tool.type == ToolType::bull) take(tool.corner_radius_mm, *tool.diameter_mm / 10, "corner_radius_mm");
  if (tool.type == ToolType::tapered_ball) take(tool.taper_deg, kTaper_deg, "taper_deg");
  if (tool.type == ToolType::chamfer) take(tool.point_angle_deg, kVBit_deg, "point_angle_deg");
  if (tool.type == ToolType::bull && *tool.corner_radius_mm > *tool.diameter_mm / 2)
    tool.corner_radius_mm = *tool.diameter_mm / 2;
  if (tool.type == ToolType::chamfer && tool.tip_diameter_mm.value_or(0) >= *tool.diameter_mm)
    tool.tip_diameter_mm.reset();
}

/// A thin cutter on the smallest shank.
void fill_shank(ToolProposal& tool, double depth_mm, std::vector<std::string>& assumed) {
  const bool mill = tool.type == ToolType::ball || tool.type == ToolType::flat || tool.type == ToolType::bull;
  if (!mill || *tool.diameter_mm > kSmallShank_mm - 0.5 || tool.flute_length_mm) return;
  const double flutes_mm = std::ceil(std::max(in_table(kFlutes, *tool.diameter_mm), depth_mm + 1));
  if (flutes_mm + 2 > *tool.overhang_mm) return;
  tool.flute_length_mm = flutes_mm;
  assumed.emplace_back("flute_length_mm");
  if (tool.shank_diameter_mm) return;
  tool.shank_diameter_mm = kSmallShank_mm;
  assumed.emplace_back("shank_diameter_mm");
}

void fill_overhang(GuessedTool& out, double depth_mm) {
  ToolProposal& tool = out.tool;
  // Deeper in the part than a thin cutter can reach, holder or shank go in with it.
  const double reach_mm = std::min(depth_mm, kReachDiameters * *tool.diameter_mm);
  const double least_mm = std::ceil(std::max(reach_mm, tool.flute_length_mm.value_or(0)) + kClearOfCut_mm);
  out.overhang_from_source = tool.overhang_mm.has_value();
  if (tool.overhang_mm && *tool.overhang_mm > reach_mm && *tool.overhang_mm >= tool.flute_length_mm.value_or(0)) return;
  if (tool.overhang_mm && tool.doubt.empty())
    tool.doubt = fmt::format("it sticks out by {:g} mm in its source, and its flutes or the cut reach further up",
                             *tool.overhang_mm);
  out.overhang_from_source = false;
  tool.overhang_mm = std::max(typical_overhang_mm(tool), least_mm);
  out.assumed.emplace_back("overhang_mm");
}

}  // namespace

GuessedTool guess_tool(ToolProposal known, const nc::ToolUse& use, const nc::Interpretation& moves, double depth_mm,
                       std::optional<double> cutter_mm) {
  GuessedTool out;
  out.tool = std::move(known);
  ToolProposal& tool = out.tool;
  if (!tool.type) {
    tool.type = only_drills(moves, use.tool) ? ToolType::drill : ToolType::flat;
    out.assumed.emplace_back("type");
  }
  if (!tool.diameter_mm) {
    tool.diameter_mm =
        cutter_mm ? *cutter_mm : standard_diameter_mm(tool.type == ToolType::drill ? 0 : step_over_mm(moves, use.tool));
    out.assumed.emplace_back("diameter_mm");
  }
  fill_profile(tool, out.assumed);
  if (!tool.flutes) {
    tool.flutes = typical_flutes(tool);
    out.assumed.emplace_back("flutes");
  }
  out.helix_deg = *tool.diameter_mm >= kFaceMill_mm || tool.type == ToolType::chamfer ? 0 : kHelix_deg;
  out.assumed.emplace_back("helix_deg");
  fill_overhang(out, depth_mm);
  fill_shank(tool, depth_mm, out.assumed);
  return out;
}

}  // namespace camber::report
