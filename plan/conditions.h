#pragma once
// Cutting conditions of an operation: by cases, then bounded by machine, tool and predicted loads.
#include <optional>
#include <string>

#include "plan/plan_input.h"

namespace camber::plan {

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
struct Cut {
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
std::optional<Conditions> conditions_for(const PlanInput& plan, const PlanTool& tool, const Cut& cut,
                                         std::string& note);

/// Equation (5): Ad Rd F / 60, mm^3/s; drills pi D^2 F / 240.
double removal_rate_mm3_per_s(const PlanTool& tool, const Conditions& c);

}  // namespace camber::plan
