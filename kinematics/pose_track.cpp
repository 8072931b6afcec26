#include "kinematics/pose_track.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "kinematics/program_joints.h"

namespace camber::kinematics {
namespace {

constexpr double kArcStepRad = kPi / 12;

class Tracker {
 public:
  Tracker(const machine::Machine& machine, const nc::Interpretation& moves, const PoseTrackOptions& options)
      : machine_(machine), moves_(moves), options_(options), joints_(machine, moves) {}

  PoseTrack run() {
    while (!joints_.done()) {
      const MoveJoints& now = joints_.next();
      add(now, moves_.moves[joints_.index()]);
    }
    return std::move(track_);
  }

 private:
  void add(const MoveJoints& now, const nc::Move& move) {
    if (!now.linear_known) {
      track_.unknown_moves += move.kind != nc::MoveKind::dwell;
      return;
    }
    if (!now.start_known) return sample(1, move);
    if (track_.samples.empty()) sample(0, move);
    const double start_s = time_s_;
    const double duration_s = this->duration_s(now, move);
    const std::size_t steps = steps_of(now, move);
    for (std::size_t i = 1; i <= steps; ++i) {
      const double u = static_cast<double>(i) / static_cast<double>(steps);
      time_s_ = start_s + u * duration_s;
      sample(u, move);
    }
  }

  void sample(double u, const nc::Move& move) {
    const Joints joints = joints_.at(u);
    track_.samples.push_back(
        {time_s_, static_cast<int>(move.block) + 1, joints_.chain().pose(joints, length_mm(move)), joints});
  }

  /// The tool is as long as it is, whether G43 is active or not.
  double length_mm(const nc::Move& move) const {
    const nc::ModalState& state = moves_.state_of(move);
    if (state.tool_length_mm.value_or(0) != 0) return *state.tool_length_mm;
    const auto same = std::ranges::find_if(moves_.states, [&](const nc::ModalState& s) {
      return s.tool == state.tool && s.tool_length_mm.value_or(0) != 0;
    });
    return same == moves_.states.end() ? 0 : *same->tool_length_mm;
  }

  std::size_t steps_of(const MoveJoints& now, const nc::Move& move) const {
    const Vec3 way_mm = joints_.at(1).linear_mm - joints_.at(0).linear_mm;
    double steps = std::max((now.end_rad - now.start_rad).lpNorm<Eigen::Infinity>() / options_.max_step_rad,
                            way_mm.lpNorm<Eigen::Infinity>() / options_.max_step_mm);
    if (move.arc != nc::Move::kNoArc) steps = std::max(steps, std::abs(moves_.arcs[move.arc].sweep_rad) / kArcStepRad);
    return static_cast<std::size_t>(
        std::clamp(std::ceil(steps), 1.0, static_cast<double>(options_.max_steps_per_move)));
  }

  double duration_s(const MoveJoints& now, const nc::Move& move) const {
    if (move.kind == nc::MoveKind::dwell) return move.dwell_s;
    if (now.g93_time_s > 0) return now.g93_time_s;
    const double feed = move.feed_mm_per_s;
    if (move.kind == nc::MoveKind::rapid || feed <= 0) return rapid_s(now);
    const double length_mm = nc::length_mm(moves_, move);
    if (length_mm > 0) return length_mm / feed;
    return deg_from_rad((now.end_rad - now.start_rad).norm()) / feed;  // only rotary axes: F is in degrees
  }

  double rapid_s(const MoveJoints& now) const {
    const Vec3 way_mm = joints_.at(1).linear_mm - joints_.at(0).linear_mm;
    double time_s = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      const double mm_per_s = machine_.axis[i].max_velocity_mm_per_s;
      const double rad_per_s = machine_.rotary[i].max_velocity_rad_per_s;
      time_s = std::max({time_s, std::abs(way_mm[axis]) / (std::isinf(mm_per_s) ? options_.rapid_mm_per_s : mm_per_s),
                         std::abs(now.end_rad[axis] - now.start_rad[axis]) /
                             (std::isinf(rad_per_s) ? options_.rapid_rad_per_s : rad_per_s)});
    }
    return time_s;
  }

  const machine::Machine& machine_;
  const nc::Interpretation& moves_;
  const PoseTrackOptions& options_;
  ProgramJoints joints_;
  PoseTrack track_;
  double time_s_ = 0;
};

}  // namespace

PoseTrack programmed_track(const machine::Machine& machine, const nc::Interpretation& moves,
                           const PoseTrackOptions& options) {
  return Tracker(machine, moves, options).run();
}

}  // namespace camber::kinematics
