#pragma once
// The moves of a program with rotary motion as feed models plan them.
#include "machine/machine.h"
#include "nc/move.h"
#include "simulate/rotary_motion.h"

namespace camber::simulate {

/// kinematics::place_moves of rotary.text(): tilted frames and moves to machine coordinates become moves of the linear
/// axes, as camber feed and camber time plan them. The moves have the same indices. Made anew at each call, so that no
/// second copy of the program stays.
nc::Interpretation moves_of_axes(const RotaryMotion& rotary, const machine::Machine& machine);

}  // namespace camber::simulate
