#include "removal/stamp_path.h"

#include <algorithm>

namespace camber::removal {

using feedmodel::TimedSample;

std::vector<bool> selected_moves(const nc::Interpretation& program, const machine::Operations& operations) {
  const auto wanted = [&](const nc::Move& m) {
    if (m.kind != nc::MoveKind::linear && m.kind != nc::MoveKind::arc) return false;
    if (m.reference || m.canned) return false;
    const int tool = program.state_of(m).tool;
    if (!operations.tools.empty() && std::ranges::find(operations.tools, tool) == operations.tools.end()) return false;
    const int line = static_cast<int>(m.block) + 1;
    return operations.blocks.empty() ||
           std::ranges::any_of(operations.blocks, [&](const auto& r) { return line >= r[0] && line <= r[1]; });
  };
  std::vector<bool> out;
  out.reserve(program.moves.size());
  for (const auto& m : program.moves) out.push_back(wanted(m));
  return out;
}

StampBuilder::StampBuilder(const nc::Interpretation& program, const std::map<int, machine::Tool>& tools,
                           std::vector<bool> selected)
    : program_(program), tools_(tools), selected_(std::move(selected)), tracker_(program) {}

void StampBuilder::add(std::span<const TimedSample> samples) {
  for (const TimedSample& s : samples) add(s);
}

void StampBuilder::add(const TimedSample& sample) {
  const feedmodel::PathPlace place = tracker_(sample);
  for (; next_move_ <= place.move; ++next_move_)
    if (program_.moves[next_move_].kind == nc::MoveKind::rapid) path_.rapids.push_back({next_move_, sample.t_s});
  if (!selected_[place.move]) {
    cutting_ = false;
  } else {
    const nc::ModalState& state = program_.state_of(program_.moves[place.move]);
    const double passing_s = 60.0 / (state.spindle_speed_rpm * tools_.at(state.tool).flutes);
    if (!cutting_ || path_.runs.empty() || path_.runs.back().tool != state.tool) {
      next_s_ = sample.t_s;
      cutting_ = false;
    }
    for (; next_s_ <= sample.t_s; next_s_ += passing_s) stamp_at(next_s_, sample, place, state.tool);
  }
  last_ = sample;
  have_last_ = true;
}

void StampBuilder::stamp_at(double t_s, const TimedSample& sample, const feedmodel::PathPlace& place, int tool) {
  constexpr double kStill_mm = 1e-6;
  Stamp stamp;
  stamp.t_s = t_s;
  stamp.share = place.u;
  stamp.move = place.move;
  stamp.first = !cutting_;
  const double span = have_last_ ? sample.t_s - last_.t_s : 0;
  const double u = span > 0 ? std::clamp((t_s - last_.t_s) / span, 0.0, 1.0) : 1.0;
  stamp.tip_mm = have_last_ ? Vec3((1 - u) * last_.position_mm + u * sample.position_mm) : sample.position_mm;
  if (cutting_) {
    stamp.feed_per_tooth_mm = stamp.tip_mm - path_.stamps.back().tip_mm;
    if (stamp.feed_per_tooth_mm.norm() < kStill_mm) return;
  } else {
    const nc::ModalState& state = program_.state_of(program_.moves[place.move]);
    stamp.feed_per_tooth_mm = sample.velocity_mm_per_s * 60.0 / (state.spindle_speed_rpm * tools_.at(tool).flutes);
  }
  if (path_.runs.empty() || path_.runs.back().tool != tool) path_.runs.push_back({tool, path_.stamps.size(), 0});
  ++path_.runs.back().count;
  path_.stamps.push_back(stamp);
  cutting_ = true;
}

}  // namespace camber::removal
