#include "removal/engage/upright/patch_lanes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace camber::removal::upright {

PatchLanes::PatchLanes(const EnvelopeGrid& e, const std::vector<double>& node_height_mm, double voxel_mm,
                       double band_mm) {
  std::vector<NodeWeight> weights(e.rings.size());
  if (!node_height_mm.empty())
    for (std::size_t r = 0; r < e.rings.size(); ++r)
      weights[r] = node_weight(node_height_mm, e.rings[r].profile.height_mm);
  for (const auto& patch : e.patches) {
    Range range{static_cast<int>(point_.size()), 0};
    const int all = (patch.ring_to - patch.ring_from) * (patch.step_to - patch.step_from);
    for (int k = 0; k < all || point_.size() % kVector != 0; ++k) {
      const int in = std::min(k, all - 1), steps = patch.step_to - patch.step_from;
      const int r = patch.ring_from + in / steps, i = patch.step_from + in % steps;
      const auto ring = static_cast<std::size_t>(r);
      const auto p = ring * static_cast<std::size_t>(e.steps) + static_cast<std::size_t>(i);
      const auto& profile = e.rings[ring].profile;
      point_.push_back(static_cast<std::uint32_t>(p));
      x_.push_back(e.x[p]), y_.push_back(e.y[p]), z_.push_back(e.z[p]);
      nx_.push_back(e.nx[p]), ny_.push_back(e.ny[p]), nz_.push_back(e.nz[p]);
      cos_phi_.push_back(e.cos_phi[p]), sin_phi_.push_back(e.sin_phi[p]);
      k1_.push_back(static_cast<float>(profile.meridian_curvature_per_mm));
      k2_.push_back(static_cast<float>(profile.parallel_curvature_per_mm));
      sine_.push_back(e.rings[ring].sine), cosine_.push_back(e.rings[ring].cosine);
      per_radius_.push_back(static_cast<float>(1 / std::max(profile.radius_mm, 1e-9)));
      upper_fraction_.push_back(weights[ring].upper_fraction);
      lower_.push_back(weights[ring].lower);
      step_.push_back(i % e.steps_per_pitch);
      range.count += k < all;
    }
    range_.push_back(range);
    add_bounds(e, patch, voxel_mm, band_mm);
  }
  // Points that fill up the last vector never take a chip.
  while (normal_x_.size() % kVector != 0) {
    for (auto* v : {&centre_x_, &centre_y_, &centre_z_, &bottom_, &reach_, &normal_x_, &normal_y_, &normal_z_,
                    &lateral_, &curvature_})
      v->push_back(0);
    normal_spread_.push_back(-1e9f);
  }
}

void PatchLanes::add_bounds(const EnvelopeGrid& e, const EnvelopeGrid::Patch& patch, double voxel_mm, double band_mm) {
  float bottom = std::numeric_limits<float>::infinity(), lateral = 0;
  double curvature = 0;
  for (int r = patch.ring_from; r < patch.ring_to; ++r) {
    const auto& profile = e.rings[static_cast<std::size_t>(r)].profile;
    curvature = std::max({curvature, profile.meridian_curvature_per_mm, profile.parallel_curvature_per_mm});
    for (int i = patch.step_from; i < patch.step_to; ++i) {
      const auto p = static_cast<std::size_t>(r) * static_cast<std::size_t>(e.steps) + static_cast<std::size_t>(i);
      bottom = std::min(bottom, e.z[p]);
      lateral = std::max(lateral, std::hypot(e.nx[p], e.ny[p]));
      widest_mm_ = std::max(widest_mm_, (Vec2(e.x[p], e.y[p]) - patch.centre_from_tip.head<2>()).norm());
    }
  }
  // Measured from the voxel nearest to the centre; patches wider than the band are never skipped.
  const double reach = patch.radius_mm + 0.87 * voxel_mm;
  reach_.push_back(reach < 0.999 * band_mm ? static_cast<float>(reach) : 1e9f);
  bottom_.push_back(bottom);
  lateral_.push_back(lateral);
  curvature_.push_back(static_cast<float>(curvature));
  centre_x_.push_back(static_cast<float>(patch.centre_from_tip.x()));
  centre_y_.push_back(static_cast<float>(patch.centre_from_tip.y()));
  centre_z_.push_back(static_cast<float>(patch.centre_from_tip.z()));
  normal_x_.push_back(static_cast<float>(patch.normal.x()));
  normal_y_.push_back(static_cast<float>(patch.normal.y()));
  normal_z_.push_back(static_cast<float>(patch.normal.z()));
  normal_spread_.push_back(static_cast<float>(patch.normal_spread));
}

BlockBounds PatchLanes::bounds() const {
  return {static_cast<int>(normal_x_.size()),
          centre_x_.data(),
          centre_y_.data(),
          centre_z_.data(),
          bottom_.data(),
          reach_.data(),
          normal_x_.data(),
          normal_y_.data(),
          normal_z_.data(),
          normal_spread_.data(),
          lateral_.data(),
          curvature_.data()};
}

PointLanes PatchLanes::view() const {
  return {x_.data(),          y_.data(),
          z_.data(),          nx_.data(),
          ny_.data(),         nz_.data(),
          cos_phi_.data(),    sin_phi_.data(),
          k1_.data(),         k2_.data(),
          sine_.data(),       cosine_.data(),
          per_radius_.data(), upper_fraction_.data(),
          lower_.data(),      step_.data()};
}

}  // namespace camber::removal::upright
