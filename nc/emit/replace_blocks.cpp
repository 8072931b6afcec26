#include "nc/emit.h"

#include <array>
#include <cassert>
#include <string_view>

#include <fmt/format.h>

#include "nc/emit/emitted_text.h"

namespace camber::nc {
namespace {

/// Returns the text between the end of the block and the next one: "\n", "\r\n"; of a file's last line, what the file
/// uses.
std::string_view line_end_of(const Program& program, std::size_t block) {
  const std::string_view text = program.source.text();
  if (block + 1 < program.blocks.size()) {
    const std::size_t end = program.blocks[block].offset + program.blocks[block].length;
    return text.substr(end, program.blocks[block + 1].offset - end);
  }
  return usual_line_end(program.source);
}

}  // namespace

std::string replace_blocks(const Program& program, std::span<const BlockReplacement> replacements) {
  const std::string& text = program.source.text();
  std::string out;
  out.reserve(text.size());
  std::size_t copied = 0;
  for (const BlockReplacement& r : replacements) {
    assert(r.first <= r.last && r.last < program.blocks.size());
    assert(program.blocks[r.first].offset >= copied);
    out.append(text, copied, program.blocks[r.first].offset - copied);
    const std::string_view line_end = line_end_of(program, r.first);
    for (std::size_t i = 0; i < r.lines.size(); ++i) {
      if (i > 0) out += line_end;
      out += r.lines[i];
    }
    copied = program.blocks[r.last].offset + program.blocks[r.last].length;
  }
  out.append(text, copied);
  return out;
}

std::string to_string(EmitGap why) {
  constexpr std::array<const char*, 10> kTexts{
      // in the order of the enum
      "a drilling cycle",
      "a move of G28, G30 or G53",
      "a dwell",
      "a move of a loop, an expression, a subprogram, a corner word or a line of several blocks",
      "a block of several moves",
      "a block that also calls or ends a subprogram",
      "an arc that does not reach the new ends",
      "a rapid, which has no feed",
      "a move whose feed is set by an expression, or a program that reads its own feed",
      "an arc of several turns, in inverse time (G93), or whose pieces do not close"};
  static_assert(kTexts.size() == static_cast<std::size_t>(EmitGap::arc_not_split) + 1);
  return kTexts[static_cast<std::size_t>(why)];
}

void warn_of_uneditable(const Program& program, const Interpretation& interpretation, const std::vector<bool>& wanted,
                        Diagnostics& diagnostics) {
  const Move* first = nullptr;
  std::size_t count = 0;
  for (std::size_t m = 0; m < interpretation.moves.size(); ++m) {
    const Move& move = interpretation.moves[m];
    if (!wanted[m] || move.editable || move.canned) continue;
    if (!first) first = &move;
    ++count;
  }
  if (!first) return;
  diagnostics.add(program.source.diagnostic(
      Severity::warning, program.blocks[first->block].offset,
      fmt::format("{} cutting move{} from here on {} made by a loop, an expression, a corner word, a line of several "
                  "blocks, numbers in least increments, or a subprogram that is called more than once or is in another "
                  "file; the text has no words of their own, so they stay unchanged",
                  count, count == 1 ? "" : "s", count == 1 ? "is" : "are"),
      "not-editable"));
}

}  // namespace camber::nc
