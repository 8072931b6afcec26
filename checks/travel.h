#pragma once
// Travel of the axes.
#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "motion/simulated_program.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::checks {

/// Where the moves of a program take the axes, machine coordinates, against Axis::travel_mm. Needs
/// [compensation] work_offset_mm; without it only the extent is checked against the length of the travel.
/// Errors [travel], at the first move of each axis that leaves; nothing is said of axes without travel_mm. Rapids
/// count. X, Y and Z alone.
void check_travel(const machine::Job& job, const nc::Program& program, const nc::Interpretation& moves,
                  Diagnostics& diagnostics);
/// The same; of a program with rotary motion what kinematics/travel_check.h says, which has warnings as well.
void check_travel(const machine::Job& job, const motion::SimulatedProgram& program, Diagnostics& diagnostics);

}  // namespace camber::checks
