#pragma once
// What stands behind camber::Program.
#include "base/diagnostics.h"
#include "camber/program.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"

namespace camber {

struct Program::Impl {
  std::string path;
  nc::Program text;
  nc::InterpreterOptions options;
  Diagnostics found;  ///< in the text
};

namespace api {

/// `path`: of the program, in messages. Throws InputError for a value that is not valid.
nc::InterpreterOptions interpreter_options(const ReadOptions& options, const std::string& path);

template <class Figures>
ProgramCounts counts_of(const Figures& f) {
  return {f.blocks, f.lines, f.arcs, f.length_mm};
}

}  // namespace api
}  // namespace camber
