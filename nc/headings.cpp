#include "nc/headings.h"

#include <algorithm>
#include <regex>
#include <string_view>

namespace camber::nc {
namespace {

/// Text in round brackets or behind a semicolon; empty: none.
std::string comment_of(std::string_view line) {
  const std::size_t open = line.find_first_of("(;");
  if (open == std::string_view::npos) return {};
  const std::size_t close = line[open] == '(' ? line.find(')', open) : line.size();
  return std::string(line.substr(open + 1, (close == std::string_view::npos ? line.size() : close) - open - 1));
}

constexpr std::size_t kLongestComment = 400;  // std::regex needs stack for each character

}  // namespace

std::vector<bool> lines_under(const Program& program, const Interpretation& moves, const std::string& pattern) {
  const std::regex wanted(pattern, std::regex::ECMAScript | std::regex::icase);
  const std::size_t lines = program.blocks.size();
  std::vector<bool> moves_here(lines, false), out(lines, false);
  for (const Move& m : moves.moves) moves_here[m.block] = true;
  std::vector<bool> changes(lines, false);
  for (const Event& event : moves.events)
    if (event.kind == EventKind::tool_change) changes[event.block] = true;
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

}  // namespace camber::nc
