#pragma once
// Finds the distance of every point of a grid from the nearest of many segments.
#include <array>
#include <vector>

#include "copymill/grid.h"

namespace camber::copymill {

using Segment = std::array<Vec2, 2>;

double distance_mm(const Segment& segment, const Vec2& p);

/// Each point tries the segments that its neighbours have found nearest, in four sweeps to and fro; beside the
/// segments the distance is exact, farther away the nearest segment may be missed by another that is as near but for
/// a small part of a step. Infinite without segments.
std::vector<float> distances_mm(const Grid& grid, const std::vector<Segment>& segments);

}  // namespace camber::copymill
