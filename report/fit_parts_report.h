#pragma once
// What camber fit-parts tells: JSON, text and page.
#include <string>

#include "base/json.h"
#include "calib/fit_parts.h"

namespace camber::report {

/// parameters[]{name,value,unit,std_error,start,note}, correlations[]{a,b,value}, groups[]{feature,tool,rms_um,
/// held_out_rms_um}, residuals[], confounded[], suggestions[], left_out[], model_error, rms_um, rounds, converged,
/// message.
std::string fit_parts_json(const calib::FitPartsResult& result);

/// `suggest`: also the experiments that would tell what is not determined.
std::string fit_parts_text(const calib::FitPartsResult& result, bool suggest);

/// Tables, and the residuals over feed and stick-out as a drawing.
std::string fit_parts_page(const calib::FitPartsResult& result);

/// Comments "# NAME: VALUE +- ERROR UNIT" of the parameters whose name `belongs`: what compensate --uncertainty reads.
std::string parameter_comments(const calib::FitPartsResult& result, bool (*belongs)(const std::string& name));

/// Tools as fitted, a table for each clamping: tools.toml of the folder.
std::string fitted_tools_toml(const calib::FitPartsResult& result);

}  // namespace camber::report
