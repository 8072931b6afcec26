#pragma once
// The table of operations as a file that the user edits and gives back.
#include <string>

#include "plan/setup_plan.h"

namespace camber::plan {

/// operations.toml of one set-up: `division` and a [[operation]] for each row.
std::string operations_toml(const PlanInput& input, const SetupPlan& setup, std::size_t plan);

/// Reads a table back into `setup`, as its only plan. Rows stand in their order and each names its primitive and kind;
/// what a row leaves out is decided anew: the tool by the rules, conditions by cases for the row's tool. Conditions
/// that are given are kept as they are, and their loads told. Throws InputError.
void read_operations(const std::string& path, const PlanInput& input, SetupPlan& setup, Diagnostics& diagnostics);

/// Binary STL of a solid.
std::string stl_text(const TriangleSolid& solid);

}  // namespace camber::plan
