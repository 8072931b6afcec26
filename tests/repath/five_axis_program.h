#pragma once
// A five-axis program as `camber post` gets it: read, interpreted, its joints known.
#include <string>

#include "kinematics/control_options.h"
#include "kinematics/machine_program.h"
#include "kinematics/program_joints.h"
#include "nc/interpreter.h"

namespace camber::tests {

struct FiveAxisProgram {
  nc::Program program;
  nc::Interpretation moves;
};

/// With G54 100 mm below the machine's zero and tool 1 80 mm long.
inline FiveAxisProgram read_five_axes(const std::string& text, const machine::Machine& machine) {
  nc::InterpreterOptions options;
  options.inch = false;
  options.rotary_axes = kinematics::rotary_options(machine);
  options = kinematics::interpreter_options(machine, options);
  options.work_offsets_mm[54] = Vec3(0, 0, -100);
  options.tool_offsets[1].length_mm = 80;
  Diagnostics diagnostics;
  FiveAxisProgram r;
  r.program = nc::read_program(SourceText("p.nc", text), diagnostics);
  r.moves = nc::interpret(r.program, options, diagnostics);
  diagnostics.throw_if_errors();
  r.moves = kinematics::MachineProgram({}, r.moves, machine).moves_in_program();
  return r;
}

}  // namespace camber::tests
