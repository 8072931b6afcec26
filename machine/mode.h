#pragma once
// A natural mode of a tool, or of a workpiece on its table.
#include "base/geometry.h"

namespace camber::machine {

/// Receptance where it is excited and felt: direction direction^T / (k (1 - r^2 + 2 i zeta r)), r = f / frequency_hz.
/// Directions do not turn with the spindle.
struct Mode {
  Vec2 direction = Vec2::UnitX();  ///< unit vector
  double frequency_hz = 0;
  double damping_ratio = 0;       ///< zeta; 1 is critical damping
  double stiffness_N_per_mm = 0;  ///< modal, at the tip of a tool
};

}  // namespace camber::machine
