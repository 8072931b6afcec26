#pragma once
// cases.toml: machines and programs to set side by side.
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostics.h"
#include "machine/machine_model.h"

namespace camber::machine {

struct CycleCase {
  std::string name;     ///< name of its table: [case.NAME]
  std::string title;    ///< what it stands for; empty: none
  std::string program;  ///< empty: the program of the command line
  Machine machine;      ///< with `set` done
};

/// Reads [case.NAME] tables, in alphabetical order of their names. Keys: title; machine (a machine.toml; without it the
/// machine of the command line, if any); program; set, a table of machine keys and numbers:
///
///   [case.2]
///   title = "twice the acceleration"
///   machine = "conventional.toml"
///   set = { "axis.all.acceleration_mm_per_s2" = 7000 }
///
/// Paths count from the file's folder. Throws InputError with file:line:column.
std::vector<CycleCase> read_cases(const std::string& path, const Machine* fallback, Diagnostics& diagnostics);

}  // namespace camber::machine
