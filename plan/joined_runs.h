#pragma once
// Operations that are cut in one run, as one region.
#include "plan/planned_operations.h"

namespace camber::plan {

/// Joins milling operations by levels of the same kind and tool, with the same allowance, where their places touch and
/// one region takes no longer than each by itself: fewer levels where one primitive lies under another, and never more.
/// Where some have rows and some loops it must take less long; all get loops then.
/// The conditions of a run are those of its depth. The second operation of a run and those after it have
/// `joined = true` and stand behind the first. For that an operation comes earlier or later than its primitive's place
/// in the order says, but never before another operation of its primitive, nor before the roughing of one above it.
void join_operations(const PlanInput& input, PlannedDivision& plan);

/// Place of the operation with which a run begins that an operation is in; its own where it is in none.
std::size_t first_of_run(const PlannedDivision& plan, std::size_t operation);

/// For a row of the table: what keeps it from being in one run with the row before; empty: nothing.
std::string not_joined_because(const PlanOperation& before, const PlanOperation& row);

}  // namespace camber::plan
