#pragma once
// Merging: short straight lines that lie within a tolerance of one longer line are driven as that line.
#include <cstddef>
#include <span>

#include "base/geometry.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// A run of merged lines never holds more than this (LinuxCNC's figure).
inline constexpr std::size_t kMaxMergedLines = 100;

/// Tolerance within which lines are merged in this modal state: G64's Q, else its P where the control
/// merges by it (ControlKind::g64_p_merges), else the control's own. 0: no merging.
double merge_tolerance_mm(const nc::ModalState& state, const machine::Control& control);

/// Returns the index after the last move of the run of lines that begins at `first` and is driven as one line: every
/// corner that is passed over lies within `tolerance_mm` of the straight line from the run's start to its end. Only
/// straight feed moves of one state and one feed are merged. Returns first + 1 where nothing merges. Source: LinuxCNC
/// user manual, G64 P- Q- ("naive cam detector").
std::size_t merged_run_end(std::span<const nc::Move> moves, std::size_t first, double tolerance_mm);

}  // namespace camber::feedmodel
