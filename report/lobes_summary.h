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

// Stability lobes as a picture: critical depth over spindle speed.

/// A cut of a program on the lobes of its engagement.
struct OperatingPoint {
  double speed_rpm = 0, depth_mm = 0;
  std::string title;  ///< shown where the mouse rests
};

/// Blue: the border, unstable above it; red where it flips. Points: red above the border of their speed, else green.
/// Points without a border are left out of the line.
std::string lobes_svg(const std::vector<dynamics::LobePoint>& lobes, const std::vector<OperatingPoint>& points = {});

}  // namespace camber::report
