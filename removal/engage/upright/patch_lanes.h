#pragma once
// The envelope's points patch by patch, as removal/simd/upright_kernels.h reads them.
#include <cstdint>
#include <vector>

#include "removal/cutter.h"
#include "removal/deflection_table.h"
#include "removal/simd/upright_kernels.h"

namespace camber::removal::upright {

class PatchLanes {
 public:
  static constexpr int kVector = 8;  ///< patches are filled up to whole vectors with copies of their last point

  /// `node_height_mm`: of the deflection tables that will be read; may be empty.
  PatchLanes(const EnvelopeGrid& envelope, const std::vector<double>& node_height_mm);

  struct Range {
    int from = 0, count = 0;
  };
  Range range(std::uint32_t patch) const { return range_[patch]; }
  std::uint32_t point(int lane) const { return point_[static_cast<std::size_t>(lane)]; }
  PointLanes view() const;
  /// Of each patch: how far a motion goes along its outward normals at most, mm. out.size(): the number of patches.
  void motion_into(const Vec3& motion_mm, std::vector<float>& out) const;

 private:
  std::vector<Range> range_;
  std::vector<float> normal_x_, normal_y_, normal_z_, normal_spread_;  ///< of the patches
  std::vector<std::uint32_t> point_;
  std::vector<float> x_, y_, z_, nx_, ny_, nz_, cos_phi_, sin_phi_, k1_, k2_, sine_, cosine_, per_radius_,
      upper_fraction_;
  std::vector<std::int32_t> lower_, step_;
};

}  // namespace camber::removal::upright
