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

/// Letters of the rotary axes that get columns in feed.csv, in the order a, b, c; empty without rotary motion.
std::string rotary_columns(const nc::Interpretation& moves, const machine::Machine& machine);

/// predict_feed, or predict_joints for a program with rotary motion; otherwise the sink gets no joints.
feedmodel::FeedSummary predict_feed(const nc::Interpretation& moves, const machine::Machine& machine,
                                    const feedmodel::JointSampleSink& sink);

/// Two lines.
std::string contour_text(const feedmodel::PoseContourFigures& contour);

/// The figures as JSON text, with a line end.
std::string feed_json(const feedmodel::FeedSummary& summary);

}  // namespace camber::api
