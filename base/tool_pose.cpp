#include "base/tool_pose.h"

#include <Eigen/Geometry>

namespace camber {
namespace {

/// Turns +Z into `axis` the shortest way. The opposite of +Z is reached about the x axis.
Eigen::Quaterniond part_from_tool(const Vec3& axis) { return Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), axis); }

}  // namespace

Vec3 tilted_direction_in_tool(const Vec3& axis, const Vec3& direction_in_part) {
  return part_from_tool(axis).conjugate() * direction_in_part;
}

Vec3 tilted_direction_in_part(const Vec3& axis, const Vec3& direction_in_tool) {
  return part_from_tool(axis) * direction_in_tool;
}

}  // namespace camber
