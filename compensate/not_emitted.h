#pragma once
// Shifts that the emitter could not write, said to the user.
#include <span>

#include "base/diagnostics.h"
#include "nc/emit.h"

namespace camber::compensate {

/// One warning [not-emitted] for each kind of block, at its first line, with the lines (at most eight of them).
void warn_of_not_emitted(const nc::Program& program, const nc::Interpretation& moves,
                         std::span<const nc::EditNotMade> not_made, Diagnostics& diagnostics);

}  // namespace camber::compensate
