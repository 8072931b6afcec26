#pragma once
// Whether the cut of a job with operations begins in material.
#include <functional>

#include "base/diagnostics.h"
#include "base/tool_pose.h"
#include "machine/job_file.h"
#include "motion/simulated_program.h"
#include "removal/stock.h"

namespace camber::checks {

/// Warning [starts-in-material] at the first move that is milled, where it goes on from a feed move that the job leaves
/// out and its cutter stands in the blank there by more than a voxel: the material within the cutter is removed without
/// chips.
void check_region_start(const machine::Job& job, const motion::SimulatedProgram& program, const removal::Stock& blank,
                        Diagnostics& diagnostics);
/// The same, where it is known whether the cutter stands in material there.
void check_region_start(const machine::Job& job, const motion::SimulatedProgram& program,
                        const std::function<bool(const machine::Tool&, const ToolPose&)>& stands_in,
                        Diagnostics& diagnostics);

}  // namespace camber::checks
