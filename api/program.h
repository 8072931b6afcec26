#pragma once
// What stands behind camber::Program.
#include "base/diagnostics.h"
#include "camber/program.h"
#include "nc/interpreter.h"
#include "nc/program.h"

namespace camber {

struct Program::Impl {
  std::string path;
  nc::Program text;
  nc::InterpreterOptions options;
  Diagnostics found;  ///< in the text
};

}  // namespace camber
