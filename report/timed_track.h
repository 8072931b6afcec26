#pragma once
// Predicted positions of a machine with rotary axes over a whole program, for the pages that show it run.
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "feedmodel/timed_path.h"
#include "kinematics/chain.h"
#include "kinematics/pose_track.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::report {

/// Predicted positions over a whole program; of a long one every second, fourth, ... period, and the last.
class TimedTrack {
 public:
  static constexpr std::size_t kMax = 40000;

  /// `moves` must outlive this.
  TimedTrack(const machine::Machine& machine, const nc::Interpretation& moves);
  /// Adds samples. Requires as many of one kind as of the other.
  void add(std::span<const feedmodel::TimedSample> samples, std::span<const feedmodel::JointSample> joints);
  std::vector<kinematics::PoseSample> take();

 private:
  kinematics::PoseSample pose_of(const feedmodel::TimedSample& sample, const feedmodel::JointSample& joint) const;

  const nc::Interpretation& moves_;
  std::optional<kinematics::Chain> chain_;  ///< where the machine has one
  std::map<int, double> tool_length_mm_;    ///< that the program gives a tool anywhere
  std::vector<kinematics::PoseSample> kept_;
  kinematics::PoseSample last_;
  std::size_t every_ = 1, seen_ = 0;
};

/// The track of a whole program with rotary motion. Requires kinematics::has_rotary_motion.
std::vector<kinematics::PoseSample> timed_track(const machine::Machine& machine, const nc::Interpretation& moves);

}  // namespace camber::report
