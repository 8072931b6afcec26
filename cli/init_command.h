#pragma once
// camber init P.nc -o job.toml [--tools FILE]... [--machine M.toml|preset:NAME] [--material NAME]
// camber init --machine preset:NAME -o machine.toml
#include <string>
#include <vector>

#include "cli/global_options.h"
#include "nc/interpreter.h"

namespace camber::cli {

struct InitArguments {
  std::string program, output, machine;  ///< without a program, the machine is a preset that is written as a file
  std::vector<std::string> tools;        ///< tool tables and libraries; the first that knows something counts
  std::string material{};                ///< a name that machine::find_material knows; empty: the commonest
  nc::InterpreterOptions interpreter;
};

/// Writes a commented job that runs as it stands, from what the program and the tables tell, or a machine file. Throws
/// InputError; [file-exists] when the output is there already. Returns kDone.
int run_init(const InitArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
