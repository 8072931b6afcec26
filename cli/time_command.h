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

/// A key of machine.toml and the values that it takes in turn.
struct Sweep {
  std::string key;
  std::vector<double> values;
};

/// "axis.x.acceleration_mm_per_s2=3500:15000:4". Throws std::invalid_argument with a sentence for the user.
Sweep parse_sweep(const std::string& text);

/// Throws InputError. Returns kDone.
int run_time(const TimeArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
