// What is said of edits that are not in the text.
#include <fmt/format.h>

#include "nc/emit.h"

namespace camber::nc {

std::string to_string(EmitGap why) {
  switch (why) {
    case EmitGap::canned_cycle:
      return "a drilling cycle";
    case EmitGap::machine_place:
      return "a move of G28, G30 or G53";
    case EmitGap::dwell:
      return "a dwell";
    case EmitGap::not_in_text:
      return "a move of a loop, an expression, a subprogram, a corner word or a line of several blocks";
    case EmitGap::several_moves:
      return "a block of several moves";
    case EmitGap::subprogram:
      return "a block that also calls or ends a subprogram";
    case EmitGap::rapid:
      return "a rapid, which has no feed";
    case EmitGap::feed_by_variable:
      return "a move whose feed is set by an expression, or a program that reads its own feed";
    case EmitGap::arc_not_split:
      return "an arc of several turns, in inverse time (G93), or whose pieces do not close";
    case EmitGap::arc:
      break;
  }
  return "an arc that does not reach the new ends";
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
