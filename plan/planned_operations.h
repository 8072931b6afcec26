#pragma once
// The operations of a plan: tool, path pattern, conditions, place and time of each.
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plan/order.h"
#include "plan/plan_input.h"

namespace camber::plan {

// Which tool machines a feature, and under which conditions.

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

enum class Pattern : unsigned char { scanning_line, contour_line, drilling };
inline constexpr std::array<std::string_view, 3> kPatterns{"scanning-line", "contour-line", "drilling"};

enum class OperationKind : unsigned char { rough, rest, finish, centre, drill, ream };
inline constexpr std::array<std::string_view, 6> kOperationKinds{"rough", "rest", "finish", "centre", "drill", "ream"};

struct PlanOperation {
  std::size_t primitive = 0;  ///< place in the order, from 1
  Feature feature = Feature::face;
  OperationKind kind = OperationKind::rough;
  int tool = 0;
  Pattern pattern = Pattern::scanning_line;
  Conditions conditions;
  double allowance_mm = 0;
  double scallop_mm = 0;          ///< > 0: rows on a free-form face
  bool joined = false;            ///< cut in one run with the operation before it (plan/joined_runs.h)
  std::array<Vec2, 2> box_mm{};   ///< where the tool's axis may be: lower and upper corner
  double from_mm = 0, to_mm = 0;  ///< heights of the tip: lowest and highest
  double volume_mm3 = 0;          ///< that it removes
  double nominal_time_s = 0;      ///< volume / removal rate
  double time_s = 0;              ///< time of its program, by the feed model, of a run with its first; 0: none was made
  double surface_mm2 = 0;         ///< area of the part that it finishes
  std::vector<std::string> notes{};
};

/// A primitive that no operation machines.
struct Unmachined {
  std::size_t primitive = 0;  ///< among PlannedDivision::primitives
  std::string what, reason;
};

/// The program of a plan, and the cut along it.
struct PlanProgramFigures {
  double time_s = 0;  ///< by the feed model, with tool changes and spindle
  double removed_mm3 = 0;
  double left_p95_um = 0, left_max_um = 0;  ///< on the part, where tools can touch it
  double gouge_um = 0;                      ///< depth of the stock's surface below the part's
};

/// One of the three plans.
struct PlannedDivision {
  DivisionPlan division = DivisionPlan::largest;
  std::vector<VolumePrimitive> primitives;
  Order order;
  std::vector<PlanOperation> operations;
  std::vector<Unmachined> unmachined;
  int tool_changes = 0;
  double nominal_time_s = 0;                  ///< equation (3)
  std::optional<PlanProgramFigures> program;  ///< not given: none was made
  double form_error_p95_mm = 0;               ///< percentile over the last operations at each surface, weighted by area
  bool complete() const { return unmachined.empty(); }
};

/// Operations of the primitives in their order. Each box: one with the tool of the rules; a rest operation where an
/// inner corner is narrower; with `finish = "fine"` the first leaves an allowance, and another one finishes. Free form:
/// an end mill first where it is deeper than the ball end mill cuts. Holes: centre, drill, ream, each tool for all
/// holes; a drill goes on into the hole under a reamed one where that has its diameter.
PlannedDivision plan_division(const PlanInput& input, const RemovalVolume& removal, DivisionPlan division);

/// Number of times that the tool changes from one operation to the next.
int tool_changes(const std::vector<PlanOperation>& operations);
/// Equation (3): the sum of the operations and tool_change_s for each change.
double total_time_s(const std::vector<PlanOperation>& operations, double tool_change_s);
/// 95th percentile, weighted by surface.
double form_error_p95_mm(const std::vector<PlanOperation>& operations);

/// Index of the plan that is taken: complete before incomplete, then the least time, fewer tool changes, less form
/// error; the first of equal ones.
struct PlanFigures {
  bool complete = true;
  double time_s = 0;
  int tool_changes = 0;
  double form_error_mm = 0;
};
std::size_t best_plan(const std::vector<PlanFigures>& plans);

}  // namespace camber::plan
