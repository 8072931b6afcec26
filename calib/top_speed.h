#pragma once
// Top speeds of axes, from speeds that traces hold.
#include <array>
#include <optional>
#include <vector>

#include "calib/held_speed.h"

namespace camber::calib {

/// Of one joint, mm/s or degrees/s.
struct TopSpeed {
  std::optional<FittedValue> limit;  ///< the axis was at its limit
  int moves = 0;                     ///< that show it
  double highest = 0;                ///< speed that some move holds: the limit is no lower
};

/// Of x, y, z, a, b, c.
///
/// The axes share one path, so that an axis is known to be at its limit only in a move that asks it for more,
/// where it turns as fast as it ever does, and where every other axis stays below a speed that it holds elsewhere. In a
/// dog-leg rapid each axis has its own time, and counts by itself. Arcs and moves under tool-centre-point control do
/// not count: their axes keep no speed by themselves.
std::array<TopSpeed, kJoints> top_speeds(const std::vector<HeldSpeed>& held);

}  // namespace camber::calib
