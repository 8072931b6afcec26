#pragma once
// Arranges the envelope's points patch by patch in the arrays that the vector kernels read
// (removal/simd/upright_kernels.h).
#include <cstdint>
#include <vector>

#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/simd/upright_kernels.h"

namespace camber::removal::upright {

class PatchLanes {
 public:
  static constexpr int kVector = 8;  ///< patches are filled up to whole vectors with copies of their last point

  /// `node_height_mm`: node heights of the deflection tables that will be read; may be empty.
  /// `band_mm`, `voxel_mm`: narrow band and voxel of the stock that is read.
  PatchLanes(const EnvelopeGrid& envelope, const std::vector<double>& node_height_mm, double voxel_mm, double band_mm);

  struct Range {
    int from = 0, count = 0;
  };
  Range range(std::uint32_t patch) const { return range_[patch]; }
  std::uint32_t point(int lane) const { return point_[static_cast<std::size_t>(lane)]; }
  PointLanes view() const;
  /// Bounds of the patches, filled up to whole vectors with patches that are never found.
  BlockBounds bounds() const;
  /// Largest horizontal distance of a point from the centre of its patch.
  double widest_mm() const { return widest_mm_; }

 private:
  void add_bounds(const EnvelopeGrid& envelope, const EnvelopeGrid::Patch& patch, double voxel_mm, double band_mm);

  std::vector<Range> range_;
  double widest_mm_ = 0;
  // One entry per patch:
  std::vector<float> centre_x_, centre_y_, centre_z_, bottom_, reach_;
  std::vector<float> normal_x_, normal_y_, normal_z_, normal_spread_, lateral_, curvature_;
  // One entry per point (lane):
  std::vector<std::uint32_t> point_;
  std::vector<float> x_, y_, z_, nx_, ny_, nz_, cos_phi_, sin_phi_, k1_, k2_, sine_, cosine_, per_radius_,
      upper_fraction_;
  std::vector<std::int32_t> lower_, step_;
};

}  // namespace camber::removal::upright
