#pragma once
// Stability lobes as a table, JSON and text for a terminal.
#include <string>
#include <vector>

#include "dynamics/tool_lobes.h"

namespace camber::report {

std::string lobes_csv(const std::vector<dynamics::LobePoint>& lobes);
/// With the modes, and a line end.
std::string lobes_json(const dynamics::LobeRequest& request, const std::vector<dynamics::LobePoint>& lobes);
std::string lobes_text(const dynamics::LobeRequest& request, const std::vector<dynamics::LobePoint>& lobes);

}  // namespace camber::report
