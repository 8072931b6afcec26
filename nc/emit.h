#pragma once
// Re-emission: the user's program with new end points for some of its moves and nothing else changed.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "nc/move.h"
#include "nc/program.h"

namespace camber::nc {

/// New geometry for one move (a linear or an arc move that stands in the text as one block; not canned).
struct MoveEdit {
  std::uint32_t move = 0;      ///< index into Interpretation::moves; ascending in the list
  std::vector<Vec3> via_mm{};  ///< points to pass before the end, in order: the block becomes several (linear only)
  Vec3 end_mm = Vec3::Zero();
  Vec3 center_mm = Vec3::Zero();  ///< arcs only: the new centre; the emitter makes it agree with the rounded ends
};

struct EmitOptions {
  int decimals_mm = 4;  ///< at least as many as the word had
  int decimals_inch = 5;
  std::string header_comment{};  ///< one line without brackets; empty: none. Goes after % and the O word.
};

/// The new text. Blocks without an edit come out byte for byte, except where an unedited cutting move would otherwise
/// end in another place because an edited move before it left the position elsewhere: there just the words that bring
/// it back are changed or added. Rapids get no new words; where they are incremental, those that they have are
/// corrected, so an axis that a rapid does not name stays where the edited move left it until the next cutting move.
///
/// A block with via points becomes several: the first keeps its words and comment and goes to the first via point, the
/// others hold coordinates only. A block that ends something (M0 M1 M2 M5 M9 M30 M60, G9) comes last instead.
/// A full turn stays closed: it ends where the emitted program starts it. Arcs get as many decimals as it takes for the
/// radii at start and end to agree within one unit of the last decimal.
///
/// Points are in the frame of the moves; where the text has them in a shifted, turned, mirrored or scaled frame the words
/// are counted back into it.
///
/// Moves of drilling cycles, under G41 and G42, in polar coordinates, of G28, G29, G30 and G53, and dwells, cannot be
/// edited: their edits are passed over.
std::string emit(const Program& program, const Interpretation& interpretation, std::span<const MoveEdit> edits,
                 const EmitOptions& options);

}  // namespace camber::nc
