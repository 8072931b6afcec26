#pragma once
// Programs written as text, interpreted.
#include <stdexcept>
#include <string>

#include "nc/interpreter.h"
#include "nc/program_text.h"

namespace camber::tests {

inline nc::Interpretation interpreted(const std::string& text, nc::InterpreterOptions options = {}) {
  options.inch = false;
  Diagnostics diagnostics;
  const nc::Program program = nc::read_program(SourceText("test.nc", text), diagnostics);
  nc::Interpretation moves = nc::interpret(program, options, diagnostics);
  diagnostics.throw_if_errors();
  return moves;
}

}  // namespace camber::tests
