#pragma once
// --work-offset G54=X,Y,Z[,A,B,C]: what the operator has set at the control.
#include "nc/interpreter.h"

namespace CLI {
class App;
}

namespace camber::cli {

/// Fills work_offsets_mm and rotary_offsets_rad. `interpreter` must outlive the parsing.
void add_work_offsets(CLI::App& command, nc::InterpreterOptions& interpreter);

}  // namespace camber::cli
