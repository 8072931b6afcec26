#pragma once
// The moves of a program as the machine runs them.
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::kinematics {

/// Rewrites the moves for a planner that knows two kinds of coordinates: those of the linear axes and, under
/// tool-centre-point control, those of the tip in the part's frame.
///   - Moves in a tilted frame (G68.2), under G254 and to machine coordinates (G53, G28, G30) become moves of the
///   linear
///     axes. G53.1 gets the angles that were found, as words. Arcs turn with the frame; where the linear axes are not
///     square to each other in the part's frame, so that an arc would become an ellipse, it keeps that frame.
///   - Lines start and end where the machine does, where that differs from what the program names
///     (ProgramJoints::start_mm), and every move starts where the last one ends. Neither start nor end is open.
///   - Where the place of an axis is not known (before its first word, at a reference point), it is that at which the
///     axis is next known, or else the last known one: it takes the shortest way, and there is no jump. Such moves are
///     marked as Move::reference. No machine targets are left. [tool_change] and [reference_point] of the machine give
///     reference points, and where the axes stand before the first move.
/// An unknown work offset or tool length counts as zero, and machine coordinates are then not known. Requires
/// machine.kinematics.given().
void place_moves(nc::Interpretation& program, const machine::Machine& machine);

}  // namespace camber::kinematics
