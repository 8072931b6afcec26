#include "removal/engagement.h"
#include "removal/simd/upright_block_kernels.h"

#include <algorithm>
#include <limits>

#include "removal/engage/upright/level_faces.h"

namespace camber::removal {

EnvelopeBlocks::EnvelopeBlocks(const EnvelopeGrid& e, double voxel_mm, double band_mm) {
  const int rings = static_cast<int>(e.rings.size());
  const std::vector<float> wall_half_mm = upright::wall_half_widths_mm(e);
  for (int ring = 0; ring < rings; ring += kRings)
    for (int pitch = 0; pitch < e.flutes; ++pitch)
      for (int step = 0; step < e.steps_per_pitch; step += kSteps)
        add(e, wall_half_mm, ring, step, pitch * e.steps_per_pitch, voxel_mm, band_mm);
  lowest_.resize(block_.size());
  float lowest = std::numeric_limits<float>::infinity();
  for (std::size_t b = block_.size(); b-- > 0;) {
    for (std::size_t l = 0; l < kLanes; ++l) lowest = std::min(lowest, z_[b * kLanes + l]);
    lowest_[b] = lowest;
  }
  // Whole vectors: points that fill up the last one never take a chip.
  for (std::size_t n = block_.size(); n % kLanes != 0; ++n) {
    for (auto* v : {&bottom_, &centre_x_, &centre_y_, &centre_z_, &reach_, &normal_x_, &normal_y_, &normal_z_})
      v->push_back(0);
    spread_.push_back(-1e9f);
  }
}

void EnvelopeBlocks::add(const EnvelopeGrid& e, const std::vector<float>& wall_half_mm, int ring, int step,
                         int first_of_pitch, double voxel_mm, double band_mm) {
  block_.push_back({ring, step});
  std::vector<std::size_t> real;
  for (int lane = 0; lane < kLanes; ++lane) {
    const int r = ring + lane / kSteps, s = step + lane % kSteps;
    const bool is_point = r < static_cast<int>(e.rings.size()) && s < e.steps_per_pitch;
    const int in_r = std::min(r, static_cast<int>(e.rings.size()) - 1), in_s = std::min(s, e.steps_per_pitch - 1);
    const auto p = static_cast<std::size_t>(in_r) * static_cast<std::size_t>(e.steps) +
                   static_cast<std::size_t>(first_of_pitch + in_s);
    const auto& profile = e.rings[static_cast<std::size_t>(in_r)].profile;
    // A lane without a normal, and with a curvature that removes every chip, never takes one.
    constexpr float kHollow_per_mm = -1e6f;
    const float counts = is_point ? 1.0f : 0.0f;
    if (is_point) real.push_back(p);
    point_.push_back(is_point ? static_cast<std::uint32_t>(p) : kNoPoint);
    x_.push_back(e.x[p]), y_.push_back(e.y[p]), z_.push_back(e.z[p]);
    nx_.push_back(counts * e.nx[p]), ny_.push_back(counts * e.ny[p]), nz_.push_back(counts * e.nz[p]);
    cos_phi_.push_back(e.cos_phi[p]), sin_phi_.push_back(e.sin_phi[p]);
    wall_half_.push_back(wall_half_mm[static_cast<std::size_t>(in_r)]);
    k1_.push_back(is_point ? static_cast<float>(profile.meridian_curvature_per_mm) : kHollow_per_mm);
    k2_.push_back(is_point ? static_cast<float>(profile.parallel_curvature_per_mm) : kHollow_per_mm);
  }
  const auto place = [&](std::size_t p) { return Vec3(e.x[p], e.y[p], e.z[p]); };
  const auto normal = [&](std::size_t p) { return Vec3(e.nx[p], e.ny[p], e.nz[p]); };
  Vec3 centre = Vec3::Zero(), mean = Vec3::Zero();
  for (const std::size_t p : real) centre += place(p), mean += normal(p);
  centre /= static_cast<double>(real.size()), mean /= static_cast<double>(real.size());
  double extent = 0, spread = 0;
  float bottom = std::numeric_limits<float>::infinity();
  for (const std::size_t p : real) {
    const Vec3 from_centre = place(p) - centre;
    extent = std::max(extent, from_centre.norm());
    widest_mm_ = std::max(widest_mm_, from_centre.head<2>().norm());
    bottom = std::min(bottom, e.z[p]);
    spread = std::max(spread, (normal(p) - mean).norm());
  }
  // Measured from the voxel nearest to the centre; blocks wider than the band are never skipped.
  const double reach = extent + 0.87 * voxel_mm;
  reach_.push_back(reach < 0.999 * band_mm ? static_cast<float>(reach) : 1e9f);
  bottom_.push_back(bottom);
  centre_x_.push_back(static_cast<float>(centre.x()));
  centre_y_.push_back(static_cast<float>(centre.y()));
  centre_z_.push_back(static_cast<float>(centre.z()));
  normal_x_.push_back(static_cast<float>(mean.x()));
  normal_y_.push_back(static_cast<float>(mean.y()));
  normal_z_.push_back(static_cast<float>(mean.z()));
  spread_.push_back(static_cast<float>(spread));
}

int EnvelopeBlocks::up_to(double height_mm) const {
  const auto at = std::upper_bound(lowest_.begin(), lowest_.end(), static_cast<float>(height_mm)) - lowest_.begin();
  return (static_cast<int>(at) + kLanes - 1) / kLanes * kLanes;
}

upright::BlockPoints EnvelopeBlocks::points() const {
  return {x_.data(),       y_.data(),       z_.data(),  nx_.data(), ny_.data(),       nz_.data(),
          cos_phi_.data(), sin_phi_.data(), k1_.data(), k2_.data(), wall_half_.data()};
}

upright::BlockBounds EnvelopeBlocks::bounds() const {
  return {static_cast<int>(spread_.size()),
          centre_x_.data(),
          centre_y_.data(),
          centre_z_.data(),
          bottom_.data(),
          reach_.data(),
          normal_x_.data(),
          normal_y_.data(),
          normal_z_.data(),
          spread_.data()};
}

}  // namespace camber::removal
