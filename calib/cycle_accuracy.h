#pragma once
// Comparison of a predicted program time with a measured run.
#include <cstdint>
#include <vector>

#include "calib/trace.h"
#include "feedmodel/cycle_time.h"

namespace camber::calib {

struct TimePair {
  double measured_s = 0, predicted_s = 0;
  /// (predicted - measured) / measured; 0 where nothing was measured.
  double error_percent() const;
};

struct MeasuredPart {
  std::uint32_t line_first = 0, line_last = 0;  ///< 1-based
  TimePair time;
};

struct CycleAccuracy {
  TimePair total;  ///< measured from the first to the last commanded motion
  bool has_lines = false;
  /// By the line being commanded, with has_lines. Time without a line (the control waits) counts as dwell.
  TimePair cutting, positioning, dwell;
  std::vector<MeasuredPart> parts;  ///< runs of feed moves of one feed; with has_lines, those that were run
};

/// `time`: cycle_time of the program that was run.
CycleAccuracy cycle_accuracy(const ServoTrace& trace, const nc::Interpretation& program,
                             const feedmodel::CycleTime& time);

}  // namespace camber::calib
