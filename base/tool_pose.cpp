#include "base/tool_pose.h"

#include <cmath>

#include <Eigen/Geometry>

namespace camber {
namespace {

/// Turns +Z into `axis` the shortest way. The opposite of +Z is reached about the x axis.
Eigen::Quaterniond shortest_to(const Vec3& axis) { return Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), axis); }

Eigen::Quaterniond part_from_tool(const ToolPose& pose) {
  const Eigen::Quaterniond tilt = shortest_to(pose.axis);
  return pose.spin_rad == 0 ? tilt : tilt * Eigen::AngleAxisd(pose.spin_rad, Vec3::UnitZ());
}

}  // namespace

Mat3 tool_frame(const ToolPose& pose) {
  return pose.upright() ? Mat3(Mat3::Identity()) : Mat3(part_from_tool(pose).toRotationMatrix());
}

ToolPose pose_of_frame(const Vec3& tip_mm, const Vec3& axis, const Vec3& x) {
  const Vec3 turned = shortest_to(axis).conjugate() * x;
  return {tip_mm, axis, std::atan2(turned.y(), turned.x())};
}

Vec3 tilted_direction_in_tool(const ToolPose& pose, const Vec3& direction_in_part) {
  return part_from_tool(pose).conjugate() * direction_in_part;
}

Vec3 tilted_direction_in_part(const ToolPose& pose, const Vec3& direction_in_tool) {
  return part_from_tool(pose) * direction_in_tool;
}

}  // namespace camber
