#pragma once
// What a machine's MTConnect adapter reported while a program ran: line and feed, some times a second.
#include <cstdint>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "calib/stretch.h"

namespace camber::calib {

/// An item's value from its time on.
struct LogEvent {
  double t_s = 0;  ///< after the first event of the log
  double value = 0;
};

struct MachineLog {
  std::string path;
  std::vector<LogEvent> line;              ///< Block_Number: 1-based line of the program
  std::vector<LogEvent> feed_mm_per_s;     ///< Feed_Rate
  std::vector<LogEvent> override_percent;  ///< Feed_Override
  std::vector<double> any_s;               ///< times of all events: where none come, events are missing
};

/// Whether a file looks like such a log: its first line has two bars.
bool is_machine_log(const std::string& path);

/// Reads lines `timestamp|item|value`, timestamps as 2017-02-14T14:56:22.9058750Z; items that are not known and
/// values that are empty or UNAVAILABLE are left out. Throws InputError: [log-time], [log-number], [log-item] (no
/// Block_Number in the file), [log-fields] (more than a twentieth of the lines are of another form), [file-missing].
/// Warnings: [log-time] where an event is older than the one before it, [log-fields] for the first lines of another
/// form; these are left out.
MachineLog read_machine_log(const std::string& path, Diagnostics& diagnostics);

/// The time of every stretch of `stretches` that the log holds whole: from the first event that names a line of it to
/// the first that names another one. Left out are those cut at an override other than 100 %, with a feed hold
/// (feed 0 for longer than `hold_s`), with a hole in the log (no event at all for `hole_s`), or of which less than
/// three events tell.
/// The error of each end is up to one interval of the adapter; see `sigma_s`.
std::vector<TimedStretch> logged_stretches(const MachineLog& log, const std::vector<FeedStretch>& stretches);

}  // namespace camber::calib
