#pragma once
// The work of camber check: a program interpreted, checked and summarized.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "kinematics/feed_meaning.h"
#include "machine/job_file.h"
#include "nc/interpreter.h"
#include "nc/summary.h"

namespace camber::api {

struct CheckedProgram {
  nc::Interpretation moves;
  nc::Summary summary;
  std::vector<kinematics::FeedMeaningUse> feed_meanings{};  ///< meanings of F in a program that turns rotary axes
  std::optional<double> memory_bytes{};                     ///< that predict needs, about; of a job alone
};

/// Called with a program that could be read, before it is checked against machine and job.
using ProgramRead = std::function<void(const nc::Interpretation&)>;

/// Reads a program as the control of `machine` does, where one is given. `job` (with its machine as `machine`) also
/// has its tools, stock and part checked, and then everything that predict checks before its cut (predict.h,
/// prepare). `options`: options of the user. Throws InputError.
CheckedProgram check_program(const nc::Program& text, const nc::InterpreterOptions& options,
                             const machine::Machine* machine, const machine::Job* job, Diagnostics& found,
                             const ProgramRead& read = {});

/// By line and column.
std::vector<Diagnostic> in_order(std::vector<Diagnostic> list);

/// "mm", "inch" or "mm and inch".
std::string unit_text(const nc::Summary& summary);

/// The figures of a report as JSON text, with a line end.
std::string check_json(const nc::Program& text, const nc::Summary& summary, const Diagnostics& diagnostics,
                       std::optional<double> memory_bytes = {},
                       const std::vector<kinematics::FeedMeaningUse>& feed_meanings = {});

}  // namespace camber::api
