#pragma once
// The work of camber feed before and after the axes are predicted.
#include <string>

#include "base/diagnostics.h"
#include "feedmodel/timed_path.h"
#include "nc/interpreter.h"

namespace camber::api {

/// The program as the machine's control reads it, checked against the machine. `csv`: where a row for each period will
/// be written; empty: nowhere. Throws InputError.
nc::Interpretation moves_of_feed(const nc::Program& text, const machine::Machine& machine,
                                 const nc::InterpreterOptions& options, const std::string& csv,
                                 Diagnostics& diagnostics);

/// The figures as JSON text, with a line end.
std::string feed_json(const feedmodel::FeedSummary& summary);

}  // namespace camber::api
