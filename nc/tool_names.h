#pragma once
// Gives numbers to tools that a program calls by name.
#include <map>
#include <set>
#include <string>
#include <string_view>

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

}  // namespace camber::nc
