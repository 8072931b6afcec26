#pragma once
// camber check: read and interpret a program, report, change nothing; with a machine or a job also whether they fit.
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>

#include "base/diagnostics.h"
#include "kinematics/feed_meaning.h"
#include "nc/interpreter.h"
#include "nc/summary.h"

namespace camber::cli {

struct CheckCommand {
  std::string program;             ///< empty: the job's
  std::string json;                ///< file for the figures; empty: none
  std::string report;              ///< page with the path's picture; empty: none
  std::string path{};              ///< file for the path's points; of several programs the first; empty: none
  std::string machine;             ///< machine.toml; empty: none
  std::string job;                 ///< job.toml, whose machine counts; empty: none
  std::string sheet{};             ///< set-up sheet; needs a job; empty: none
  std::string explain_kinematics;  ///< machine.toml or job.toml to explain instead of a program; empty: none
  nc::InterpreterOptions interpreter;
};

/// Writes a short report to `out` and, where asked for, the same figures as JSON and as a page with a picture. Warnings
/// go to `diagnostics` in the order of the file. Throws InputError, likewise in order, when the program cannot be read;
/// then no file is written. Returns 0. `before_output`: called before anything is written to `out`.
int run_check(const CheckCommand& command, Diagnostics& diagnostics, std::ostream& out,
              const std::function<void()>& before_output = {});

/// Prints the kinematic chain of a machine, and writes it as JSON where asked for. Throws InputError. Returns 0.
int run_explain_kinematics(const CheckCommand& command, Diagnostics& diagnostics, std::ostream& out);

/// The report as it is printed.
std::string check_report(const nc::Program& text, const nc::Summary& summary, const Diagnostics& diagnostics,
                         std::optional<double> memory_bytes = {},
                         const std::vector<kinematics::FeedMeaningUse>& feed_meanings = {});

}  // namespace camber::cli
