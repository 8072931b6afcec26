#pragma once
// Builds the segments that the control commands from the moves of a program: lines merged, corners rounded, limits set.
#include <functional>

#include "feedmodel/segment.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::feedmodel {

using SegmentSink = std::function<void(const Segment&)>;

/// Hands the segments out in order; each starts at the end of the previous one, but after a move to or from a reference
/// point that is not known (a rest with `gap`). Rests (length 0) are dwells, tool changes, codes that the path waits
/// for (rests_of), and the end of the program. Positionings are single segments where each axis moves on its own
/// (rapid_path = "dogleg"); ways to a reference point that is known always are. Moves without length are left out.
/// Memory does not grow with the program; called twice it gives the same segments.
void build_segments(const nc::Interpretation& program, const machine::Machine& machine, const SegmentSink& sink);

}  // namespace camber::feedmodel
