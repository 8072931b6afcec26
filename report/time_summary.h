#pragma once
// The figures of camber time: JSON, text for a terminal, and the page.
#include <optional>
#include <string>
#include <vector>

#include "calib/cycle_accuracy.h"
#include "feedmodel/timed_path.h"
#include "kinematics/pose_track.h"
#include "machine/machine_model.h"
#include "nc/move.h"
#include "report/cycle_page.h"

namespace camber::report {

struct TimeSummary {
  std::string program, machine;
  std::vector<std::string> keys{};  ///< swept
  std::vector<CycleRow> rows{};     ///< one, or one a case or point
  std::optional<calib::CycleAccuracy> accuracy{};
  std::vector<std::string> notes{};
  PathPicture picture{};  ///< for the page: picture of the first row
  MachineCards cards{};   ///< instead of it, where that program turns rotary axes
};

std::string time_text(const TimeSummary& summary);

/// The same figures as JSON text, with a line end. Of the first row at the top; all rows in `sweep` or `cases`.
std::string time_json(const TimeSummary& summary);

/// The page's text, see cycle_page.
std::string time_page(const TimeSummary& summary);

// The figures of camber feed: JSON, text for a terminal, and the page of a machine with rotary axes.

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
