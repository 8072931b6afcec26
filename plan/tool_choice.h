#pragma once
// Which tool machines a feature, and under which conditions.
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

/// Loads of a straight cut at full depth and width (deflection/steady_cut.h): the largest of the operation but for
/// entries and corners.
struct CutLoads {
  double force_N = 0;        ///< lateral, greatest over a turn; drills: none
  double deflection_mm = 0;  ///< deflection of the tip under that force at half the depth of cut
  double form_error_mm = 0;  ///< across the wall, at half the depth of cut, under the greatest force that way
  double power_W = 0;        ///< mean
};

struct Conditions {
  double spindle_rpm = 0, feed_mm_per_min = 0;
  double radial_mm = 0, axial_mm = 0;
  CutLoads loads;
  std::string limit = "cases";  ///< what binds: "cases" where the conditions are theirs
  bool within = true;           ///< false: beyond a limit all the same
};

CutLoads mill_loads(const machine::Tool& tool, const machine::Material& material, const Conditions& c);
/// Power from the edge forces at half the radius; h = f_z sin(point angle / 2).
CutLoads drill_loads(const machine::Tool& tool, const machine::Material& material, const Conditions& c);

/// Requirements of an operation beside its tool.
struct CutNeed {
  bool fine = false;
  double depth_mm = machine::kNoLimit;  ///< depth of the primitive: no deeper cut
  double width_mm = machine::kNoLimit;  ///< no wider one
};

/// Reduces given conditions until all limits are kept: spindle speed (with the feed per tooth), feed of the axes,
/// flute length, then power of spindle and plan, force, deflection and form error, for which first the feed goes down
/// to half, then the axial depth to a tenth. `limit` names the last one that changed something.
Conditions bounded(Conditions c, const PlanInput& plan, const PlanTool& tool);

/// Nothing where the case base has no case of the tool's type. Where it has none of fast machining, usual ones answer,
/// with a note.
std::optional<Conditions> conditions_for(const PlanInput& plan, const PlanTool& tool, const CutNeed& cut,
                                         std::string& note);

/// Equation (5): Ad Rd F / 60, mm^3/s; drills pi D^2 F / 240.
double removal_rate_mm3_per_s(const PlanTool& tool, const Conditions& c);

}  // namespace camber::plan
