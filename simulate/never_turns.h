#pragma once
// Programs that name rotary axes and leave them at 0.
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::simulate {

/// True where every rotary word is 0 and nothing but tool-centre-point control is asked for: X, Y and Z are then those
/// of a program of three axes, and so is what is cut. Moves to machine coordinates count as rotary motion.
bool never_turns(const machine::Machine& machine, const nc::Interpretation& moves);

}  // namespace camber::simulate
