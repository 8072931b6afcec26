#pragma once
// camber time: how long a program takes, by kind of operation and by tool; what-if; against a measured run.
#include <string>
#include <vector>

#include "cli/global_options.h"
#include "nc/interpreter.h"

namespace camber::cli {

struct TimeArguments {
  std::string program, machine;
  std::string json;                 ///< empty: none
  std::string trace;                ///< empty: none
  std::string cases;                ///< empty: none
  std::string report;               ///< empty: none
  std::vector<std::string> sweeps;  ///< KEY=FROM:TO:N
  nc::InterpreterOptions interpreter;
};

/// Throws InputError. Returns kDone.
int run_time(const TimeArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
