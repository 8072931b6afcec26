#pragma once
// Which tooth passings make up the turn that `predict --forces-at LINE` shows.
#include <cstddef>

#include "base/diagnostics.h"
#include "simulate/predict_path.h"

namespace camber::simulate {

/// First stamp of one turn of the spindle in the middle of what line `line` (1-based) of the program cuts. Where the
/// line is shorter than a turn, its neighbours' stamps complete it. Error [forces-at] where the line cuts nothing;
/// warning [forces-at] where the cut around it is shorter than a turn (teeth without a stamp then show no force).
std::size_t turn_at_line(const SimulatedProgram& program, const machine::Job& job, std::size_t line,
                         Diagnostics& diagnostics);

}  // namespace camber::simulate
