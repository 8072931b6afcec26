#pragma once
// A servo trace on the moves of the program that it was taken of: the motion that predict cuts at in place of the feed
// model's.
#include <cstdint>
#include <vector>

#include "base/diagnostics.h"
#include "calib/trace.h"
#include "feedmodel/timed_path.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::calib {

struct TracedMotion {
  /// Samples like those of predict_feed: position_mm is where the axes were, command_mm what the control commanded
  /// (without these columns the same), `move` the move being commanded.
  std::vector<feedmodel::TimedSample> samples;
  bool by_line = false;        ///< matched by the line column; else by place
  double period_s = 0;         ///< median
  double time_s = 0;           ///< from the first motion to the last
  double cutting_time_s = 0;   ///< of it, in G1, G2 and G3
  double off_path_p95_mm = 0;  ///< distance of the axes from the programmed path in the cut, 95th percentile
  double off_path_max_mm = 0;
};

/// Beyond this distance from the programmed path a sample in the cut is of another program.
inline constexpr double kMaxOffPath_mm = 1.0;
/// So far may the 95th percentile be off.
inline constexpr double kMaxTypicalOffPath_mm = 0.5;

/// Matches the samples to the moves: by the `line` column where the trace has one, in the order in which the program
/// runs; without it each commanded position (or actual one) follows the path from the place before it. Lines that a
/// control merges into one segment count as commanded together.
///
/// `cut`: one per move, those that are to be cut. There a trace must be whole. Errors, at the line of the trace:
/// [trace-column] (one of x_act_mm y_act_mm z_act_mm is missing), [trace-gap] (a gap in the cut; elsewhere gaps do not
/// matter), [trace-program] (lines that the program does not have or does not run in this order, positions off its
/// path, parts of the cut passed over), [trace-end] (the trace ends before the cut does). Throws InputError.
TracedMotion traced_motion(const ServoTrace& trace, const nc::Program& text, const nc::Interpretation& program,
                           const std::vector<bool>& cut, Diagnostics& diagnostics);

}  // namespace camber::calib
