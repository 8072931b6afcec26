#pragma once
// Tool pose: tip, axis, and how the spindle's X direction is turned about it.
#include "base/geometry.h"

namespace camber {

using Mat3 = Eigen::Matrix3d;

/// Tip (mm) and unit axis of a tool in the part's frame. The axis points from the tip towards the spindle.
struct ToolPose {
  Vec3 tip_mm = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();
  /// By which the tool's frame is turned about its axis, counter-clockwise seen from the spindle, after the shortest
  /// rotation of +Z to the axis. Edges count their angles from the frame's x.
  double spin_rad = 0;

  /// The tool's frame is exactly parallel to the part's, as in every three-axis program. Code with "upright" in its
  /// name or namespace requires it.
  bool upright() const { return axis.x() == 0 && axis.y() == 0 && axis.z() > 0 && spin_rad == 0; }
};

/// The tool's frame, with its origin at the tip and z along the axis: columns x, y, z in the part's frame.
Mat3 tool_frame(const ToolPose& pose);
/// The pose whose frame has this z, and the x that is nearest to `x` (not parallel to z).
ToolPose pose_of_frame(const Vec3& tip_mm, const Vec3& axis, const Vec3& x);

Vec3 tilted_direction_in_tool(const ToolPose& pose, const Vec3& direction_in_part);
Vec3 tilted_direction_in_part(const ToolPose& pose, const Vec3& direction_in_tool);

inline Vec3 direction_in_tool(const ToolPose& pose, const Vec3& direction_in_part) {
  return pose.upright() ? direction_in_part : tilted_direction_in_tool(pose, direction_in_part);
}
inline Vec3 direction_in_part(const ToolPose& pose, const Vec3& direction_in_tool) {
  return pose.upright() ? direction_in_tool : tilted_direction_in_part(pose, direction_in_tool);
}
inline Vec3 point_in_tool(const ToolPose& pose, const Vec3& point_in_part) {
  return direction_in_tool(pose, point_in_part - pose.tip_mm);
}
inline Vec3 point_in_part(const ToolPose& pose, const Vec3& point_in_tool) {
  return pose.tip_mm + direction_in_part(pose, point_in_tool);
}

}  // namespace camber
