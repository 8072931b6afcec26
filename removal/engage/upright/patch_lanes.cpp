#include "removal/engage/upright/patch_lanes.h"

#include <algorithm>

#include "base/vector_clones.h"

namespace camber::removal::upright {

PatchLanes::PatchLanes(const EnvelopeGrid& e, const std::vector<double>& node_height_mm) {
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
    normal_x_.push_back(static_cast<float>(patch.normal.x()));
    normal_y_.push_back(static_cast<float>(patch.normal.y()));
    normal_z_.push_back(static_cast<float>(patch.normal.z()));
    normal_spread_.push_back(static_cast<float>(patch.normal_spread));
  }
}

namespace {

CAMBER_VECTOR_CLONES
void along_normals(const float* nx, const float* ny, const float* nz, const float* spread, std::size_t count, float x,
                   float y, float z, float length, float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = x * nx[i] + y * ny[i] + z * nz[i] + length * spread[i];
}

}  // namespace

void PatchLanes::motion_into(const Vec3& motion, std::vector<float>& out) const {
  along_normals(normal_x_.data(), normal_y_.data(), normal_z_.data(), normal_spread_.data(), out.size(),
                static_cast<float>(motion.x()), static_cast<float>(motion.y()), static_cast<float>(motion.z()),
                static_cast<float>(motion.norm()), out.data());
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
