#pragma once
// All chips of a path of stamps at once, for tests.
#include <vector>

#include "removal/engagement.h"

namespace camber::testing {

/// Chips of stamp k: chips[first[k]] ... chips[first[k + 1] - 1].
struct AllChips {
  std::vector<std::size_t> first;
  std::vector<removal::ChipSample> chips;
  double removed_mm3 = 0;  ///< change of the stock's volume
  std::span<const removal::ChipSample> of(std::size_t k) const {
    return {chips.data() + first[k], first[k + 1] - first[k]};
  }
};

/// Cuts all stamps with the undeflected cutter.
inline AllChips engage_all(removal::Stock& stock, const removal::Stock& blank, const removal::EnvelopeGrid& envelope,
                           std::span<const removal::Stamp> stamps, std::int32_t first_id = 0) {
  removal::RigidEngager engager(stock, blank, envelope, stamps, first_id);
  std::vector<std::vector<removal::ChipSample>> by_stamp(stamps.size());
  engager.engage(0, stamps.size(), [&](std::size_t k, std::span<const removal::ChipBlock> chips) {
    by_stamp[k] = removal::chips_of(engager.blocks(), chips);
  });
  AllChips out;
  out.first.push_back(0);
  for (const auto& chips : by_stamp) {
    out.chips.insert(out.chips.end(), chips.begin(), chips.end());
    out.first.push_back(out.chips.size());
  }
  out.removed_mm3 = engager.commit();
  return out;
}

}  // namespace camber::testing
