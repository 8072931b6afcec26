#pragma once
// Checks of a program on a machine before it runs.
#include "base/diagnostics.h"
#include "machine/machine_model.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::motion {

/// At the program's blocks:
///  [axis-missing]   error, once: the program moves an axis that the machine file does not have;
///  [feed-limit]     warning: the programmed feed requires more of an axis than its max_velocity_mm_per_min;
///  [spindle-limit]  warning: S is over the spindle's max_rpm in a line or an arc.
/// The control clamps feed and spindle speed; each is said once between two tool changes, with the count.
void check_machine(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
                   Diagnostics& diagnostics);

/// Programmed feeds that no milling machine makes, more than 100 m/min: a warning [feed-absurd], once, at the first
/// place.
void check_feeds(const nc::Program& program, const nc::Interpretation& moves, Diagnostics& diagnostics);

/// A line straight up: the tool leaves what it has cut, as it may with the spindle stopped.
bool withdraws(const nc::Interpretation& moves, const nc::Move& move);

/// M3 or M4 stands in the program.
bool starts_spindle(const nc::Interpretation& moves);
/// Neither does, but an M function that only the machine's maker knows: it may start the spindle.
bool machine_may_start_spindle(const nc::Interpretation& moves);
inline constexpr const char* kSpindleAssumed =  ///< [spindle-assumed]
    "the program has S, but neither M3 nor M4; it is assumed that an M function of the machine's maker starts the "
    "spindle clockwise";

/// For a program without a job, where every line and arc but those straight up counts as a cut: errors
/// [spindle-stopped] and [spindle-direction] (cutters are right-hand; tapping aside), warning [spindle-assumed]. A
/// program without any spindle speed or start may be one to run in air, as `camber protocol` writes them: only a
/// warning.
void check_spindle(const nc::Program& program, const nc::Interpretation& moves, Diagnostics& diagnostics);

}  // namespace camber::motion
