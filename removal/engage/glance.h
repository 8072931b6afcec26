#pragma once
// A glance is a cheap reading of a stamp: it looks at one patch of the envelope in eight, always the same ones. Its sum
// of chip thicknesses shows whether the cut has changed since the last full reading.
#include <cstdint>
#include <span>
#include <vector>

#include "removal/engagement.h"

namespace camber::removal {

/// Selects one patch in eight, scattered over the envelope by a multiplicative hash.
inline bool glanced_at(std::uint32_t patch) {
  constexpr std::uint32_t kGolden = 2654435769u, kTopBits = 29;
  return patch * kGolden >> kTopBits == 0;
}

/// Sums up the chip thicknesses, mm, at points of the selected patches. `glanced_point`: one entry per envelope point.
inline double sum_of_glanced(std::span<const DeflectedChipSample> chips, const std::vector<char>& glanced_point) {
  double sum = 0;
  for (const DeflectedChipSample& c : chips)
    if (c.chip.thickness_mm > 0 && glanced_point[c.chip.point] != 0)
      sum += static_cast<double>(c.chip.thickness_mm) * c.chip.width_fraction();
  return sum;
}

}  // namespace camber::removal
