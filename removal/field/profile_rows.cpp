#include "removal/field/profile_rows.h"

#include <algorithm>
#include <cmath>

#include "base/vector_clones.h"

namespace camber::removal {

ProfileRows::ProfileRows(const Profile& profile) {
  const auto f = [](double v) { return static_cast<float>(v); };
  for (const auto& p : profile.pieces()) {
    if (p.arc) {
      has_arc_ = true;
      arc_ = {f(p.centre.x()),
              f(p.centre.y()),
              f(p.radius_mm),
              f(std::sin(p.normal_from_rad)),
              f(-std::cos(p.normal_from_rad)),
              f(std::sin(p.normal_to_rad)),
              f(-std::cos(p.normal_to_rad))};
    } else {
      line_[static_cast<std::size_t>(lines_++)] = {f(p.start.x()), f(p.start.y()), f(p.along.x()), f(p.along.y()),
                                                   f(p.length_mm)};
    }
  }
}

CAMBER_VECTOR_CLONES
void ProfileRows::distances(const float* __restrict r, const float* __restrict z, int count,
                            float* __restrict out) const {
  std::array<float, kMost> min_squared, outward;
  for (int k = 0; k < count; ++k) {
    min_squared[k] = 1e30f;
    outward[k] = -z[k];
  }
  for (int i = 0; i < lines_; ++i) {
    const Line l = line_[i];
    for (int k = 0; k < count; ++k) {
      const float dr = r[k] - l.r, dz = z[k] - l.z;
      const float along = std::min(std::max(dr * l.along_r + dz * l.along_z, 0.0f), l.length);
      const float er = dr - along * l.along_r, ez = dz - along * l.along_z;
      min_squared[k] = std::min(min_squared[k], er * er + ez * ez);
      outward[k] = std::max(outward[k], dr * l.along_z - dz * l.along_r);
    }
  }
  if (has_arc_) {
    const Arc a = arc_;
    for (int k = 0; k < count; ++k) {
      const float dr = r[k] - a.r, dz = z[k] - a.z;
      const float gap = std::sqrt(dr * dr + dz * dz) - a.radius;
      const bool in_wedge = (a.from_r * dz - a.from_z * dr >= 0) & (dr * a.to_z - dz * a.to_r >= 0);
      min_squared[k] = in_wedge ? std::min(min_squared[k], gap * gap) : min_squared[k];
      outward[k] = in_wedge ? std::max(outward[k], gap) : outward[k];
    }
  }
  for (int k = 0; k < count; ++k) {
    const float d = std::sqrt(min_squared[k]);
    out[k] = outward[k] > 0 ? d : -d;
  }
}

void ProfileRows::column(float r, float z, float step, int count, float* out) const {
  std::array<float, kMost> radius, height;
  for (int k = 0; k < count; ++k) {
    radius[static_cast<std::size_t>(k)] = r;
    height[static_cast<std::size_t>(k)] = z + static_cast<float>(k) * step;
  }
  distances(radius.data(), height.data(), count, out);
}

}  // namespace camber::removal
