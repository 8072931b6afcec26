#pragma once
// How a machine's control reads a program.
#include <optional>

#include "machine/machine.h"
#include "nc/interpreter.h"

namespace camber::feedmodel {

/// What the controls do differently with G10, G41, G52, G68 (docs/nc-language.md, Dialects). LinuxCNC's facts are the
/// defaults of InterpreterOptions; Haas and Mazak EIA follow Fanuc but for what is said here.
inline void set_frame_facts(nc::InterpreterOptions& options, machine::Dialect dialect) {
  const bool linuxcnc = dialect == machine::Dialect::linuxcnc;
  options.g52_is_g92 = options.g41_1_has_diameter = linuxcnc;
  options.g10_adds_in_g91 = options.g10_p0_is_external = options.g10_l20_is_g54_1 = !linuxcnc;
  options.radius_corner_lines = options.radius_entry_square = options.radius_exit_waits = !linuxcnc;
  options.radius_look_ahead = linuxcnc ? 1000000 : 1;
  options.rotation_r_adds_in_g91 = dialect == machine::Dialect::haas;
}

/// `inch`: unit of a program without G20 and G21, where it is told. Only LinuxCNC counts a dwell's integer P in
/// seconds.
inline nc::InterpreterOptions interpreter_options(const machine::Machine& machine, std::optional<bool> inch) {
  nc::InterpreterOptions options;
  options.inch = inch;
  options.dwell_p_is_ms = machine.control.dialect != machine::Dialect::linuxcnc;
  set_frame_facts(options, machine.control.dialect);
  return options;
}

}  // namespace camber::feedmodel
