#pragma once
// Re-emission: the user's program with new end points for some of its moves and nothing else changed.
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/geometry.h"
#include "nc/move.h"
#include "nc/program.h"

namespace camber::nc {

/// New geometry for one move (a linear or an arc move that is editable and not canned).
struct MoveEdit {
  std::uint32_t move = 0;      ///< index into Interpretation::moves; ascending in the list
  std::vector<Vec3> via_mm{};  ///< points to pass before the end, in order: the block becomes several
  /// Arcs only: the centre of the arc that ends at each via point, in the sense of the block's arc; as many.
  std::vector<Vec3> via_center_mm{};
  Vec3 end_mm = Vec3::Zero();
  Vec3 center_mm = Vec3::Zero();  ///< arcs only: the new centre; the emitter makes it agree with the rounded ends
};

struct EmitOptions {
  int decimals_mm = 4;  ///< at least as many as the word had
  int decimals_inch = 5;
  std::string header_comment{};  ///< lines without brackets; empty: none. Go after % and the O word.
};

/// The new text. Blocks without an edit come out byte for byte, except where an unedited cutting move would otherwise
/// end in another place because an edited move before it left the position elsewhere: there just the words that bring
/// it back are changed or added. Rapids get no new words; where they are incremental, those that they have are
/// corrected, so an axis that a rapid does not name stays where the edited move left it until the next cutting move.
///
/// A block with via points becomes several: the first keeps its words and comment and goes to the first via point, the
/// others hold coordinates only (arcs: and their centre or R). Words that act at the end of the move (M0 M1 M2 M5 M9
/// M30 M60, G9) go to the last. A full turn stays closed: it ends where the emitted program starts it. Arcs get as many
/// decimals as it takes for the radii at start and end to agree within one unit of the last decimal.
///
/// Points are in the frame of the moves; where the text has them in a shifted, turned, mirrored or scaled frame the
/// words are counted back into it.
///
/// Moves of drilling cycles and of G28, G29, G30 and G53, dwells, and moves that are not Move::editable (under G41 and
/// G42, in polar coordinates, of loops) cannot be edited: their edits are passed over. Edits go by the order of the
/// moves, the text keeps its own (a subprogram may stand behind).
std::string emit(const Program& program, const Interpretation& interpretation, std::span<const MoveEdit> edits,
                 const EmitOptions& options);

/// Why an edit is not in the text as it was asked for.
enum class EmitGap {
  canned_cycle,   ///< a move of a drilling cycle
  machine_place,  ///< a move of G28, G30 or G53
  dwell,
  not_in_text,    ///< made by a loop, an expression or a subprogram: the text has no words of its own for it
  several_moves,  ///< the block makes more than one move
  subprogram,     ///< only the via points are left out: the block also calls or ends a subprogram (M96 .. M99)
  arc             ///< no arc reaches the new ends, the old one was kept; also of unedited arcs behind an edit
};

struct EditNotMade {
  std::uint32_t move = 0;  ///< index into Interpretation::moves
  EmitGap why = EmitGap::canned_cycle;
};

/// In shop words: what the edit's move is.
std::string to_string(EmitGap why);

struct Emission {
  std::string text;
  std::vector<EditNotMade> not_made;  ///< ascending
  /// One entry a line of `text`: index of the block of the given program that the line stands for; kNoBlock: new.
  std::vector<std::uint32_t> block_of_line;

  static constexpr std::uint32_t kNoBlock = std::numeric_limits<std::uint32_t>::max();
};

/// As emit(), and says which edits are not in the text.
Emission emit_edits(const Program& program, const Interpretation& interpretation, std::span<const MoveEdit> edits,
                    const EmitOptions& options);

/// Warns [not-editable] at the first of the `wanted` moves that cannot be edited because the text does not say it
/// alone, and tells how many there are. `wanted`: one entry for each move.
void warn_of_uneditable(const Program& program, const Interpretation& interpretation, const std::vector<bool>& wanted,
                        Diagnostics& diagnostics);

}  // namespace camber::nc
