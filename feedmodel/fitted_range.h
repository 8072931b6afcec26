#pragma once
// Fitted range of a machine model: which feeds, corners, lines and arcs the fit has seen, and which part of a program
// lies beyond it.
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// Feeds, corners between feed moves, lengths of lines, radii of curvature of arcs and axes that feed moves of the
/// programs have: minimum and maximum of each.
machine::FittedRange range_of(const std::vector<const nc::Interpretation*>& programs);

/// The places at which a program leaves the range that the machine was fitted on: feeds above the highest, corners
/// sharper than the sharpest, lines and arcs shorter than the shortest, arcs tighter than the tightest (each by more
/// than a tenth), axes that did not move, runs of more blocks a second. Longer lines, wider arcs and slower feeds need
/// no extrapolation. Adds one warning for each [range-feed], [range-corner], [range-line], [range-arc],
/// [range-arc-length], [range-axis], [range-blocks] with its fraction of the cutting length, the first blocks, and the
/// size of the guess: the time predicted there (from accelerations and block time), that at the programmed feed, and
/// that with a stop after every block. Nothing of these where the machine file has no [fitted_range]; check_modes in
/// any case.
void check_range(const nc::Interpretation& program, const std::string& program_path, const machine::Machine& machine,
                 Diagnostics& diagnostics);

}  // namespace camber::feedmodel
