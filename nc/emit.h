#pragma once
// Writes edits of a program: the user's text with new end points, feeds and splits of some moves, or with replaced
// blocks, and otherwise unchanged. All folders that rewrite a program use this header; the implementation is in
// nc/emit/.
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/geometry.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::nc {

/// A point at which an edited block is split.
struct ViaPoint {
  Vec3 point_mm = Vec3::Zero();
  /// Arcs only: the centre of the arc that ends here, in the sense of the block's arc. Not given: the whole arc's.
  std::optional<Vec3> center_mm{};
  std::optional<double> feed_mm_per_s{};  ///< up to this point; not given: the move's (new or old)
};

/// The changes of one move (a linear or an arc move that is editable and not canned; a rapid may get a new
/// end). What is not given stays as it is.
struct MoveEdit {
  std::uint32_t move = 0;       ///< index into Interpretation::moves; ascending in the list
  std::vector<ViaPoint> via{};  ///< points to pass before the end, in order: the block becomes several
  std::optional<Vec3> end_mm{};
  std::optional<Vec3> center_mm{};        ///< arcs only; the emitter makes it agree with the rounded ends
  std::optional<double> feed_mm_per_s{};  ///< greater than zero; with via points: of the last piece, and their default
};

struct EmitOptions {
  int decimals_mm = 4;  ///< decimals of changed words, at least as many as the word had
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
/// F words are changed or added only where the modal feed is not the one wanted. A feed gets the decimals that the F
/// words of the program have, and as many more as it takes to be right to 0.1 %. Where an unedited move relies on the
/// modal feed, it gets the F word that it had relied on; where its text may not be changed (a loop, a subprogram called
/// more than once, a block that may be skipped), that F stands on a line of its own behind the last edited block. A
/// feed per revolution (G95) is written for the spindle speed at the move, inverse time (G93) for the new length.
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
  /// Only the via points and feeds are left out: the block also calls or ends a subprogram (M96 .. M99), or every move
  /// calls a macro (G66).
  subprogram,
  arc,               ///< no arc reaches the new ends, the old one was kept; also of unedited arcs behind an edit
  rapid,             ///< only the feeds are left out: a rapid has none
  feed_by_variable,  ///< only the feeds are left out: an expression sets the modal F, or the program reads it
  /// Only the via points and their feeds are left out: an arc of several turns (P), in inverse time (G93), or whose
  /// pieces have no words that close.
  arc_not_split
};

struct EditNotMade {
  std::uint32_t move = 0;  ///< index into Interpretation::moves
  EmitGap why = EmitGap::canned_cycle;
};

/// Description of the edit's move for messages.
std::string to_string(EmitGap why);

struct Emission {
  std::string text;
  std::vector<EditNotMade> not_made;  ///< edits that were not made, ascending
  /// One entry per line of `text`: index of the corresponding block of the given program; kNoBlock: new.
  std::vector<std::uint32_t> block_of_line;

  static constexpr std::uint32_t kNoBlock = std::numeric_limits<std::uint32_t>::max();
};

/// Does what emit() does, and says which edits are not in the text.
Emission emit_edits(const Program& program, const Interpretation& interpretation, std::span<const MoveEdit> edits,
                    const EmitOptions& options);

/// Warns [not-editable] at the first of the `wanted` moves that cannot be edited because the text does not say it
/// alone, and tells how many there are. `wanted`: one entry for each move.
void warn_of_uneditable(const Program& program, const Interpretation& interpretation, const std::vector<bool>& wanted,
                        Diagnostics& diagnostics);

/// Blocks first .. last (both included) become `lines`.
struct BlockReplacement {
  std::uint32_t first = 0, last = 0;  ///< indexes into Program::blocks
  std::vector<std::string> lines;     ///< lines without line ends; they get the one of block `first`
};

/// The new text. `replacements`: ascending, not overlapping. A last line that the file leaves without a line end stays
/// without one.
std::string replace_blocks(const Program& program, std::span<const BlockReplacement> replacements);

}  // namespace camber::nc
