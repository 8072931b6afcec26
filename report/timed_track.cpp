#include "report/timed_track.h"

#include <utility>

namespace camber::report {

TimedTrack::TimedTrack(const machine::Machine& machine, const nc::Interpretation& moves) : moves_(moves) {
  if (machine.kinematics.given()) chain_.emplace(machine);
  for (const nc::Move& move : moves.moves) {
    const nc::ModalState& state = moves.state_of(move);
    if (state.tool_length_mm.value_or(0) != 0) tool_length_mm_[state.tool] = *state.tool_length_mm;
  }
}

void TimedTrack::add(std::span<const feedmodel::TimedSample> samples, std::span<const feedmodel::JointSample> joints) {
  for (std::size_t i = 0; i < samples.size() && i < joints.size(); ++i, ++seen_) {
    // Where reference points are is not known.
    if (moves_.moves[samples[i].move].reference) continue;
    last_ = pose_of(samples[i], joints[i]);
    if (seen_ % every_ != 0) continue;
    kept_.push_back(last_);
    if (kept_.size() < 2 * kMax) continue;
    for (std::size_t k = 0; 2 * k < kept_.size(); ++k) kept_[k] = kept_[2 * k];
    kept_.resize((kept_.size() + 1) / 2);
    every_ *= 2;
  }
}

std::vector<kinematics::PoseSample> TimedTrack::take() {
  if (!kept_.empty() && kept_.back().time_s < last_.time_s) kept_.push_back(last_);
  return std::move(kept_);
}

kinematics::PoseSample TimedTrack::pose_of(const feedmodel::TimedSample& sample,
                                           const feedmodel::JointSample& joint) const {
  kinematics::PoseSample out;
  out.time_s = sample.t_s;
  out.joints = {sample.position_mm, joint.position_rad};
  const nc::Move& move = moves_.moves[sample.move];
  out.line = static_cast<int>(move.block) + 1;
  const auto length = tool_length_mm_.find(moves_.state_of(move).tool);
  if (chain_) out.pose = chain_->pose(out.joints, length == tool_length_mm_.end() ? 0 : length->second);
  return out;
}

std::vector<kinematics::PoseSample> timed_track(const machine::Machine& machine, const nc::Interpretation& moves) {
  TimedTrack track(machine, moves);
  feedmodel::predict_joints(moves, machine,
                            [&](std::span<const feedmodel::TimedSample> samples,
                                std::span<const feedmodel::JointSample> joints) { track.add(samples, joints); });
  return track.take();
}

}  // namespace camber::report
