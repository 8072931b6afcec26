#include "simulate/never_turns.h"

#include <algorithm>

namespace camber::simulate {
namespace {

bool stays(const nc::RotaryTarget& target) {
  const Vec3 upright = target.is_direction ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::Zero());
  return target.time_s == 0 && target.end == upright;
}

}  // namespace

bool never_turns(const machine::Machine& machine, const nc::Interpretation& moves) {
  const bool on_axes = std::ranges::all_of(
      moves.states, [](const nc::ModalState& state) { return state.work_frame == nc::WorkFrame::machine; });
  return on_axes && moves.machine_targets.empty() && machine.kinematics.tool_axis.normalized() == Vec3::UnitZ() &&
         std::ranges::all_of(moves.rotary, stays);
}

}  // namespace camber::simulate
