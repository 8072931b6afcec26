#pragma once
// Cycle time by kind of operation and by tool.
#include <cstddef>
#include <string>
#include <vector>

#include "camber/machine.h"
#include "camber/program.h"
#include "camber/run.h"

namespace camber {
inline namespace v0 {

/// Times of one tool, or of all tools.
struct TimeUse {
  int tool = 0;
  std::size_t tool_changes = 0, cutting_moves = 0;
  double cutting_s = 0, positioning_s = 0, spindle_s = 0, tool_change_s = 0, m_code_s = 0, dwell_s = 0, index_s = 0,
         pallet_s = 0, total_s = 0;
  double cutting_length_mm = 0, positioning_length_mm = 0;
  double commanded_feed_mm_per_min = 0, average_feed_mm_per_min = 0;
  double e = 0;  ///< feed efficiency: average actual feed over commanded feed; 1 is as programmed
  double k = 0;  ///< F^2 / (a d) with commanded feed, acceleration and mean block length: the larger, the less of the
                 ///< feed is reached. Infinite without an acceleration limit
};

struct TimeOptions {
  std::string trace{};                ///< trace of trace of a measured run to compare with; empty: none
  std::vector<std::string> sweeps{};  ///< "axis.x.acceleration_mm_per_s2=3500:15000:4"
  std::string cases{};                ///< cases.toml: machines to compare; empty: none
  bool page = false;                  ///< also TimeResult::page
};

struct TimeResult {
  TimeUse all{};
  std::vector<TimeUse> tools{};  ///< in the order of their first use
  std::vector<TimeUse> sweep{};  ///< all tools, one row per combination of the swept values
  std::vector<TimeUse> cases{};  ///< all tools, one row per case
  std::vector<std::string> notes{};
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string json{};                     ///< all figures, as `camber time --json` writes them
  std::string printed{};                  ///< the same, as `camber time` prints them
  std::string page{};                     ///< the same, as `camber time --report` writes them
};

/// Throws InputError, Cancelled, std::invalid_argument for a sweep that cannot be read.
CAMBER_API TimeResult time(const Program& program, const Machine& machine, const TimeOptions& options = {},
                           const RunOptions& run = {});
/// The same of cases that name their machines.
CAMBER_API TimeResult time(const Program& program, const TimeOptions& options, const RunOptions& run = {});

/// Throws std::invalid_argument, with a sentence for the user, where TimeOptions::sweeps cannot have this text.
CAMBER_API void check_sweep(const std::string& text);

}  // namespace v0
}  // namespace camber
