#pragma once
// camber init P.nc -o job.toml [--tools FILE]... [--machine M.toml]
#include <string>
#include <vector>

#include "cli/global_options.h"
#include "nc/interpreter.h"

namespace camber::cli {

struct InitArguments {
  std::string program, output, machine;
  std::vector<std::string> tools;  ///< tool tables and libraries; the first that knows something counts
  std::string material{};          ///< preset; empty: to be filled in
  nc::InterpreterOptions interpreter;
};

/// Writes a commented job file from what the program and the tables tell. Throws InputError; [file-exists] when the
/// output is there already. Returns kDone.
int run_init(const InitArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
