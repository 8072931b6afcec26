#pragma once
// The page of camber feed: a machine with rotary axes as it runs a program.
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "feedmodel/timed_path.h"
#include "kinematics/chain.h"
#include "kinematics/pose_track.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::cli {

/// Predicted positions over a whole program; of a long one every second, fourth, ... period, and the last.
class TimedTrack {
 public:
  static constexpr std::size_t kMax = 40000;

  /// `moves` must outlive this.
  TimedTrack(const machine::Machine& machine, const nc::Interpretation& moves);
  /// As many of the one as of the other.
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

struct FeedPage {
  std::string program, machine;  ///< names
  feedmodel::FeedSummary summary;
  std::vector<kinematics::PoseSample> track;
};

/// UTF-8. Requires machine.kinematics.given().
std::string feed_page(const FeedPage& page, const nc::Interpretation& moves, const machine::Machine& machine,
                      const Diagnostics& found);

}  // namespace camber::cli
