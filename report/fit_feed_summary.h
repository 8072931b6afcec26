#pragma once
// The figures of camber fit-feed: JSON and text for a terminal.
#include <string>
#include <variant>
#include <vector>

#include "calib/block_time.h"
#include "calib/cross_validate.h"
#include "calib/fit_feed_model.h"
#include "calib/fit_stretches.h"

namespace camber::report {

/// By servo traces that name their lines, or by times of stretches alone.
using FeedFit = std::variant<calib::FitFeedResult, calib::StretchFit>;

/// The figures as JSON text, with a line end.
std::string fit_json(const FeedFit& fit);

/// For a terminal.
std::string fit_text(const FeedFit& fit);
std::string left_out_text(const std::vector<calib::HeldOutRun>& runs);
std::string block_time_text(const calib::BlockTimeFit& fit);

}  // namespace camber::report
