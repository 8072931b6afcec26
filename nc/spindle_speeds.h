#pragma once
// Other spindle speeds in a program's text: its S words with new numbers, and a line of their own where a speed begins
// that no S word stands for.
#include <span>
#include <string>

#include "nc/emit.h"

namespace camber::nc {

struct SpeedEmission {
  Emission emission{};  ///< not_made stays empty
  /// Why the text does not allow it, and the line (0: none): "its S word is an expression". Empty: it is done.
  std::string why_not{};
  std::size_t line = 0;
};

/// `rpm`: one per move; 0: as programmed. S words that no cut relies on keep their numbers, and so do feeds: emit_edits
/// on the new text changes them.
SpeedEmission emit_spindle_speeds(const Program& program, const Interpretation& moves, std::span<const double> rpm);

}  // namespace camber::nc
