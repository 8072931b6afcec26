#pragma once
// Block processing time from a saturated run: chords of several lengths at a feed that the control cannot keep up with.
#include <optional>
#include <string>
#include <vector>

#include "calib/fit_drive.h"
#include "calib/trace.h"
#include "nc/move.h"

namespace camber::calib {

/// A run of lines of one length.
struct ChordRun {
  std::uint32_t line_first = 0, line_last = 0;
  double chord_mm = 0;
  double feed_mm_per_s = 0;   ///< programmed
  double speed_mm_per_s = 0;  ///< V_s, mean over the middle half
  double block_time_s = 0;    ///< T = L_b / V_s
  double resolution_s = 0;    ///< uncertainty of T: a period over the number of blocks
  bool saturated = false;     ///< slower than the feed, and with the smallest T
};

struct BlockTimeFit {
  std::vector<ChordRun> runs;
  std::optional<FittedValue> block_time_s;  ///< nothing where the runs do not tell
  std::string message;                      ///< one sentence
};

/// T_b = 60000 L_b / V_s (ms, mm, mm/min).   Source: Takata 1999.
/// Every limit but the block time makes T longer the shorter the chords are compared with what limits, so the
/// saturated runs are those whose T lies within 5 % of the minimum: at least two lengths must agree. Lines come from
/// the trace's line column. Runs have at least 20 lines whose lengths agree within 3 %.
BlockTimeFit fit_block_time(const std::vector<std::pair<const nc::Interpretation*, const ServoTrace*>>& runs);

}  // namespace camber::calib
