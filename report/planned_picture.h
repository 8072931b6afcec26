#pragma once
// The path as the control plans it, with the actual feed: corners rounded, dog-leg rapids.
#include "kinematics/machine_program.h"
#include "machine/machine_model.h"
#include "nc/move.h"
#include "report/path_picture.h"

namespace camber::report {

/// A picture as of program_picture, of the segments of feedmodel::plan_motion: commanded path, before the axes'
/// filters and lag. Where the speed changes along a long segment it is drawn in pieces, each with its mean speed.
/// Linear in the number of blocks.
PathPicture planned_picture(const nc::Interpretation& program, const machine::Machine& machine, std::size_t most);

/// The path of the tip on the part (PartPath), of a program that turns: with tools and programmed feeds. Moves whose
/// offsets or tool length are not known are left out.
PathPicture tip_picture(const kinematics::MachineProgram& program, std::size_t most);

}  // namespace camber::report
