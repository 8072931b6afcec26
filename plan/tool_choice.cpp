#include "plan/planned_operations.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "deflection/beam.h"
#include "deflection/edge_force.h"
#include "deflection/steady_cut.h"
#include "simulate/spindle_power.h"

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

namespace {

bool drills(const PlanTool& tool) {
  return tool.use == ToolUse::drill || tool.use == ToolUse::center_drill || tool.use == ToolUse::reamer;
}

CutLoads loads_of(const PlanTool& tool, const machine::Material& material, const Conditions& c) {
  return drills(tool) ? drill_loads(tool.tool, material, c) : mill_loads(tool.tool, material, c);
}

struct Limit {
  std::string_view name;
  double bound;
  double CutLoads::*load;
};

std::vector<Limit> limits_of(const PlanInput& plan, double rpm) {
  const PlanLimits& l = plan.limits;
  const double inf = machine::kNoLimit;
  return {{"spindle power", simulate::spindle_power_at(plan.machine.spindle, rpm), &CutLoads::power_W},
          {"power", l.power_W.value_or(inf), &CutLoads::power_W},
          {"force", l.force_N.value_or(inf), &CutLoads::force_N},
          {"deflection", l.deflection_mm.value_or(inf), &CutLoads::deflection_mm},
          {"form error", l.form_error_mm.value_or(inf), &CutLoads::form_error_mm}};
}

/// The greatest factor from `least` to 1 on a quantity with which the load is kept; `least` where none is.
double factor_for(const Limit& limit, const PlanInput& plan, const PlanTool& tool, const Conditions& c,
                  double Conditions::*quantity, double least) {
  const auto load = [&](double factor) {
    Conditions with = c;
    with.*quantity *= factor;
    return loads_of(tool, plan.material, with).*limit.load;
  };
  if (load(least) > limit.bound) return least;
  double low = least, high = 1;
  constexpr int kHalvings = 12;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (load(middle) > limit.bound ? high : low) = middle;
  }
  return low;
}

void keep(const Limit& limit, const PlanInput& plan, const PlanTool& tool, Conditions& c) {
  c.loads = loads_of(tool, plan.material, c);
  if (!(c.loads.*limit.load > limit.bound)) return;
  constexpr double kLeastFeed = 0.5, kLeastDepth = 0.1;
  c.limit = limit.name;
  c.feed_mm_per_min *= factor_for(limit, plan, tool, c, &Conditions::feed_mm_per_min, kLeastFeed);
  c.loads = loads_of(tool, plan.material, c);
  if (c.loads.*limit.load > limit.bound * (1 + 1e-9) && !drills(tool))
    c.axial_mm *= factor_for(limit, plan, tool, c, &Conditions::axial_mm, kLeastDepth);
  c.loads = loads_of(tool, plan.material, c);
  c.within = c.within && c.loads.*limit.load <= limit.bound * (1 + 1e-9);
}

double greatest_feed_mm_per_min(const machine::Machine& machine, bool along_z) {
  double least = machine::kNoLimit;
  for (std::size_t a = along_z ? 2 : 0; a < (along_z ? 3 : 2); ++a)
    least = std::min({least, machine.axis[a].max_velocity_mm_per_s, machine.axis[a].max_feed_mm_per_s});
  return mm_per_min_from_mm_per_s(least);
}

}  // namespace

CutLoads mill_loads(const machine::Tool& tool, const machine::Material& material, const Conditions& c) {
  CutLoads out;
  if (c.spindle_rpm <= 0 || c.axial_mm <= 0 || c.radial_mm <= 0) return out;
  const deflection::SteadyCut cut{.feed_per_tooth_mm = c.feed_mm_per_min / c.spindle_rpm / tool.flutes,
                                  .axial_depth_mm = c.axial_mm,
                                  .radial_depth_mm = std::min(c.radial_mm, tool.diameter_mm),
                                  .milling = deflection::Milling::down,
                                  .circular_chip = true};
  const deflection::SteadyCutModel model(tool, cut, 0.5);
  constexpr int kSteps = 120;
  double across = 0;
  for (const Vec3& f : model.waveform_N(material, {0, 0}, 0, kSteps)) {
    out.force_N = std::max(out.force_N, std::hypot(f.x(), f.y()));
    across = std::max(across, std::abs(f.y()));
  }
  const deflection::Beam beam = deflection::beam_of(tool);
  const double middle = c.axial_mm / 2;
  out.deflection_mm = out.force_N * beam.compliance_mm_per_N(0, middle);
  out.form_error_mm = across * beam.compliance_mm_per_N(middle, middle);
  out.power_W = model.torque_mean_Nmm(material) / 1000 * 2 * kPi * c.spindle_rpm / 60;
  return out;
}

