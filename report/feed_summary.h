#pragma once
// The figures of camber feed: JSON, text for a terminal, and the page of a machine with rotary axes.
#include <string>
#include <vector>

#include "feedmodel/timed_path.h"
#include "kinematics/pose_track.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::report {

/// The figures as JSON text, with a line end.
std::string feed_json(const feedmodel::FeedSummary& summary);

/// The same for a terminal.
std::string feed_text(const feedmodel::FeedSummary& summary);

struct FeedPage {
  std::string program;  ///< name
  feedmodel::FeedSummary summary;
  std::vector<kinematics::PoseSample> track;
  std::vector<std::string> warnings;
};
/// The machine as it runs the program, UTF-8. Requires machine.kinematics.given().
std::string feed_page(const FeedPage& page, const nc::Interpretation& moves, const machine::Machine& machine);

}  // namespace camber::report
