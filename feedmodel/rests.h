#pragma once
// Rests: places at which the path stops because the control waits for something that is not motion.
#include <cstdint>
#include <vector>

#include "machine/cycle.h"
#include "nc/move.h"

namespace camber::feedmodel {

/// Moves (ascending) before which the path rests: tool changes, M3 M4 M5 M19, index and pallet, and every code that
/// takes time.
std::vector<std::uint32_t> rests_of(const nc::Interpretation& program, const machine::Cycle& cycle);

}  // namespace camber::feedmodel
