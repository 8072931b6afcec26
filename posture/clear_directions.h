#pragma once
// Finds which directions are clear at which points, for a tool at several lengths at once.
#include <cstdint>
#include <span>
#include <vector>

#include "posture/directions.h"
#include "posture/path_points.h"
#include "posture/surroundings.h"

namespace camber::posture {

class ClearDirections {
 public:
  static constexpr std::size_t kMaxTools = 32;

  /// `tools`: the same one drawn in further and further, at most kMaxTools. Directions more than `farthest_rad` from
  /// the normal of a contact are not looked at, and are not clear.
  ClearDirections(std::span<const PathPoint> points, const Surroundings& surroundings, std::span<const ToolShape> tools,
                  const Directions& directions, double farthest_rad);

  bool clear(std::size_t point, std::size_t direction, std::size_t tool) const {
    return (clear_[point * directions_ + direction] >> tool & 1U) != 0;
  }

 private:
  std::size_t directions_;
  std::vector<std::uint32_t> clear_;  ///< point by point: a bit for each tool
};

}  // namespace camber::posture