CutLoads drill_loads(const machine::Tool& tool, const machine::Material& material, const Conditions& c) {
  CutLoads out;
  if (c.spindle_rpm <= 0) return out;
  const double half_point = tool.point_angle_rad > 0 ? tool.point_angle_rad / 2 : kPi / 2;
  const double radius = tool.diameter_mm / 2, per_lip = c.feed_mm_per_min / c.spindle_rpm / tool.flutes;
  const deflection::EdgeForce lip =
      deflection::edge_force(material, per_lip * std::sin(half_point), radius / std::sin(half_point));
  const double torque_Nmm = tool.flutes * std::abs(lip.tangential_N) * radius / 2;
  out.power_W = torque_Nmm / 1000 * 2 * kPi * c.spindle_rpm / 60;
  return out;
}

Conditions bounded(Conditions c, const PlanInput& plan, const PlanTool& tool) {
  if (c.spindle_rpm > plan.machine.spindle.max_rpm) {
    c.feed_mm_per_min *= plan.machine.spindle.max_rpm / c.spindle_rpm;
    c.spindle_rpm = plan.machine.spindle.max_rpm;
    c.limit = "spindle speed";
  }
  const double feed = greatest_feed_mm_per_min(plan.machine, drills(tool));
  if (c.feed_mm_per_min > feed) c.feed_mm_per_min = feed, c.limit = "feed of the axes";
  const double flutes = tool.tool.flute_length_mm.value_or(tool.tool.overhang_mm);
  if (!drills(tool) && c.axial_mm > flutes) c.axial_mm = flutes, c.limit = "flute length";
  c.radial_mm = std::min(c.radial_mm, tool.tool.diameter_mm);
  for (const Limit& limit : limits_of(plan, c.spindle_rpm)) keep(limit, plan, tool, c);
  c.loads = loads_of(tool, plan.material, c);
  return c;
}

std::optional<Conditions> conditions_for(const PlanInput& plan, const PlanTool& tool, const CutNeed& cut,
                                         std::string& note) {
  CaseContent query{
      plan.work_material,   std::string(to_string(tool.use)), tool.material, tool.coated, cut.fine, plan.fast,
      tool.tool.diameter_mm};
  auto answer = conditions_by_cases(plan.cases, query);
  if (!answer && plan.fast) {
    query.fast = false;
    answer = conditions_by_cases(plan.cases, query);
    if (answer && answer->similar)
      note = fmt::format("no case of fast machining with a {}; usual ones are used", to_string(tool.use));
  }
  if (!answer) {
    note = fmt::format("{} has no case of {} machining with a {}", plan.cases.path, plan.fast ? "fast" : "usual",
                       to_string(tool.use));
    return std::nullopt;
  }
  if (!answer->similar)
    note = fmt::format("no case is similar; the nearest ones ({:.2f}) are used", answer->neighbours.front().similarity);
  Conditions c;
  c.spindle_rpm = std::round(1000 * answer->speed_m_per_min / (kPi * tool.tool.diameter_mm));
  c.feed_mm_per_min = answer->feed_per_turn_mm * c.spindle_rpm;
  c.axial_mm = drills(tool) ? tool.tool.diameter_mm * (tool.use == ToolUse::drill ? 1.0 : 0.5)
                            : std::min(answer->axial_depth_mm, cut.depth_mm);
  c.radial_mm = std::min(answer->radial_depth_mm, cut.width_mm);
  c = bounded(c, plan, tool);
  c.feed_mm_per_min = std::max(1.0, std::floor(c.feed_mm_per_min));
  // What a table shows is what is planned with.
  constexpr double kPerMm = 1000;
  c.axial_mm = std::round(kPerMm * c.axial_mm) / kPerMm;
  c.radial_mm = std::round(kPerMm * c.radial_mm) / kPerMm;
  return c;
}

double removal_rate_mm3_per_s(const PlanTool& tool, const Conditions& c) {
  if (drills(tool)) return kPi * tool.tool.diameter_mm * tool.tool.diameter_mm * c.feed_mm_per_min / 240;
  return c.axial_mm * c.radial_mm * c.feed_mm_per_min / 60;
}

}  // namespace camber::plan
