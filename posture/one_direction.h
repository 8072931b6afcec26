#pragma once
// Chooses one direction of the tool for a whole operation (3+2 axes).
#include <span>

#include "posture/choose.h"

namespace camber::posture {

/// Returns, of the directions that the machine reaches, the one of least cost that is clear at every point and half way
/// between two. `blocked` where there is none: the point at which the direction that gets farthest is not clear.
Postures one_direction(std::span<const PathPoint> points, const Surroundings& surroundings, const ToolShape& tool,
                       const machine::Machine& machine, const LagError& lag, const PostureOptions& options);

}  // namespace camber::posture
