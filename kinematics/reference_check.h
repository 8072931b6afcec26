#pragma once
// Ways to reference points that the machine file does not give.
#include "base/diagnostics.h"
#include "machine/machine_model.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::kinematics {

/// [reference-unknown]  warning, at the first G28 or G30 that takes a linear axis to a point that neither
///                      [reference_point] nor [tool_change] gives: where place_moves (machine_moves.h) takes it to be.
/// Nothing without rotary motion. Requires machine.kinematics.given().
void check_reference_points(const machine::Machine& machine, const nc::Program& program,
                            const nc::Interpretation& moves, Diagnostics& diagnostics);

/// The reference point of G28 (0) or G30 (1 to 3) of an axis, in program coordinates. Infinite where the machine file
/// has none.
double reference_point_mm(const machine::Machine& machine, std::size_t point, int axis);

}  // namespace camber::kinematics
