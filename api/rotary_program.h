#pragma once
// Programs with rotary axes for camber time and camber feed.
#include "base/diagnostics.h"
#include "machine/machine_model.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"

namespace camber::api {

/// Nothing without rotary motion. Otherwise what kinematics::check_travel and check_reference_points say, and
///  [tool-length], [work-offset], [pose-unknown]  see kinematics::check_offsets, for the poses, or for what times need;
///  [rotary-limits]               warning: an axis that turns has no speed or acceleration limit in the machine file.
/// poses: joints and poses of the tool are asked for, not only times.
void check_rotary_motion(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
                         bool poses, Diagnostics& diagnostics);

}  // namespace camber::api
