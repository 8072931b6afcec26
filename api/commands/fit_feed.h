#pragma once
// The work of camber fit-feed: traces read with their programs, and the fit that they allow.
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/diagnostics.h"
#include "calib/fit_feed_model.h"
#include "calib/fit_stretches.h"
#include "machine/machine.h"
#include "nc/interpreter.h"
#include "nc/program.h"

namespace camber::api {

/// A program that was run and what the machine did.
struct TracedProgram {
  std::string program;                ///< file; with `text` only its name
  const nc::Program* text = nullptr;  ///< read already; null: the file is read
  std::string trace;                  ///< file
  nc::InterpreterOptions interpreter{};
};

struct FeedRuns {
  std::vector<calib::FeedRun> servo;
  std::vector<calib::StretchRun> stretches;  ///< one for each program; empty where all traces are servo traces

  /// Whether a servo trace names the line it commands, so that the limits can be fitted block by block.
  bool any_lines() const;
};

/// `columns`: file with a column map; empty: our CSV. Throws InputError.
FeedRuns read_runs(std::span<const TracedProgram> traced, const std::string& columns, const machine::Machine& start,
                   Diagnostics& diagnostics);

/// By servo traces that name their lines, or by times of stretches alone.
using FeedFit = std::variant<calib::FitFeedResult, calib::StretchFit>;

/// Drives come from the servo traces without lines, where some are given beside times of stretches.
FeedFit fit_runs(const FeedRuns& runs, const machine::Machine& start, const calib::FitFeedOptions& options = {});

/// The figures as JSON text, with a line end.
std::string fit_json(const FeedFit& fit);

}  // namespace camber::api
