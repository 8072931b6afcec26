#pragma once
// Look-ahead: maximum entry speed of each segment such that the limits ahead can be met.
#include <cstddef>
#include <vector>

namespace camber::feedmodel {

struct PlanRow {
  double length_mm = 0;
  double speed_limit_mm_per_s = 0;
  double acceleration_mm_per_s2 = 0;
  double planned_fraction = 1;      ///< of the acceleration, that may be counted on for braking
  bool joined = false;              ///< counts as one with the next for the horizon
  double entry_speed_mm_per_s = 0;  ///< in: limit of the corner; out: planned speed
};

/// Lowers the entry speeds, in place, to what constant acceleration can keep: v_i^2 <= v_{i+1}^2 + 2 a_i L_i
/// backward and forward. The path starts and ends at rest.
///
/// depth: number of segments that the control sees ahead, the last of which it must be able to stop at;
/// 0: all. Linear time for every depth. Accelerations may be infinite.
void plan_speeds(std::vector<PlanRow>& rows, std::size_t depth);

}  // namespace camber::feedmodel
