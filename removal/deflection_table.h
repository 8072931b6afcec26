#pragma once
// Displacement of the envelope points at each stamp of a stretch of path. Plain data; filled by deflection/, read by
// removal/.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "base/geometry.h"

namespace camber::removal {

/// Linear interpolation weight of a height between two nodes.
struct NodeWeight {
  int lower = 0, upper = 0;
  float upper_fraction = 0;
};
NodeWeight node_weight(const std::vector<double>& node_height_mm, double height_mm);

/// Deflections in the tool's frame: lateral ones, along x and y, by stamp, height and rotation step, and axial ones,
/// along z, by stamp and rotation step. The edge of any tooth passes the points of rotation step m at that instant of
/// the tooth passing; between nodes the lateral deflection is linear in height, beyond the last node it is the last
/// node's. Row 0 belongs to the stamp before the stretch's first.
struct DeflectionTable {
  std::size_t stamps = 0;              ///< without row 0
  int steps = 0;                       ///< per pitch
  std::vector<double> node_height_mm;  ///< above the tip, ascending, evenly spaced, the first 0
  bool axial = false;                  ///< rows have axial deflections; else these are 0
  bool parts = false;                  ///< each row is followed by what of it is the part's, in the same order
  /// Above the tip: where edges end. Higher up the tool leaves no mark, and a deflected one carves nothing but by a
  /// general cutter or a tilted one: what stands there has sprung back behind an edge of an earlier cut.
  double edges_end_mm = std::numeric_limits<double>::infinity();
  /// [stamps + 1], of each [nodes][steps][2], mm, then, where they are axial, [steps][2]: the axial deflection of the
  /// step and that of the next one.
  std::vector<float> values;

  DeflectionTable() = default;
  DeflectionTable(std::size_t stamp_count, int steps_per_pitch, std::vector<double> heights, bool with_axial = false,
                  bool with_parts = false)
      : stamps(stamp_count),
        steps(steps_per_pitch),
        node_height_mm(std::move(heights)),
        axial(with_axial),
        parts(with_parts) {
    assert(std::ranges::is_sorted(node_height_mm));
    assert(!node_height_mm.empty() && node_height_mm.front() == 0);
    values.assign((stamps + 1) * row_size(), 0.0f);
  }
  std::size_t nodes() const { return node_height_mm.size(); }
  std::size_t row_size() const { return whole_size() * (parts ? 2 : 1); }
  /// Values of a row without the part's share.
  std::size_t whole_size() const { return lateral_size() + (axial ? static_cast<std::size_t>(steps) * 2 : 0); }
  /// Values of a row without its axial deflections.
  std::size_t lateral_size() const { return nodes() * static_cast<std::size_t>(steps) * 2; }
  /// Row of stamp k of the stretch; -1 is the stamp before it.
  float* row(std::ptrdiff_t k) { return values.data() + static_cast<std::size_t>(k + 1) * row_size(); }
  const float* row(std::ptrdiff_t k) const { return values.data() + static_cast<std::size_t>(k + 1) * row_size(); }
  float axial_mm(const float* of_row, int step) const {
    return axial ? of_row[lateral_size() + 2 * static_cast<std::size_t>(step)] : 0.0f;
  }
  /// Bounds of the deflections in a row, mm; `largest_mm` of their length.
  double largest_lateral_mm(std::ptrdiff_t k) const;
  double largest_axial_mm(std::ptrdiff_t k) const;
  double largest_mm(std::ptrdiff_t k) const {
    const double lateral = largest_lateral_mm(k);
    return axial ? std::hypot(lateral, largest_axial_mm(k)) : lateral;
  }

  /// Without what is the part's. Requires `parts`.
  DeflectionTable of_tool_alone() const;

  /// Deflection of one row at a height and a rotation step (with its fraction), linear between nodes and steps.
  /// simd/deflection_lanes.h is the vectorized version.
  Vec3 at(const float* row, double height_mm, double step) const;
  /// Rotation step in [0, `steps`) at which an edge passes the point of the envelope at an angle (rad,
  /// counter-clockwise from x) and a height. lag_per_mm: see EnvelopeGrid.
  double step_at(double angle_rad, double height_mm, double lag_per_mm, int flutes) const {
    const double step = (angle_rad - height_mm * lag_per_mm) * steps * flutes / (2 * kPi);
    return step - steps * std::floor(step / steps);
  }
};

/// The axial deflections of a row, after its lateral ones: of each rotation step its own and the next one's.
class AxialRow {
 public:
  explicit AxialRow(std::span<float> values) : values_(values) {}
  double at(std::size_t step) const { return static_cast<double>(values_[2 * step]); }
  void set(std::size_t step, double mm) const {
    values_[2 * step] = static_cast<float>(mm);
    values_[(step == 0 ? values_.size() : 2 * step) - 1] = static_cast<float>(mm);
  }

 private:
  std::span<float> values_;
};

}  // namespace camber::removal
