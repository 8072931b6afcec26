#pragma once
// Warnings for shifts that the emitter could not write.
#include <span>

#include "base/diagnostics.h"
#include "nc/emit.h"

namespace camber::compensate {

/// Adds one warning [not-emitted] for each kind of block, at its first line, with the lines (at most eight of them).
void warn_of_not_emitted(const nc::Program& program, const nc::Interpretation& moves,
                         std::span<const nc::EditNotMade> not_made, Diagnostics& diagnostics);

}  // namespace camber::compensate
