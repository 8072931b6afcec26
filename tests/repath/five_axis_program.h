#pragma once
// A five-axis program as `camber post` gets it: read, interpreted, its joints known.
#include <string>

#include "feedmodel/control_options.h"
#include "kinematics/program_joints.h"
#include "kinematics/rotary_options.h"
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
  options = feedmodel::interpreter_options(machine, options);
  options.work_offsets_mm[54] = Vec3(0, 0, -100);
  options.tool_offsets[1].length_mm = 80;
  Diagnostics diagnostics;
  FiveAxisProgram r;
  r.program = nc::read_program(SourceText("p.nc", text), diagnostics);
  r.moves = nc::interpret(r.program, options, diagnostics);
  diagnostics.throw_if_errors();
  kinematics::place_lines(r.moves, machine);
  return r;
}

}  // namespace camber::tests
