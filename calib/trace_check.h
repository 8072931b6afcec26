#pragma once
// Whether a trace is of the program that it is given with, run at its programmed feeds.
#include "base/diagnostics.h"
#include "calib/fit_feed_model.h"

namespace camber::calib {

/// A trace that contradicts its program must not be fitted. Errors, at the line of the trace:
/// [trace-program] lines that the program does not have, and ways between the ends of lines that are not the program's;
/// [trace-axes] these ways agree with axes exchanged or turned round, [trace-units] in another unit (of time: held
/// speeds are a thousand times the feeds, or a thousandth);
/// [trace-time] the time goes on by more than the motion does;
/// [trace-override] held speeds are a fraction of the feeds that no axis explains, or above them; the axes stand still
/// inside a line (a feed hold).
/// A trace without lines is checked for its times alone.
void check_trace(const FeedRun& run, const machine::Machine& machine, Diagnostics& diagnostics);

}  // namespace camber::calib
