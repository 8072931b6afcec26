#pragma once
// Run-out of equally spaced teeth, as the offset of the tool axis from the spindle axis at each rotation step. Static
// coupling adds it to the deflection.
#include <cstddef>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "deflection/teeth.h"

namespace camber::deflection {

class RunOutOffsets {
 public:
  /// No run-out.
  RunOutOffsets() = default;
  /// Requires equally spaced teeth (Teeth::evenly_spaced).
  RunOutOffsets(const Teeth& teeth, int steps_per_pitch);

  bool none() const { return offset_mm_.empty(); }
  /// Returns the offsets at the rotation steps of a tooth passing, mm, in the tool's frame; empty without run-out.
  /// `passing` counts from the start of the tool.
  std::span<const Vec2> of(std::size_t passing) const;
  /// Adds `times` the offsets to a row of removal::DeflectionTable, [nodes][steps][2].
  void add(std::size_t passing, float times, std::size_t nodes, std::span<float> row) const;

 private:
  std::size_t steps_ = 0, teeth_ = 1;
  std::vector<Vec2> offset_mm_;  ///< [tooth passings of a turn][steps]
};

}  // namespace camber::deflection
