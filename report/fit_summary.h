#pragma once
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/json.h"
#include "calib/block_time.h"
#include "calib/cross_validate.h"
#include "calib/fit_feed_model.h"
#include "calib/fit_stretches.h"
#include "calib/force_fit.h"
#include "calib/parts_fit.h"
#include "dynamics/modal_fit.h"

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

// The page of camber fit-feed: measured against modelled speed, residuals, parameters.

/// UTF-8, self-contained, without a script. Of each run the parts with the largest error of speed are drawn: path speed
/// over the fraction of the part's length, measured and modelled. The same result gives the same bytes.
std::string fit_feed_page(const calib::FitFeedResult& result);

/// Speed of one part. Empty where its accuracy keeps no stations.
std::string part_speed_svg(const calib::PartAccuracy& part);

// Speed against chord length, both on logarithmic axes: where a control is saturated, the points lie on V = L / T_b.

/// A whole SVG file.
std::string block_time_svg(const calib::BlockTimeFit& fit);

// What camber fit-parts tells: JSON, text and page.

/// parameters[]{name,value,unit,std_error,start,note}, correlations[]{a,b,value}, groups[]{feature,tool,rms_um,
/// held_out_rms_um}, residuals[], confounded[], suggestions[], left_out[], model_error, rms_um, rounds, converged,
/// message.
std::string fit_parts_json(const calib::FitPartsResult& result);

/// `suggest`: also the experiments that would tell what is not determined.
std::string fit_parts_text(const calib::FitPartsResult& result, bool suggest);

/// Tables, and the residuals over feed and stick-out as a drawing.
std::string fit_parts_page(const calib::FitPartsResult& result);

/// machine.toml, tools.toml, material.toml and report.html: names and texts. `jobs`: names of the files.
std::vector<std::pair<std::string, std::string>> fit_parts_files(const calib::FitPartsResult& result,
                                                                 const std::vector<std::string>& jobs);

// A measured frequency response and its fit, as a picture.

/// Magnitudes over the frequency: measured grey, fitted blue.
std::string response_svg(const dynamics::FrequencyResponse& response, const dynamics::ModeFit& fit);

}  // namespace camber::report
