#pragma once
// What a machine's MTConnect adapter reported while a program ran: line, feed, positions, some times a second.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "calib/stretch.h"
#include "calib/trace.h"

namespace camber::calib {

/// An item's value from its time on.
struct LogEvent {
  double t_s = 0;  ///< after the first event of the log
  double value = 0;
};

struct MachineLog {
  std::string path;
  std::vector<LogEvent> line;                        ///< 1-based line of the program
  std::vector<LogEvent> feed_mm_per_s;               ///< along the path
  std::vector<LogEvent> override_percent;            ///< of the feed
  std::array<std::vector<LogEvent>, 3> position_mm;  ///< X, Y, Z
  std::vector<double> any_s;                         ///< times of all events: where none come, events are missing
};

/// Whether a file looks like such a log: its first line has two bars.
bool is_machine_log(const std::string& path);

/// Reads lines `timestamp|item|value`, or more pairs of item and value in a line; timestamps as
/// 2017-02-14T14:56:22.9058750Z. Items, whatever their case and underscores: the line is Block_Number, Line_Number,
/// line or linenumber; the feed Feed_Rate, Path_Feedrate, Fact or feed; the override Feed_Override,
/// Path_Feedrate_Override or Fovr; positions Xabs, Xact, Xpos, X_Position (Y and Z alike) or Path_Position with three
/// numbers. Others, and values that are empty or UNAVAILABLE, are left out.
///
/// Throws InputError: [log-time], [log-number], [log-item] (neither lines nor positions in the file), [log-fields]
/// (more than a twentieth of the lines are of another form), [file-missing]. Warnings: [log-time] where an event is
/// older than the one before it, [log-fields] for the first lines of another form; these are left out.
MachineLog read_machine_log(const std::string& path, Diagnostics& diagnostics);

/// The time of every stretch of `stretches` that the log holds whole: from the first event that names a line of it to
/// the first that names another one, with the override at which it was cut. Left out are those in which the override
/// changes, with a feed hold (feed 0 for longer than `hold_s`), with a hole in the log (no event at all for `hole_s`),
/// or of which less than three events tell.
/// The error of each end is up to one interval of the adapter; see `sigma_s`.
std::vector<TimedStretch> logged_stretches(const MachineLog& log, const std::vector<FeedStretch>& stretches);

/// Whether the log has all three positions.
bool has_positions(const MachineLog& log);

/// Its positions as actual ones; between its events an axis stands. Requires has_positions.
ServoTrace position_trace(const MachineLog& log);

/// The override (1: 100 %) from one time to another; nothing where it changes, the feed is held, or events are missing.
std::optional<double> steady_override(const MachineLog& log, double from_s, double to_s);

}  // namespace camber::calib
