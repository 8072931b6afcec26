#pragma once
// Whether the joints of a program stay within the travel and the speed of their axes.
#include "base/diagnostics.h"
#include "machine/machine_model.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::kinematics {

/// At the program's blocks, each said once for each axis, at its first place with the number of moves:
///  [travel]            error: a joint leaves its travel, also one that the program does not name;
///  [tool-direction]    error: the rotary axes cannot give the tool the direction of G43.5, or two linear axes are
///                      parallel at its angles;
///  [clamped]           error: G53.1, G43.5, G28 or G30 turns an axis that clamp_codes have clamped;
///  [rotary-speed]      warning: the programmed feed asks more of a rotary axis than its max_velocity_deg_per_min, as
///                      near the pole;
///  [travel-unchecked]  warning, for programs with rotary words: X, Y, Z are not checked, as the work offset or the
///                      tool length is not known.
/// Moves are looked at in steps of at most half a degree of the rotary axes. Requires machine.kinematics.given().
void check_travel(const machine::Machine& machine, const nc::Program& program, const nc::Interpretation& moves,
                  Diagnostics& diagnostics);

}  // namespace camber::kinematics
