#pragma once
// Evaluates a path whose directions are chosen, axis by axis of the machine.
#include <span>
#include <vector>

#include "machine/machine_model.h"
#include "posture/choose.h"

namespace camber::posture {

/// Motion of the axes from the point before to this one.
struct AxisStep {
  bool swings = false;      ///< rotary_path.h
  double turn_deg = 0;      ///< turn of all rotary axes
  double time_s = 0;        ///< time at the programmed feed, longer where a rotary axis is too slow
  double lag_error_mm = 0;  ///< LagError; 0 off the part
};

/// Returns one step per point; the rotary axes follow rotary_path().
std::vector<AxisStep> axis_steps(std::span<const PathPoint> points, std::span<const Vec3> axes, const LagError& lag,
                                 const machine::Machine& machine);

/// Returns the cost by which directions are chosen, for a whole path: posture_cost(), lag_share(), rotary motion and
/// time; and kSwingCost_mm for every swing.
inline constexpr double kSwingCost_mm = 1000;
double path_cost(std::span<const PathPoint> points, std::span<const Vec3> axes, const ToolShape& tool,
                 const LagError& lag, const machine::Machine& machine, const PostureOptions& options);

}  // namespace camber::posture
