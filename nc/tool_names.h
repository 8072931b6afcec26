#pragma once
// Tools as a program calls them: numbers for names, and the radii of their cutters.
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "nc/offsets.h"

namespace camber::nc {

/// Gives each name the first number from 1 on that no tool has, in the order in which they are asked for.
class ToolNumbers {
 public:
  /// A number that the program calls: no name gets it.
  void reserve(int number) { taken_.insert(number); }

  int of(std::string_view name) {
    const auto [at, is_new] = numbers_.emplace(std::string(name), 0);
    if (!is_new) return at->second;
    int number = 1;
    while (!taken_.insert(number).second) ++number;
    names_[number] = std::string(name);
    return at->second = number;
  }

  /// Returns the names for Interpretation::tool_names.
  const std::map<int, std::string>& names() const { return names_; }

 private:
  std::set<int> taken_;
  std::map<std::string, int, std::less<>> numbers_;
  std::map<int, std::string> names_;
};

// The cutters' own radii among InterpreterOptions::tool_offsets. A cycle that mills a pocket asks for the radius of the
// cutter; radius compensation does not (G41, RL): what a program under it has compensated already, only the tool table
// of the control knows. They stand under negative numbers, which no word of a program calls.

inline void set_cutter_radius(std::map<int, ToolOffset>& tool_offsets, int tool, double radius_mm) {
  tool_offsets[-1 - tool].radius_mm = radius_mm;
}

inline std::optional<double> cutter_radius_mm(const std::map<int, ToolOffset>& tool_offsets, int tool) {
  const auto found = tool_offsets.find(-1 - tool);
  return found == tool_offsets.end() ? std::nullopt : found->second.radius_mm;
}

}  // namespace camber::nc
