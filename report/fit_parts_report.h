#pragma once
// What camber fit-parts tells: JSON, text and page.
#include <string>
#include <utility>
#include <vector>

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

/// machine.toml, tools.toml, material.toml and report.html: names and texts. `jobs`: names of the files.
std::vector<std::pair<std::string, std::string>> fit_parts_files(const calib::FitPartsResult& result,
                                                                 const std::vector<std::string>& jobs);

}  // namespace camber::report
