#pragma once
// A material of any force law, for tests that go through all laws.
#include "machine/force_law.h"

namespace camber::tests {

inline constexpr machine::LinearForce kSteelForce{{2000, 700, 300}, {15, 12, 5}};
inline constexpr double kSteelChip_mm = 0.05;

/// Cuts like kSteelForce at kSteelChip_mm.
inline machine::Material material_of(const machine::ForceLawDescription& law) {
  return law.start(kSteelForce, kSteelChip_mm);
}

}  // namespace camber::tests
