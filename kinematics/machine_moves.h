#pragma once
// The moves of a program as the machine runs them.
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::kinematics {

/// Rewrites the moves for a planner that knows two kinds of coordinates: those of the linear axes and, under
/// tool-centre-point control, those of the tip in the part's frame.
///   - Moves in a tilted frame (G68.2), under G254 and to machine coordinates (G53, G28, G30) become moves of the
///   linear
///     axes. G53.1 gets the angles that were found, as words. Arcs turn with the frame; where the linear axes are not
///     square to each other in the part's frame, so that an arc would become an ellipse, it keeps that frame.
///   - Lines start and end where the machine does, where that is known to differ from what the program names
///     (ProgramJoints::start_mm).
///   - Move::reference is cleared where both ends are known.
/// Moves with an end that is not known (work offset, tool length, reference point) stay as they were read; in a tilted
/// frame or under G254 their X, Y and Z do not move. Requires machine.kinematics.given().
void place_moves(nc::Interpretation& program, const machine::Machine& machine);

}  // namespace camber::kinematics
