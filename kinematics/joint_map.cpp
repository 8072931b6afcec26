#include "kinematics/joint_map.h"

namespace camber::kinematics {

bool has_rotary_motion(const nc::Interpretation& program, const machine::Machine& machine) {
  return machine.kinematics.given() && !program.rotary.empty();
}

JointMap::JointMap(const machine::Machine& machine, const nc::Interpretation& program)
    : chain_(machine),
      tool_axis_(machine.kinematics.tool_axis.normalized()),
      gauge_mm_(machine.kinematics.gauge_point_mm),
      origin_mm_(program.machine_origin_mm.value_or(Vec3::Zero())) {}

Joints JointMap::joints(const Vec3& named_mm, const Vec3& rotary_rad, bool tip_control, double tool_length_mm) const {
  Joints out;
  out.rotary_rad = rotary_rad;
  out.linear_mm = tip_control ? linear_of_tip_mm(named_mm, rotary_rad, tool_length_mm).value_or(Vec3::Zero())
                              : linear_of_axes_mm(named_mm, tool_length_mm);
  return out;
}

ToolPose JointMap::tool(const Joints& joints, double tool_length_mm) const {
  ToolPose pose = chain_.pose(joints, tool_length_mm);
  pose.tip_mm += origin_mm_;
  return pose;
}

}  // namespace camber::kinematics
