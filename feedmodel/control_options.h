#pragma once
// How a machine's control reads a program.
#include <optional>

#include "machine/machine.h"
#include "nc/interpreter.h"

namespace camber::feedmodel {

/// `inch`: unit of a program without G20 and G21, where it is told. Only LinuxCNC counts a dwell's integer P in seconds.
inline nc::InterpreterOptions interpreter_options(const machine::Machine& machine, std::optional<bool> inch) {
  nc::InterpreterOptions options;
  options.inch = inch;
  options.dwell_p_is_ms = machine.control.dialect != machine::Dialect::linuxcnc;
  return options;
}

}  // namespace camber::feedmodel
