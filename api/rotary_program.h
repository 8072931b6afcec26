#pragma once
// Programs with rotary axes for camber time and camber feed.
#include "base/diagnostics.h"
#include "machine/machine.h"
#include "nc/interpreter.h"
#include "nc/program.h"

namespace camber::api {

/// Options with which a program is read as the control of the machine does, with the rotary axes of its chain.
nc::InterpreterOptions rotary_interpreter_options(const machine::Machine& machine, nc::InterpreterOptions given);

/// Nothing without rotary motion. Otherwise what kinematics::check_travel and check_reference_points say, and
///  [tool-length], [work-offset]  error: a tilted frame, G254 or tool-centre-point control where its joints count
///  (always
///                                with `poses`) needs a length or an offset that is not known;
///  [pose-unknown]                warning, with `poses`: tip and axis are reckoned with unknown values taken as 0;
///  [rotary-limits]               warning: an axis that turns has no speed or acceleration limit in the machine file.
/// poses: joints and poses of the tool are asked for, not only times.
void check_rotary_motion(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
                         bool poses, Diagnostics& diagnostics);

/// Lines as the machine runs them, in the frames of the program (kinematics::place_lines). Nothing without rotary
/// motion.
void place_rotary_lines(const machine::Machine& machine, nc::Interpretation& moves);

/// Moves as the machine runs them (kinematics::place_moves). Nothing without rotary motion.
void place_rotary_moves(const machine::Machine& machine, nc::Interpretation& moves);

/// Whether positions of the axes follow from the program: work offset and tool lengths are known wherever it moves.
bool joints_known(const nc::Interpretation& moves);

/// The check [tool-length] alone, under tool-centre-point control: without a length this control means nothing.
void check_tip_lengths(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
                       Diagnostics& diagnostics);

/// The checks [tool-length] and [work-offset] alone: for traces, whose tip motion is examined.
void check_tip_control(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
                       Diagnostics& diagnostics);

}  // namespace camber::api
