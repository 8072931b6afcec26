#pragma once
// Marks of deflected rounded cutters on points of the surface, found many at once.
#include <array>
#include <cstdint>
#include <vector>

#include "base/geometry.h"
#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/field/stamp_deflection.h"
#include "removal/simd/upright_mark_kernels.h"

namespace camber::removal {

/// Pairs of a point and a stamp that may lower it, side by side.
class MarkQueue {
 public:
  struct Pair {
    std::size_t point, stamp;
  };

  MarkQueue(const EnvelopeGrid& envelope, const DeflectionTable& deflections)
      : first_row_(deflections.values.data()),
        tool_{{first_row_, nullptr, static_cast<int>(deflections.nodes()), deflections.steps,
               deflections.nodes() > 1 ? static_cast<float>(deflections.node_height_mm[1]) : 1.0f, deflections.axial},
              static_cast<float>(envelope.shape.bottom_length_mm()),
              static_cast<float>(envelope.shape.corner_radius_mm),
              static_cast<float>(envelope.lag_per_mm),
              static_cast<float>(deflections.steps * envelope.flutes / (2 * kPi))} {}

  /// `place`, `normal`: of the point, in the tool's frame; `highest_mm`: the mark counts if it is lower.
  void add(const Pair& pair, const Eigen::Vector3f& place, const Eigen::Vector3f& normal, double highest_mm,
           const StampDeflection& deflection) {
    pairs_.push_back(pair);
    const std::array<float, kValues> values{place.x(),
                                            place.y(),
                                            place.z(),
                                            normal.x(),
                                            normal.y(),
                                            normal.z(),
                                            static_cast<float>(highest_mm),
                                            static_cast<float>(deflection.largest_mm)};
    for (std::size_t v = 0; v < kValues; ++v) lanes_[v].push_back(values[v]);
    deflection_index_.push_back(static_cast<std::int32_t>((deflection.row - first_row_) / 2));
  }

  /// Calls lowered(pair, height) for all that are lowered, in the order of add, and forgets them.
  template <class Function>
  void settle(Function lowered) {
    const std::size_t count = pairs_.size();
    if (count == 0) return;
    while (deflection_index_.size() % upright::MarkLanes::kLanes != 0) {
      for (auto& values : lanes_) values.push_back(values.back());
      deflection_index_.push_back(deflection_index_.back());
    }
    height_.resize(deflection_index_.size());
    const auto& l = lanes_;
    upright::mark_kernels().heights(
        {static_cast<int>(deflection_index_.size()), l[0].data(), l[1].data(), l[2].data(), l[3].data(), l[4].data(),
         l[5].data(), l[6].data(), l[7].data(), deflection_index_.data(), height_.data()},
        tool_);
    for (std::size_t i = 0; i < count; ++i)
      if (height_[i] < lanes_[kHighest][i]) lowered(pairs_[i], static_cast<double>(height_[i]));
    pairs_.clear();
    for (auto& values : lanes_) values.clear();
    deflection_index_.clear();
  }

 private:
  static constexpr std::size_t kValues = 8, kHighest = 6;  ///< as upright::MarkLanes has them
  const float* first_row_;
  upright::MarkTool tool_;
  std::vector<Pair> pairs_;
  std::array<std::vector<float>, kValues> lanes_;
  std::vector<std::int32_t> deflection_index_;
  std::vector<float> height_;
};

}  // namespace camber::removal
