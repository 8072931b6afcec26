#pragma once
// How far every point of the envelope is displaced at each stamp of a stretch of path. Filled by deflection/, read by
// removal/; plain data.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/geometry.h"

namespace camber::removal {

/// Where a height lies between two nodes.
struct NodeWeight {
  int lower = 0, upper = 0;
  float upper_fraction = 0;
};
NodeWeight node_weight(const std::vector<double>& node_height_mm, double height_mm);

/// Lateral deflections, along x and y of the tool's frame, by stamp, height and rotation step. The edge of any tooth
/// passes the points of rotation step m at that instant of the tooth passing; between nodes the deflection is linear in
/// height, beyond the last node it is the last node's. Row 0 belongs to the stamp before the stretch's first.
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
  /// simd/deflection_lanes.h does the same for many places at once.
  Vec2 at(const float* row, double height_mm, double step) const;
  /// Rotation step, from 0 to `steps`, at which an edge passes the envelope's point at an angle (rad, counter-clockwise
  /// from x) and a height. lag_per_mm: see EnvelopeGrid.
  double step_at(double angle_rad, double height_mm, double lag_per_mm, int flutes) const {
    const double step = (angle_rad - height_mm * lag_per_mm) * steps * flutes / (2 * kPi);
    return step - steps * std::floor(step / steps);
  }
};

}  // namespace camber::removal
