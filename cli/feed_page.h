#pragma once
// The page of camber feed: a machine with rotary axes as it runs a program.
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "feedmodel/timed_path.h"
#include "kinematics/pose_track.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::cli {

struct FeedPage {
  std::string program, machine;  ///< names
  feedmodel::FeedSummary summary;
  std::vector<kinematics::PoseSample> track;
};

/// UTF-8. Requires machine.kinematics.given().
std::string feed_page(const FeedPage& page, const nc::Interpretation& moves, const machine::Machine& machine,
                      const Diagnostics& found);

}  // namespace camber::cli
