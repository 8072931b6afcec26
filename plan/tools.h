#pragma once
// Which tool machines a feature.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plan/order.h"
#include "plan/plan_input.h"

namespace camber::plan {

/// Share of its radius by which facets tell that of an inner corner wrongly.
inline constexpr double kCornerShare = 0.03;

/// Requirements of a primitive on its tool.
struct ToolNeed {
  Feature feature = Feature::face;
  double width_mm = 0;                         ///< see Step
  double depth_mm = 0;                         ///< from its top to its bottom
  double inner_radius_mm = machine::kNoLimit;  ///< smallest of its upright inner corners
  bool walls_within = false;                   ///< something of the part stands in it
  std::function<double(double)> wall_mm{};     ///< height over the bottom of what stands within a distance
  std::function<bool(double)> has_room{};      ///< for a radius; empty: always
};

struct ToolPick {
  int tool = 0;
  std::string note{};  ///< why it is not the rule's tool; empty: it is
};

/// The tools of a use, the largest first.
std::vector<const PlanTool*> tools_for(const PlanTools& tools, ToolUse use);

/// Which kind of tool makes a feature: face mills for faces and steps, drills for holes, ball end mills for free-form
/// faces, else end mills.
ToolUse use_for(Feature feature);

/// Greatest diameter by the rules: closed pocket 5 x <= width, slots 3 x <= width; infinite: the largest there is.
double largest_diameter_mm(Feature feature, double width_mm);

/// Empty where the tool gets to the bottom: its holder 1 mm over what stands within the holder's radius, a shank wider
/// than the cutter likewise, and an overhang of more than the depth.
std::string reach_fault(const machine::Tool& tool, const ToolNeed& need);

/// The largest tool that keeps the rule, reaches and has room; where walls stand within a face or step, an end mill.
/// Where none does: of end mills the largest that is narrower than the feature; for faces and steps an end mill; with a
/// note. Nothing: none will do, and `wanted` says what tool would.
std::optional<ToolPick> pick_mill(const ToolNeed& need, const PlanTools& tools, std::string& wanted);

/// The largest end mill that gets into the need's inner corners, within 3 %: a mesh tells their radius no better.
std::optional<ToolPick> pick_rest_mill(const ToolNeed& need, const PlanTools& tools, std::string& wanted);

/// Tools of a hole, in their order: centre drill, drill, reamer; or an end mill that bores it.
struct HoleTools {
  std::optional<int> center_drill{}, drill{}, reamer{}, end_mill{};
  std::string note{};
};
std::optional<HoleTools> pick_hole_tools(const ToolNeed& need, const PlanTools& tools, std::string& wanted);

}  // namespace camber::plan
