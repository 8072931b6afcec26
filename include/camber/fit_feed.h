#pragma once
// Fits the feed model of a machine to programs and their traces.
#include <optional>
#include <string>
#include <vector>

#include "camber/machine.h"
#include "camber/program.h"
#include "camber/run.h"

namespace camber {
inline namespace v0 {

/// A program, and a record of its run: a servo trace, an MTConnect log or a table of stretch times.
struct FeedTrace {
  Program program;
  std::string trace;
};

struct FitFeedOptions {
  std::string columns{};  ///< column map of the servo traces (TOML); empty: Camber's own CSV
  bool update = false;    ///< refine `start`: its corner law stands, its numbers change where the traces determine them
  bool leave_one_out = false;  ///< also FitFeedResult::left_out: every servo trace predicted by a fit on the others
  bool block_time = false;     ///< also FitFeedResult::block_time_plot
  bool page = false;           ///< also FitFeedResult::page; needs a servo trace that names its lines
};

struct FitParameter {
  std::string name;  ///< key of the machine file
  double value = 0;
  std::string unit;
  std::optional<double> std_error;  ///< not given: not fitted, or the data does not determine it
  std::string note;
  bool written = true;                   ///< the value is written to the machine file
  int stretches = 0;                     ///< parts of the traces, or moves, that determine it; 0: not counted
  std::optional<double> changed_from{};  ///< value of the start file, where it differs
};

struct FitFeedResult {
  Machine machine;  ///< the fitted one
  std::vector<FitParameter> parameters{};
  bool converged = false;
  std::string message{};                  ///< how the fit ended
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string json{};                     ///< all figures, as `camber fit-feed --json` writes them
  std::string printed{};                  ///< the same, as `camber fit-feed` prints them
  std::string left_out{};                 ///< as it prints this
  std::string block_time_plot{};          ///< speed against block length of the saturated runs, SVG
  std::string page{};                     ///< as `camber fit-feed --report` writes it; may be empty
};

/// `start` provides the dialect of the control and the parameters that the traces do not determine. Throws InputError,
/// Cancelled.
CAMBER_API FitFeedResult fit_feed(const std::vector<FeedTrace>& traces, const Machine& start,
                                  const FitFeedOptions& options = {}, const RunOptions& run = {});

}  // namespace v0
}  // namespace camber
