#pragma once
// Stability lobes as a picture: critical depth over spindle speed.
#include <string>
#include <vector>

#include "dynamics/tool_lobes.h"

namespace camber::report {

/// A cut of a program on the lobes of its engagement.
struct OperatingPoint {
  double speed_rpm = 0, depth_mm = 0;
  std::string title;  ///< shown where the mouse rests
};

/// Blue: the border, unstable above it; red where it flips. Points: red above the border of their speed, else green.
/// Points without a border are left out of the line.
std::string lobes_svg(const std::vector<dynamics::LobePoint>& lobes, const std::vector<OperatingPoint>& points = {});

}  // namespace camber::report
