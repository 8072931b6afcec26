#pragma once
// Displacement of the envelope points at each stamp of a stretch of path. Plain data; filled by deflection/, read by
// removal/.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/geometry.h"

namespace camber::removal {

/// Linear interpolation weight of a height between two nodes.
struct NodeWeight {
  int lower = 0, upper = 0;
  float upper_fraction = 0;
};
NodeWeight node_weight(const std::vector<double>& node_height_mm, double height_mm);

/// Lateral deflections, along x and y of the tool's frame, by stamp, height and rotation step. At rotation step m of a
/// tooth passing, the edges are at the points of rotation step m. Deflections are linear in height between nodes and
/// constant beyond the last node. Row 0 belongs to the stamp before the first of the stretch.
struct DeflectionTable {
  std::size_t stamps = 0;              ///< without row 0
  int steps = 0;                       ///< per pitch
  std::vector<double> node_height_mm;  ///< above the tip, ascending, evenly spaced, the first 0
  std::vector<float> values;           ///< [stamps + 1][nodes][steps][2], mm

  DeflectionTable() = default;
  DeflectionTable(std::size_t stamp_count, int steps_per_pitch, std::vector<double> heights)
      : stamps(stamp_count), steps(steps_per_pitch), node_height_mm(std::move(heights)) {
    assert(std::ranges::is_sorted(node_height_mm));
    assert(!node_height_mm.empty() && node_height_mm.front() == 0);
    values.assign((stamps + 1) * row_size(), 0.0f);
  }
  std::size_t nodes() const { return node_height_mm.size(); }
  std::size_t row_size() const { return nodes() * static_cast<std::size_t>(steps) * 2; }
  /// Row of stamp k of the stretch; -1 is the stamp before it.
  float* row(std::ptrdiff_t k) { return values.data() + static_cast<std::size_t>(k + 1) * row_size(); }
  const float* row(std::ptrdiff_t k) const { return values.data() + static_cast<std::size_t>(k + 1) * row_size(); }
  /// Largest deflection in a row, mm.
  double largest_mm(std::ptrdiff_t k) const;

  /// Deflection of one row at a height and a rotation step (with its fraction), linear between nodes and steps.
  /// simd/deflection_lanes.h is the vectorized version.
  Vec2 at(const float* row, double height_mm, double step) const;
  /// Rotation step in [0, `steps`) at which an edge passes the point of the envelope at an angle (rad,
  /// counter-clockwise from x) and a height. lag_per_mm: see EnvelopeGrid.
  double step_at(double angle_rad, double height_mm, double lag_per_mm, int flutes) const {
    const double step = (angle_rad - height_mm * lag_per_mm) * steps * flutes / (2 * kPi);
    return step - steps * std::floor(step / steps);
  }
};

}  // namespace camber::removal
