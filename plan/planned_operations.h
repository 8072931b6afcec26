#pragma once
// The operations of a plan: tool, path pattern, conditions, place and time of each.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "plan/tool_choice.h"

namespace camber::plan {

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
