#pragma once
// Shares modal states among moves (Interpretation::states).
#include <cstdint>
#include <vector>

#include "nc/move.h"

namespace camber::nc {

/// Returns the index of the state among the last ones of the list, where it is added if none of them is the same.
inline std::uint32_t shared_state(std::vector<ModalState>& states, const ModalState& state) {
  const std::size_t count = states.size(), oldest = count > 8 ? count - 8 : 0;
  for (std::size_t i = count; i-- > oldest;)
    if (states[i] == state) return static_cast<std::uint32_t>(i);
  states.push_back(state);
  return static_cast<std::uint32_t>(count);
}

}  // namespace camber::nc
