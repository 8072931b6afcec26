#pragma once
// A glance at an envelope: a few of its patches, scattered over it, always the same ones.
#include <cstdint>
#include <span>
#include <vector>

#include "removal/engagement.h"

namespace camber::removal {

/// One patch in eight.
inline bool glanced_at(std::uint32_t patch) {
  constexpr std::uint32_t kGolden = 2654435769u, kTopBits = 29;
  return patch * kGolden >> kTopBits == 0;
}

/// Thickness of the chips at points of those patches, summed up. `glanced_point`: by point of the envelope.
inline double sum_of_glanced(std::span<const DeflectedChipSample> chips, const std::vector<char>& glanced_point) {
  double sum = 0;
  for (const DeflectedChipSample& c : chips)
    if (c.chip.thickness_mm > 0 && glanced_point[c.chip.point] != 0)
      sum += static_cast<double>(c.chip.thickness_mm) * c.chip.width_fraction();
  return sum;
}

}  // namespace camber::removal
