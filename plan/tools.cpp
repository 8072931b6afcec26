#include "plan/tools.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace camber::plan {

std::vector<const PlanTool*> tools_for(const PlanTools& tools, ToolUse use) {
  std::vector<const PlanTool*> out;
  for (const auto& [number, tool] : tools)
    if (tool.use == use) out.push_back(&tool);
  std::ranges::stable_sort(out, std::greater{}, [](const PlanTool* t) { return t->tool.diameter_mm; });
  return out;
}

ToolUse use_for(Feature feature) {
  switch (feature) {
    case Feature::face:
    case Feature::step:
      return ToolUse::face_mill;
    case Feature::through_hole:
    case Feature::blind_hole:
      return ToolUse::drill;
    case Feature::free_form:
      return ToolUse::ball_end_mill;
    default:
      return ToolUse::end_mill;
  }
}

double largest_diameter_mm(Feature feature, double width_mm) {
  switch (feature) {
    case Feature::closed_pocket:
      return width_mm / 5;
    case Feature::closed_slot:
    case Feature::open_slot:
      return width_mm / 3;
    default:
      return machine::kNoLimit;
  }
}

namespace {

constexpr double kClearance_mm = 1.0;  // of the holder
constexpr double kEqual_mm = 1e-4;     // sizes of a mesh

double wall_of(const ToolNeed& need, double radius_mm) {
  return std::max(need.depth_mm, need.wall_mm ? need.wall_mm(radius_mm) : 0.0);
}

bool usable(const PlanTool& t, const ToolNeed& need) {
  if (t.use == ToolUse::end_mill && t.tool.corner_radius_mm > 0) return false;  // the floor's corners are sharp
  if (t.use == ToolUse::ball_end_mill && t.tool.diameter_mm / 2 > need.inner_radius_mm + kEqual_mm) return false;
  return reach_fault(t.tool, need).empty() && (!need.has_room || need.has_room(t.tool.diameter_mm / 2));
}

const PlanTool* first_usable(const std::vector<const PlanTool*>& tools, const ToolNeed& need, double largest_mm) {
  for (const PlanTool* t : tools)
    if (t->tool.diameter_mm <= largest_mm + kEqual_mm && usable(*t, need)) return t;
  return nullptr;
}

std::string wanted_tool(const ToolNeed& need, ToolUse use, double largest_mm) {
  std::string out = fmt::format("{} {}", use == ToolUse::end_mill ? "an" : "a", to_string(use));
  if (std::isfinite(largest_mm)) out += fmt::format(" of at most {:.4g} mm", largest_mm);
  return out + fmt::format(" that reaches {:.4g} mm deep", wall_of(need, 0));
}

}  // namespace

std::string reach_fault(const machine::Tool& tool, const ToolNeed& need) {
  const double cutter = tool.diameter_mm / 2, flutes = tool.flute_length_mm.value_or(tool.overhang_mm);
  if (tool.overhang_mm < need.depth_mm + kClearance_mm)
    return fmt::format("its overhang of {:.4g} mm is too short for a depth of {:.4g} mm", tool.overhang_mm,
                       need.depth_mm);
  if (tool.shank_diameter_mm / 2 > cutter && flutes < tool.overhang_mm) {
    const double wall = wall_of(need, tool.shank_diameter_mm / 2);
    if (wall > flutes + tool.neck_length_mm)
      return fmt::format("its shank of {:.4g} mm meets a wall {:.4g} mm high", tool.shank_diameter_mm, wall);
  }
  double height = tool.overhang_mm;
  for (const machine::HolderPart& part : tool.holder) {
    const double radius = std::max(part.lower_diameter_mm, part.upper_diameter_mm) / 2;
    const double wall = wall_of(need, radius);
    if (wall + kClearance_mm > height)
      return fmt::format("its holder of {:.4g} mm meets a wall {:.4g} mm high", 2 * radius, wall);
    height += part.length_mm;
  }
  return {};
}

