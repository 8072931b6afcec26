#pragma once
// Chips of non-uniform teeth: unequal pitch and run-out (Kline & DeVor 1983).
#include <algorithm>
#include <vector>

#include "machine/tool.h"

namespace camber::deflection {

/// Teeth are numbered from 0 in the order in which they cut. Tooth j is at offset_rad(j) from tooth 0, against the
/// direction of rotation. The run-out moves it outwards by rho cos(offset + lag - lambda): lag of the edge at the
/// height, lambda the run-out's direction from tooth 0.
class Teeth {
 public:
  explicit Teeth(const machine::Tool& tool);

  /// True if all teeth take the same chip.
  bool even() const { return even_; }
  bool evenly_spaced() const { return evenly_spaced_; }
  /// The same teeth without run-out.
  Teeth without_run_out() const;
  int count() const { return static_cast<int>(offset_rad_.size()); }
  double offset_rad(int tooth) const { return offset_rad_[static_cast<std::size_t>(tooth)]; }
  /// Offset of a tooth in rotation steps; `steps`: per turn.
  int offset_steps(int tooth, int steps) const;
  double tooth_runout_mm(int tooth, double lag_rad) const;
  /// Largest run-out of the teeth at this lag, mm.
  double max_runout_mm(double lag_rad) const;
  double runout_mm() const { return runout_mm_; }
  double runout_angle_rad() const { return runout_angle_rad_; }

  /// Chip of a tooth: h = max(0, min over m = 1 ... N of (c_m + sin(kappa) (t_j - t_(j-m)))), c_m the motion bound
  /// since the m-th previous tooth, t the run-out of each tooth: a tooth that stands back leaves its chip to the next.
  /// Over a revolution the teeth remove as much as uniform ones. even_chip_mm: motion bound of one mean pitch, along
  /// the normal; bulge_mm: the part of it due to the curvature of the envelope, which grows with the square of the
  /// motion. sine: sine of the normal's angle kappa. Source: Kline & DeVor, The effect of runout on cutting geometry
  /// and forces in end milling, Int. J. Mach. Tool Des. Res. 23 (1983) 123-140.
  double chip_mm(int tooth, double even_chip_mm, double sine, double lag_rad, double bulge_mm = 0) const {
    return std::max(0.0, room_mm(tooth, even_chip_mm, sine, lag_rad, bulge_mm));
  }
  /// Returns the chip before clipping at zero: negative values are the distance of a tooth to the material.
  double room_mm(int tooth, double even_chip_mm, double sine, double lag_rad, double bulge_mm) const;

 private:
  bool even_ = true, evenly_spaced_ = true;
  std::vector<double> offset_rad_, pitch_fraction_;  ///< pitch to the next tooth / mean pitch
  double runout_mm_, runout_angle_rad_;
};

}  // namespace camber::deflection
