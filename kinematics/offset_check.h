#pragma once
// Whether the work offset and the tool lengths are known where a program needs them.
#include <cstdint>

#include "base/diagnostics.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::kinematics {

/// What is asked of a program with rotary motion. A move needs the work offset and the length of its tool where
/// that depends on them:
///  times, in X Y Z and angles as programmed: in tilted frames and under G254;
///  joints: under tool-centre-point control as well;
///  poses of the tool: as joints; elsewhere what is not known counts as 0, with a warning;
///  the tool on the part: in every move;
///  tip_control alone: the tool length, under tool-centre-point control.
enum class Asked : std::uint8_t { times, joints, poses, part, tip_control };

/// At the program's blocks, of the first move that needs it:
///  [work-offset], [tool-length]  error: it is not known;
///  [pose-unknown]                warning, for poses: tip and axis are reckoned with unknown values taken as 0.
void check_offsets(const nc::Program& program, const nc::Interpretation& moves, Asked asked, Diagnostics& diagnostics);

/// Whether positions of the axes follow from the program: work offset and tool lengths are known wherever it moves.
bool offsets_known(const nc::Interpretation& moves);

}  // namespace camber::kinematics
