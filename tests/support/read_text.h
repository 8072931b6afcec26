#pragma once
// A program read and interpreted, with whatever it says.
#include <string>

#include "nc/interpreter.h"

namespace camber::tests {

struct Read {
  nc::Program program;
  nc::Interpretation moves;
};

/// Throws InputError where the text has errors; warnings are passed over.
inline Read read(const std::string& text) {
  Diagnostics diagnostics;
  Read out;
  out.program = nc::read_program(SourceText("p.nc", text), diagnostics);
  out.moves = nc::interpret(out.program, {}, diagnostics);
  diagnostics.throw_if_errors();
  return out;
}

}  // namespace camber::tests
