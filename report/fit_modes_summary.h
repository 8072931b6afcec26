#pragma once
// Modes that were fitted to a tap test: tables for a job, JSON and text for a terminal.
#include <string>

#include "dynamics/fit_modes.h"

namespace camber::report {

/// `response`: its file. `direction`: "x", "y" or "xy".
std::string mode_tables(const dynamics::ModeFit& fit, const std::string& response, const std::string& direction,
                        int tool);
/// With a line end.
std::string modes_json(const dynamics::ModeFit& fit);
std::string modes_text(const dynamics::ModeFit& fit);

}  // namespace camber::report
