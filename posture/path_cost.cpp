#include "posture/path_cost.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "posture/rotary_path.h"

namespace camber::posture {

std::vector<AxisStep> axis_steps(std::span<const PathPoint> points, std::span<const Vec3> axes, const LagError& lag,
                                 const machine::Machine& machine) {
  const kinematics::Chain chain(machine);
  const std::vector<Vec3> rotary_rad = rotary_path(machine, points, axes);
  LagError::Place before;
  std::vector<AxisStep> out(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PathPoint& p = points[i];
    const LagError::Place here = lag.place(p, axes[i], rotary_rad[i]);
    if (i > 0) {
      out[i].swings = swings(chain, points, axes, rotary_rad, i);
      const Vec3 turn = (here.joints.rotary_rad - before.joints.rotary_rad).cwiseAbs();
      out[i].turn_deg = deg_from_rad(turn.sum());
      out[i].time_s = p.time_s;
      for (Eigen::Index k = 0; k < 3; ++k)
        out[i].time_s =
            std::max(out[i].time_s, turn[k] / machine.rotary[static_cast<std::size_t>(k)].max_velocity_rad_per_s);
      if (p.contact && p.time_s > 0) out[i].lag_error_mm = LagError::error_mm(before, here, out[i].time_s);
    }
    before = here;
  }
  return out;
}

double path_cost(std::span<const PathPoint> points, std::span<const Vec3> axes, const ToolShape& tool,
                 const LagError& lag, const machine::Machine& machine, const PostureOptions& options) {
  const std::vector<AxisStep> steps = axis_steps(points, axes, lag, machine);
  double cost = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PathPoint& p = points[i];
    cost += posture_cost(p, axes[i], options) + options.degree_cost_mm * steps[i].turn_deg;
    if (steps[i].swings) cost += kSwingCost_mm;
    if (tool.error_mm > 0) cost += p.way_mm * lag_share(steps[i].lag_error_mm, tool);
    if (p.time_s > 0) cost += kTimeShare * p.way_mm / p.time_s * (steps[i].time_s - p.time_s);
  }
  return cost;
}

}  // namespace camber::posture
