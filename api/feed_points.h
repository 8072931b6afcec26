#pragma once
// The moves of a program as camber feed times them, and their samples as the library hands them out.
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "camber/feed.h"
#include "feedmodel/timed_path.h"
#include "nc/interpreter.h"

namespace camber::api {

/// The program as the machine's control reads it, checked against the machine. `csv`: where a row for each period will
/// be written; empty: nowhere. Throws InputError.
nc::Interpretation moves_of_feed(const nc::Program& text, const machine::Machine& machine,
                                 const nc::InterpreterOptions& options, const std::string& csv,
                                 Diagnostics& diagnostics);

/// Letters of the rotary axes that get columns in feed.csv, in the order a, b, c; empty without rotary motion.
std::string rotary_columns(const nc::Interpretation& moves, const machine::Machine& machine);

/// A sink for predict_feed that appends to `points`; both must outlive it.
feedmodel::SampleSink points_sink(const nc::Interpretation& moves, std::vector<FeedPoint>& points);

}  // namespace camber::api
