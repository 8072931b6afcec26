#include "posture/choose.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/stage.h"

namespace camber::posture {
namespace {

constexpr double kCap_mm = 2;        ///< room beyond this is not measured
constexpr double kSteps = 1.5;       ///< the directions are so many times nearer to each other than along a path
constexpr std::size_t kAtOnce = 32;  ///< directions
constexpr double kFarthestIndexed = kPi / 2;  ///< largest angle of tool and normal

double cost_of(std::span<const PathPoint> points, const Vec3& axis, const ToolShape& tool, const LagError& lag,
               const kinematics::Chain& chain, const PostureOptions& options) {
  double cost = 0;
  for (const PathPoint& p : points) cost += posture_cost(p, axis, options);
  if (tool.error_mm <= 0 || !lag.any()) return cost;
  const std::vector<double> errors = lag.along(points, axis, chain.solve_tool_axis(axis, {}).joints.rotary_rad);
  for (std::size_t i = 0; i < points.size(); ++i) cost += points[i].way_mm * lag_share(errors[i], tool);
  return cost;
}

/// The first point at which the direction is not clear, or before which it is not.
std::optional<std::size_t> first_blocked(std::span<const PathPoint> points, const Surroundings& surroundings,
                                         const ToolShape& tool, const Vec3& axis) {
  double room = -1;
  Vec3 there = Vec3::Zero();
  const auto clear_at = [&](const Vec3& tip) {
    if (room > 0 && (tip - there).norm() < room) return true;
    room = surroundings.room_mm(tool, tip, axis, kCap_mm);
    there = tip;
    return room >= 0;
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].contact && angle_between(axis, points[i].normal) > kFarthestIndexed) return i;
    const Vec3 tip = points[i].tip_mm(axis);
    if (i > 0 && !clear_at((points[i - 1].tip_mm(axis) + tip) / 2)) return i;
    if (!clear_at(tip)) return i;
  }
  return std::nullopt;
}

}  // namespace

Postures one_direction(std::span<const PathPoint> points, const Surroundings& surroundings, const ToolShape& tool,
                       const machine::Machine& machine, const LagError& lag, const PostureOptions& options) {
  const Directions directions(machine, options.grid_rad / kSteps, options.max_tilt_rad);
  const kinematics::Chain chain(machine);
  std::vector<double> costs(directions.size());
  tbb::parallel_for(std::size_t{0}, costs.size(),
                    [&](std::size_t d) { costs[d] = cost_of(points, directions.axis(d), tool, lag, chain, options); });
  std::vector<std::size_t> order(costs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t d) { return costs[d]; });
  Postures out;
  std::vector<std::optional<std::size_t>> blocked(order.size());
  Stage stage("looking for one clear direction", order.size());
  for (std::size_t first = 0; first < order.size(); first += kAtOnce) {
    const std::size_t end = std::min(order.size(), first + kAtOnce);
    tbb::parallel_for(first, end, [&](std::size_t i) {
      blocked[i] = first_blocked(points, surroundings, tool, directions.axis(order[i]));
      stage.advance();
    });
    for (std::size_t i = first; i < end; ++i) {
      if (!blocked[i]) return {.axes = std::vector<Vec3>(points.size(), directions.axis(order[i]))};
      out.blocked = std::max(out.blocked.value_or(0), *blocked[i]);
    }
  }
  return out;
}

}  // namespace camber::posture
