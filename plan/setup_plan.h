#pragma once
// camber plan: from a blank and a part to operations.
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "plan/plan_input.h"
#include "plan/planned_operations.h"
#include "plan/removal_volume.h"

namespace camber::plan {

/// One position of the part on the machine.
struct SetupPlan {
  PartSetup setup;
  TriangleSolid blank, part;  ///< turned
  RemovalVolume removal;
  std::vector<PlannedDivision> plans;  ///< as kDivisionPlans
  std::size_t best = 0;
};

struct PlanResult {
  std::vector<SetupPlan> setups;
  double removal_mm3 = 0;  ///< blank minus part
};

/// Reads blank and part, and plans each set-up in all three ways. A set-up after the first one goes on with what the
/// best plans before it leave; it must be turned from the first one by quarter turns about the axes.
/// Throws InputError: [stl-open], [part-outside-blank], [nothing-to-remove], [setup-turn] and those of the readers.
PlanResult make_plan(const PlanInput& input, Diagnostics& diagnostics);

}  // namespace camber::plan
