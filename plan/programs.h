#pragma once
// Programs of a plan, by copy milling.
#include <functional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "machine/copy_operations.h"
#include "plan/setup_plan.h"

namespace camber::plan {

struct PlanProgram {
  std::string whole;               ///< all operations, with tool changes, spindle and coolant
  std::vector<std::string> each;   ///< one an operation; a run's is its first operation's, the others have none
  std::vector<double> times_s;     ///< time of each, by the feed model, with its rapids; 0 where there is none
  std::vector<std::string> notes;  ///< note about each; mostly empty
  PlanProgramFigures figures;
};

/// The operations as [[copy]] tables of a job, joined ones as one.
std::vector<machine::CopyOperation> copy_operations(const PlanInput& input, const PlannedDivision& plan);

/// The job of camber copy: part and blank as they lie on the machine, tools, material. Without `blank_stl` the plan's
/// own blank.
machine::Job copy_job(const PlanInput& input, const std::string& part_stl, const std::string& blank_stl);

/// job.toml for camber copy: the job and its [[copy]] tables.
std::string copy_job_toml(const machine::Job& job, const std::vector<machine::CopyOperation>& operations);

/// Makes the paths, cuts the blank along them, and times the text with the feed model. With `input.compensate`
/// finishing operations are compensated. Warnings, at lines of `name`: an operation whose tool has no place, which is
/// left out [plan-no-place]; rapids, shanks and holders in material [collision-rapid] ... Throws InputError.
PlanProgram make_program(const PlanInput& input, const machine::Job& job, const PlannedDivision& plan,
                         const std::string& name, Diagnostics& diagnostics);

// The table of operations as a file that the user edits and gives back.

/// operations.toml of one set-up: `division` and a [[operation]] for each row.
std::string operations_toml(const PlanInput& input, const SetupPlan& setup, std::size_t plan);

/// Reads a table back into `setup`, as its only plan. Rows stand in their order and each names its primitive and kind;
/// what a row leaves out is decided anew: the tool by the rules, conditions by cases for the row's tool. Conditions
/// that are given are kept as they are, and their loads told. Throws InputError.
void read_operations(const std::string& path, const PlanInput& input, SetupPlan& setup, Diagnostics& diagnostics);

/// Binary STL of a solid.
std::string stl_text(const TriangleSolid& solid);

}  // namespace camber::plan
