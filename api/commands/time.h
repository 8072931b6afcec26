#pragma once
// The work of camber time: a program timed on a machine, on a machine with swept numbers, or in several cases.
#include <functional>
#include <string>
#include <vector>

#include "api/commands/time_report.h"
#include "base/diagnostics.h"
#include "machine/machine.h"
#include "nc/interpreter.h"
#include "nc/program.h"
#include "report/machine_page.h"
#include "report/path_card.h"

namespace camber::api {

/// A key of machine.toml and the values that it takes in turn.
struct Sweep {
  std::string key;
  std::vector<double> values;
};

/// "axis.x.acceleration_mm_per_s2=3500:15000:4". Throws std::invalid_argument with a sentence for the user.
Sweep parse_sweep(const std::string& text);

struct TimeRequest {
  std::string program;                ///< file; with `text` only its name
  const nc::Program* text = nullptr;  ///< read already; null: the file is read
  std::string machine_path;
  const machine::Machine* machine = nullptr;  ///< null: every case brings its own
  std::string trace, cases;                   ///< files; empty: none
  std::vector<std::string> sweeps;            ///< KEY=FROM:TO:N
  nc::InterpreterOptions interpreter;
  bool picture = false;  ///< makes a picture of the path, for a page
  std::function<void(double share)> progress;
};

struct TimedProgram {
  TimeReport report;
  report::PathPicture picture;   ///< picture of the first row
  report::MachineCards machine;  ///< instead of it, where that program turns rotary axes
};

/// Throws InputError, and std::invalid_argument for a sweep that cannot be read.
TimedProgram time_program(const TimeRequest& request, Diagnostics& diagnostics);

}  // namespace camber::api
