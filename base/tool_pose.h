#pragma once
// Tool pose: tip and axis.
#include "base/geometry.h"

namespace camber {

/// Tip (mm) and unit axis of a tool in the part's frame. The axis points from the tip towards the spindle.
struct ToolPose {
  Vec3 tip_mm = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();

  /// The axis is exactly +Z, as in every three-axis program. Code with "upright" in its name or namespace requires it.
  bool upright() const { return axis.x() == 0 && axis.y() == 0 && axis.z() > 0; }
};

// The tool's frame has its origin at the tip and z along the axis. An upright tool's x and y are the part's; a tilted
// axis takes them along by the shortest rotation from +Z.

Vec3 tilted_direction_in_tool(const Vec3& axis, const Vec3& direction_in_part);
Vec3 tilted_direction_in_part(const Vec3& axis, const Vec3& direction_in_tool);

inline Vec3 direction_in_tool(const ToolPose& pose, const Vec3& direction_in_part) {
  return pose.upright() ? direction_in_part : tilted_direction_in_tool(pose.axis, direction_in_part);
}
inline Vec3 direction_in_part(const ToolPose& pose, const Vec3& direction_in_tool) {
  return pose.upright() ? direction_in_tool : tilted_direction_in_part(pose.axis, direction_in_tool);
}
inline Vec3 point_in_tool(const ToolPose& pose, const Vec3& point_in_part) {
  return direction_in_tool(pose, point_in_part - pose.tip_mm);
}
inline Vec3 point_in_part(const ToolPose& pose, const Vec3& point_in_tool) {
  return pose.tip_mm + direction_in_part(pose, point_in_tool);
}

}  // namespace camber
