#pragma once
// A fit of force coefficients: material.toml, JSON and text for a terminal.
#include <string>
#include <vector>

#include "calib/fit_force.h"

namespace camber::report {

/// `logs`: names of the files.
std::string material_file(const calib::FitForceResult& result, const std::vector<std::string>& logs);
/// With a line end.
std::string fit_force_json(const calib::FitForceResult& result);
std::string fit_force_text(const calib::FitForceResult& result);

}  // namespace camber::report
