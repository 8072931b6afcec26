#include "motion/operations.h"

#include <algorithm>
#include <regex>
#include <string_view>

#include "nc/emit.h"

namespace camber::motion {

namespace {

/// Text in round brackets or behind a semicolon; empty: none.
std::string comment_of(std::string_view line) {
  const std::size_t open = line.find_first_of("(;");
  if (open == std::string_view::npos) return {};
  const std::size_t close = line[open] == '(' ? line.find(')', open) : line.size();
  return std::string(line.substr(open + 1, (close == std::string_view::npos ? line.size() : close) - open - 1));
}

constexpr std::size_t kLongestComment = 400;  // std::regex needs stack for each character

/// Returns for each line whether the comment above it matches `pattern`, a regular expression (ECMAScript,
/// case-insensitive). A comment names the lines behind it, up to the next tool change or the next comment; comments on
/// lines behind each other, without a move between them, are one heading. Of a comment its first 400 characters are
/// read.
std::vector<bool> lines_under(const nc::Program& program, const nc::Interpretation& moves, const std::string& pattern) {
  const std::regex wanted(pattern, std::regex::ECMAScript | std::regex::icase);
  const std::size_t lines = program.blocks.size();
  std::vector<bool> moves_here(lines, false), out(lines, false);
  for (const nc::Move& m : moves.moves) moves_here[m.block] = true;
  std::vector<bool> changes(lines, false);
  for (const nc::Event& event : moves.events)
    if (event.kind == nc::EventKind::tool_change) changes[event.block] = true;
  bool in = false, heading = false;
  for (std::size_t i = 0; i < lines; ++i) {
    const bool change = changes[i];
    const std::string comment = comment_of(program.source.line(i + 1)).substr(0, kLongestComment);
    if (change && !heading) in = false;
    if (!comment.empty()) {
      const bool matches = std::regex_search(comment, wanted);
      in = heading ? in || matches : matches;
      heading = true;
    }
    if (moves_here[i]) heading = false;
    out[i] = in;
  }
  return out;
}

}  // namespace

machine::Operations as_lines(const machine::Operations& operations, const nc::Program& program,
                             const nc::Interpretation& moves) {
  if (operations.comments.empty()) return operations;
  machine::Operations out;
  out.tools = operations.tools;
  const std::vector<bool> under = lines_under(program, moves, operations.comments);
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
