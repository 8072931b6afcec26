#pragma once
// Two programs line by line: which lines of the one stand in place of which lines of the other.
#include <cstddef>
#include <string_view>
#include <vector>

namespace camber::ui {

/// `before_lines` lines from `before` on are replaced by `after_lines` lines from `after` on; from 0.
struct Hunk {
  std::size_t before = 0, before_lines = 0, after = 0, after_lines = 0;
  bool operator==(const Hunk&) const = default;
};

/// The hunks that differ, in order; between hunks the texts are equal, line for line. Lines that both programs have
/// once, in the same order, anchor the comparison (patience diff); time and memory grow with the number of lines.
std::vector<Hunk> difference(std::string_view before, std::string_view after);

}  // namespace camber::ui
