#pragma once
// From words to moves: modal state, units, planes, arcs, canned cycles.
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "nc/move.h"
#include "nc/program.h"

namespace camber::nc {

struct InterpreterOptions {
  /// Unit where the program has neither G20 nor G21; not given: millimetres, with a warning.
  std::optional<bool> inch;
  bool skip_slash_blocks = false;  ///< the block skip switch
  /// G4 P without a decimal point counts milliseconds (Fanuc, Haas, Mazak) and not seconds (LinuxCNC).
  bool integer_dwell_is_ms = false;
};

/// Interprets the whole program. Errors and warnings go to `diagnostics`; errors do not stop the reading
/// (Diagnostics throws InputError after kMaxErrors).
Interpretation interpret(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics);

}  // namespace camber::nc
