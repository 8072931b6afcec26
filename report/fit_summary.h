// What the fits tell: JSON and text for a terminal; coefficients and modes also as the tables of a job.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "calib/block_time.h"
#include "calib/cross_validate.h"
#include "calib/fit_feed_model.h"
#include "calib/fit_force.h"
#include "calib/fit_stretches.h"
#include "dynamics/fit_modes.h"

namespace camber::report {

// camber fit-feed

/// By servo traces that name their lines, or by times of stretches alone.
using FeedFit = std::variant<calib::FitFeedResult, calib::StretchFit>;

/// The figures as JSON text, with a line end.
std::string fit_json(const FeedFit& fit);

/// For a terminal.
std::string fit_text(const FeedFit& fit);
std::string left_out_text(const std::vector<calib::HeldOutRun>& runs);
std::string block_time_text(const calib::BlockTimeFit& fit);

// camber fit-force

/// `logs`: names of the files.
std::string material_file(const calib::FitForceResult& result, const std::vector<std::string>& logs);
/// With a line end.
std::string fit_force_json(const calib::FitForceResult& result);
std::string fit_force_text(const calib::FitForceResult& result);

// camber fit-modes

/// `response`: its file. `direction`: "x", "y" or "xy".
std::string mode_tables(const dynamics::ModeFit& fit, const std::string& response, const std::string& direction,
                        int tool);
/// With a line end.
std::string modes_json(const dynamics::ModeFit& fit);
std::string modes_text(const dynamics::ModeFit& fit);

}  // namespace camber::report
