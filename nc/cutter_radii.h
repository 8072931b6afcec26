#pragma once
// The cutters' own radii among InterpreterOptions::tool_offsets. A cycle that mills a pocket asks for the radius of the
// cutter; radius compensation does not (G41, RL): what a program under it has compensated already, only the tool table
// of the control knows. They stand under negative numbers, which no word of a program calls.
#include <map>
#include <optional>

#include "nc/offsets.h"

namespace camber::nc {

inline void set_cutter_radius(std::map<int, ToolOffset>& tool_offsets, int tool, double radius_mm) {
  tool_offsets[-1 - tool].radius_mm = radius_mm;
}

inline std::optional<double> cutter_radius_mm(const std::map<int, ToolOffset>& tool_offsets, int tool) {
  const auto found = tool_offsets.find(-1 - tool);
  return found == tool_offsets.end() ? std::nullopt : found->second.radius_mm;
}

}  // namespace camber::nc
