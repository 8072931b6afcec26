#pragma once
// From moves to the segments that the control commands: lines merged, corners rounded, limits set.
#include <functional>

#include "feedmodel/segment.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::feedmodel {

using SegmentSink = std::function<void(const Segment&)>;

/// Hands the segments out in order; each starts where the one before ended. A dwell, a tool change and the end
/// of the program are rests (length 0). Moves without length and moves to a reference point that is not known
/// are left out. Memory does not grow with the program; called twice it gives the same segments.
void build_segments(const nc::Interpretation& program, const machine::Machine& machine, const SegmentSink& sink);

}  // namespace camber::feedmodel