std::optional<ToolPick> pick_mill(const ToolNeed& need, const PlanTools& tools, std::string& wanted) {
  const ToolUse use = use_for(need.feature);
  const auto candidates = tools_for(tools, use);
  const double rule = largest_diameter_mm(need.feature, need.width_mm);
  const bool walls = use == ToolUse::face_mill && need.walls_within;
  if (const PlanTool* t = walls ? nullptr : first_usable(candidates, need, rule)) return ToolPick{t->tool.number, {}};
  const auto end_mills = tools_for(tools, ToolUse::end_mill);
  if (use == ToolUse::face_mill) {
    if (const PlanTool* t = first_usable(end_mills, need, machine::kNoLimit))
      return ToolPick{t->tool.number, candidates.empty() ? "there is no face mill"
                                      : walls            ? "walls stand within it: an end mill"
                                                         : "no face mill has room and reach"};
  } else if (std::isfinite(rule)) {
    const double narrower = need.width_mm * (1 - 1e-3);
    if (const PlanTool* t = first_usable(candidates, need, narrower))
      return ToolPick{t->tool.number, fmt::format("the rule asks for {:.4g} mm or less", rule)};
  }
  wanted = wanted_tool(need, use, std::isfinite(rule) ? rule : 2 * need.inner_radius_mm);
  return std::nullopt;
}

std::optional<ToolPick> pick_rest_mill(const ToolNeed& need, const PlanTools& tools, std::string& wanted) {
  const double largest = 2 * need.inner_radius_mm * (1 + kCornerShare);
  if (const PlanTool* t = first_usable(tools_for(tools, ToolUse::end_mill), need, largest))
    return ToolPick{t->tool.number, {}};
  wanted = wanted_tool(need, ToolUse::end_mill, 2 * need.inner_radius_mm);
  return std::nullopt;
}

namespace {

/// The tool of a use whose diameter is this, within a tolerance.
std::optional<int> of_diameter(const PlanTools& tools, ToolUse use, const ToolNeed& need, double low, double high) {
  for (const PlanTool* t : tools_for(tools, use))
    if (t->tool.diameter_mm >= low && t->tool.diameter_mm <= high && reach_fault(t->tool, need).empty())
      return t->tool.number;
  return std::nullopt;
}

}  // namespace

std::optional<HoleTools> pick_hole_tools(const ToolNeed& need, const PlanTools& tools, std::string& wanted) {
  constexpr double kFits_mm = 0.05, kReamingLow_mm = 0.5, kReamingHigh_mm = 0.05;
  const double d = need.width_mm;
  HoleTools out;
  ToolNeed mouth = need;
  mouth.depth_mm = std::min(need.depth_mm, 1.0);
  for (const PlanTool* t : tools_for(tools, ToolUse::center_drill))
    if (t->tool.diameter_mm < d && !out.center_drill && t->tool.overhang_mm > mouth.depth_mm)
      out.center_drill = t->tool.number;
  // Wider than the hole a spot drill cuts with its point alone; the smallest one.
  if (!out.center_drill)
    for (const PlanTool* t : tools_for(tools, ToolUse::center_drill))
      if (t->tool.point_angle_rad > 0 && t->tool.overhang_mm > mouth.depth_mm) out.center_drill = t->tool.number;
  out.reamer = of_diameter(tools, ToolUse::reamer, need, d - kFits_mm, d + kFits_mm);
  if (out.reamer) out.drill = of_diameter(tools, ToolUse::drill, need, d - kReamingLow_mm, d - kReamingHigh_mm);
  if (out.reamer && out.drill) return out;
  out.reamer.reset();
  out.drill = of_diameter(tools, ToolUse::drill, need, d - kFits_mm, d + kFits_mm);
  if (out.drill) return out;
  out.center_drill.reset();
  constexpr double kBoring = 0.75;  // of the hole: chips have room, and the cutter goes round
  if (const PlanTool* t = first_usable(tools_for(tools, ToolUse::end_mill), need, kBoring * d)) {
    out.end_mill = t->tool.number;
    out.note = fmt::format("no drill of {:.4g} mm reaches {:.4g} mm; the hole is milled", d, need.depth_mm);
    return out;
  }
  wanted = fmt::format("a drill of {:.4g} mm that reaches {:.4g} mm deep", d, need.depth_mm);
  return std::nullopt;
}

}  // namespace camber::plan
