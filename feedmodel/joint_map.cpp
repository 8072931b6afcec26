#include "feedmodel/joint_map.h"

namespace camber::feedmodel {

bool has_rotary_motion(const nc::Interpretation& program, const machine::Machine& machine) {
  return machine.kinematics.given() && !program.rotary.empty();
}

JointMap::JointMap(const machine::Machine& machine, const nc::Interpretation& program)
    : chain_(machine),
      tool_axis_(machine.kinematics.tool_axis.normalized()),
      gauge_mm_(machine.kinematics.gauge_point_mm),
      origin_mm_(program.machine_origin_mm.value_or(Vec3::Zero())) {}

kinematics::Joints JointMap::joints(const ProgramPose& pose, const Turn& turn) const {
  kinematics::Joints out;
  out.rotary_rad = pose.rotary_rad;
  const Vec3 tip_mm = pose.xyz_mm - origin_mm_;
  out.linear_mm = turn.tip_control
                      ? chain_.linear_mm(tip_mm, pose.rotary_rad, turn.tool_length_mm).value_or(Vec3::Zero())
                      : Vec3(tip_mm + turn.tool_length_mm * tool_axis_ - gauge_mm_);
  return out;
}

ToolPose JointMap::tool(const kinematics::Joints& joints, const Turn& turn) const {
  ToolPose pose = chain_.pose(joints, turn.tool_length_mm);
  pose.tip_mm += origin_mm_;
  return pose;
}

}  // namespace camber::feedmodel
