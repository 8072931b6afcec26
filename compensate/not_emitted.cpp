#include "compensate/not_emitted.h"

#include <map>
#include <set>

#include <fmt/format.h>

namespace camber::compensate {
namespace {

constexpr std::size_t kLinesShown = 8;

std::string list_of(const std::set<std::size_t>& lines) {
  std::string out = lines.size() == 1 ? "line " : "lines ";
  std::size_t shown = 0;
  for (const std::size_t line : lines) {
    if (shown == kLinesShown) return out + fmt::format(" and {} more", lines.size() - shown);
    out += (shown++ > 0 ? ", " : "") + std::to_string(line);
  }
  return out;
}

}  // namespace

void warn_of_not_emitted(const nc::Program& program, const nc::Interpretation& moves,
                         std::span<const nc::EditNotMade> not_made, Diagnostics& diagnostics) {
  std::map<nc::EmitGap, std::set<std::size_t>> lines;
  for (const auto& n : not_made) lines[n.why].insert(moves.moves[n.move].block + 1);
  for (const auto& [why, of_kind] : lines) {
    const auto words = program.words_of(*of_kind.begin() - 1);
    const std::string what = why == nc::EmitGap::subprogram || why == nc::EmitGap::arc_not_split
                                 ? "splits of a line are not written"
                                 : "shifts are not written";
    diagnostics.add(program.source.diagnostic(
        Severity::warning, words.empty() ? program.blocks[*of_kind.begin() - 1].offset : words.front().offset,
        fmt::format("{} where the move belongs to {}: {}", what, nc::to_string(why), list_of(of_kind)), "not-emitted"));
  }
}

}  // namespace camber::compensate
