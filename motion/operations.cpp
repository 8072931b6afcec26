#include "motion/operations.h"

#include <algorithm>

#include "nc/emit.h"
#include "nc/headings.h"

namespace camber::motion {

machine::Operations as_lines(const machine::Operations& operations, const nc::Program& program,
                             const nc::Interpretation& moves) {
  if (operations.comments.empty()) return operations;
  machine::Operations out;
  out.tools = operations.tools;
  const std::vector<bool> under = nc::lines_under(program, moves, operations.comments);
  for (std::size_t i = 0; i < under.size(); ++i) {
    const int line = static_cast<int>(i) + 1;
    const bool in_ranges = operations.blocks.empty() || std::ranges::any_of(operations.blocks, [&](const auto& r) {
                             return line >= r[0] && line <= r[1];
                           });
    if (!under[i] || !in_ranges) continue;
    if (!out.blocks.empty() && out.blocks.back()[1] == line - 1)
      out.blocks.back()[1] = line;
    else
      out.blocks.push_back({line, line});
  }
  if (out.blocks.empty()) out.blocks.push_back({0, 0});
  return out;
}

machine::Operations moved_ranges(const machine::Operations& operations,
                                 const std::vector<std::uint32_t>& block_of_line) {
  machine::Operations out = operations;
  for (auto& [first, last] : out.blocks) {
    const auto from = static_cast<std::uint32_t>(first - 1), to = static_cast<std::uint32_t>(last - 1);
    int new_first = 0, new_last = 0;
    for (std::size_t line = 0; line < block_of_line.size(); ++line) {
      if (block_of_line[line] == nc::Emission::kNoBlock) continue;
      if (block_of_line[line] < from || block_of_line[line] > to) continue;
      if (new_first == 0) new_first = static_cast<int>(line) + 1;
      new_last = static_cast<int>(line) + 1;
    }
    first = new_first;
    last = new_last;
  }
  return out;
}

}  // namespace camber::motion
