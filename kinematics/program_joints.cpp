#include "kinematics/program_joints.h"

#include <cassert>

namespace camber::kinematics {

ProgramJoints::ProgramJoints(const machine::Machine& machine, const nc::Interpretation& moves)
    : moves_(moves),
      chain_(machine),
      tool_axis_(machine.kinematics.tool_axis.normalized()),
      gauge_mm_(machine.kinematics.gauge_point_mm) {}

bool ProgramJoints::linear_known(const nc::Move& move) const {
  return moves_.machine_origin_mm && moves_.state_of(move).tool_length_mm && !move.reference;
}

Vec3 ProgramJoints::tip_in_machine_mm(const nc::Move& move, double u) const {
  return nc::point_at(moves_, move, u) - *moves_.machine_origin_mm;
}

void ProgramJoints::take_target(const nc::RotaryTarget& target, const nc::Move& move) {
  now_.g93_time_s = target.time_s;
  if (!target.is_direction) {
    for (int i = 0; i < 3; ++i)
      if ((target.given & (1U << static_cast<unsigned>(i))) != 0) now_.end_rad[i] = target.end[i];
    return;
  }
  const double length_mm = moves_.state_of(move).tool_length_mm.value_or(0);
  const ToolPose pose{now_.linear_known ? tip_in_machine_mm(move, 1) : Vec3::Zero(), target.end};
  Joints near;
  near.rotary_rad = now_.start_rad;
  const Solution solution = chain_.solve(pose, length_mm, near);
  now_.reach = solution.reach;
  if (solution.reach == Reach::reached || solution.reach == Reach::travel) now_.end_rad = solution.joints.rotary_rad;
}

const MoveJoints& ProgramJoints::next() {
  assert(!done());
  const std::size_t index = next_++;
  const nc::Move& move = moves_.moves[index];
  const MoveJoints last = now_;
  now_ = {};
  now_.start_rad = now_.end_rad = last.end_rad;
  now_.linear_known = linear_known(move);
  const bool tip_control = moves_.state_of(move).tip_control != nc::TipControl::off;
  now_.start_known = tip_control == tip_control_ || last.end_rad == Vec3::Zero();
  tip_control_ = tip_control;
  if (next_target_ < moves_.rotary.size() && moves_.rotary[next_target_].move == index)
    take_target(moves_.rotary[next_target_++], move);
  if (tip_control && now_.linear_known && !chain_.linear_mm(Vec3::Zero(), now_.end_rad, 0)) now_.reach = Reach::linear;
  return now_;
}

Joints ProgramJoints::at(double u) const {
  const nc::Move& move = moves_.moves[index()];
  Joints out;
  out.rotary_rad = now_.start_rad + u * (now_.end_rad - now_.start_rad);
  if (!now_.linear_known) return out;
  const nc::ModalState& state = moves_.state_of(move);
  const Vec3 tip_mm = tip_in_machine_mm(move, u);
  if (state.tip_control == nc::TipControl::off)
    out.linear_mm = tip_mm + *state.tool_length_mm * tool_axis_ - gauge_mm_;
  else
    out.linear_mm = chain_.linear_mm(tip_mm, out.rotary_rad, *state.tool_length_mm).value_or(Vec3::Zero());
  return out;
}

}  // namespace camber::kinematics
