#pragma once
// Programmed durations of moves: by F alone, without the control's limits.
#include "nc/move.h"
#include "nc/program_text.h"
#include "nc/reporter.h"

namespace camber::nc {

/// Length over programmed feed, or the dwell; 0 for rapids.
double programmed_time_s(const Interpretation& program, const Move& move);
/// Sum over all moves without rapids.
double programmed_time_s(const Interpretation& program);

/// Upper bound of a plausible line, arc or dwell: a day.
constexpr double kMaxMove_s = 24 * 3600;

/// Error [block-time] for moves that take longer than kMaxMove_s: a feed or a dwell in a wrong unit, or a wrong digit.
void check_durations(const Program& text, const Interpretation& program, Reporter& report);

}  // namespace camber::nc
