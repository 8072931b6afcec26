#pragma once
// The work of camber plan.
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "plan/setup_plan.h"

namespace camber::api {

struct PlannedFiles {
  plan::PlanResult result;
  /// Names within the output folder, and contents: operations.toml, plan-*.toml, job.toml, program.nc ...
  std::vector<std::pair<std::string, std::string>> files;
};

struct PlanJobOptions {
  std::string operations{};  ///< an edited table of operations; empty: none
  bool programs = false;     ///< also program.nc and one an operation, of the plans that are taken
  /// Programs of every complete plan; with one set-up their times, not those of equation (3), decide which is taken.
  bool all_programs = false;
};

/// Throws InputError. Writes nothing.
PlannedFiles plan_job(const plan::PlanInput& input, const PlanJobOptions& options, Diagnostics& diagnostics);

/// The case base's text with the operations of a table as new cases; those that are there already are left out.
struct LearnedCases {
  std::string text;
  std::size_t added = 0;
};
LearnedCases learn_cases(const plan::PlanInput& input, const plan::PlanResult& result);

}  // namespace camber::api
