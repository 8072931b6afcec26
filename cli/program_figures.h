#pragma once
// What compress and resegment tell of a program, before and after.
#include <cstddef>

#include "nc/interpreter.h"
#include "nc/program.h"

namespace camber::cli {

/// Blocks that hold a word; cutting moves that are lines and arcs, and their length.
struct ProgramFigures {
  std::size_t blocks = 0, lines = 0, arcs = 0;
  double length_mm = 0;
};
ProgramFigures figures_of(const nc::Program& program, const nc::Interpretation& moves);

}  // namespace camber::cli
