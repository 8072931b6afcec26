#pragma once
// Joins the table of controls (machine/) to the table of NC dialects (nc/): interpreter options of a machine's control.
#include <optional>
#include <vector>

#include "machine/machine_model.h"
#include "nc/emit.h"
#include "nc/interpreter.h"
#include "nc/rotary.h"

namespace camber::kinematics {

/// The dialect of the control's programs. Requires kind.nc_dialect to name a dialect; static_asserts in
/// control_options.cpp check this for every row of the table of controls.
const nc::Dialect& dialect_of(const machine::ControlKind& kind);

/// `inch`: unit of a program without G20 and G21, where known. The rest follows from the dialect.
nc::InterpreterOptions interpreter_options(const machine::Machine& machine, std::optional<bool> inch);

/// Keeps the other options as given.
nc::InterpreterOptions interpreter_options(const machine::Machine& machine, nc::InterpreterOptions given);

/// For InterpreterOptions::rotary_axes, in the order A, B, C; empty without [kinematics].
std::vector<nc::RotaryOption> rotary_options(const machine::Machine& machine);

/// Decimals of the words that an edit adds or changes: those of the control's least increment, else as many as the
/// program's coordinates have, three or four in millimetres, one more in inches.
nc::EmitOptions decimals_for(const machine::Control& control, const nc::Program& program);

}  // namespace camber::kinematics
