#pragma once
// What the NC interpreter needs to know of a machine's rotary axes.
#include <vector>

#include "machine/machine.h"
#include "nc/rotary.h"

namespace camber::kinematics {

/// For InterpreterOptions::rotary_axes, in the order A, B, C; empty without [kinematics].
std::vector<nc::RotaryOption> rotary_options(const machine::Machine& machine);

}  // namespace camber::kinematics
