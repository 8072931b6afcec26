#pragma once
// How a machine's control reads a program.
#include <optional>

#include "machine/machine.h"
#include "nc/interpreter.h"

namespace camber::feedmodel {

inline nc::ControlKind control_kind(machine::Dialect dialect) {
  switch (dialect) {
    case machine::Dialect::haas:
      return nc::ControlKind::haas;
    case machine::Dialect::mazak:
      return nc::ControlKind::mazak;
    case machine::Dialect::linuxcnc:
      return nc::ControlKind::linuxcnc;
    case machine::Dialect::fanuc:
      break;
  }
  return nc::ControlKind::fanuc;
}

/// `inch`: unit of a program without G20 and G21, where it is told. The rest is nc's table of dialects.
inline nc::InterpreterOptions interpreter_options(const machine::Machine& machine, std::optional<bool> inch) {
  nc::InterpreterOptions options;
  options.inch = inch;
  options.control = control_kind(machine.control.dialect);
  options.dwell_p_is_ms = options.dialect().dwell_p_is_ms;
  return options;
}

/// With the other options as given.
inline nc::InterpreterOptions interpreter_options(const machine::Machine& machine, nc::InterpreterOptions given) {
  given.control = control_kind(machine.control.dialect);
  given.dwell_p_is_ms = given.dialect().dwell_p_is_ms;
  return given;
}

}  // namespace camber::feedmodel
