#include "feedmodel/yan_shirase.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numeric>

namespace camber::feedmodel {

double block_feed_number(double feed_mm_per_s, double acceleration_mm_per_s2, double block_length_mm) {
  if (std::isinf(acceleration_mm_per_s2) || block_length_mm <= 0) return 0;
  return feed_mm_per_s * feed_mm_per_s / (acceleration_mm_per_s2 * block_length_mm);
}

double stop_at_every_block_efficiency(double k) { return k < 1 ? 1.0 / (1.0 + k) : 0.5 / std::sqrt(k); }

double BackCorrection::time_s() const { return std::accumulate(time_change_s.begin(), time_change_s.end(), 0.0); }

BackCorrection back_correction(std::span<const BrakingBlock> blocks, double change_mm_per_s,
                               double acceleration_mm_per_s2) {
  BackCorrection out;
  out.exit_change_mm_per_s.resize(blocks.size());
  out.time_change_s.resize(blocks.size());
  double exit_change = change_mm_per_s;
  for (std::size_t i = blocks.size(); i-- > 0;) {
    const BrakingBlock& block = blocks[i];
    const double entry_change = i == 0 ? 0.0 : exit_change * block.exit_mm_per_s / block.entry_mm_per_s;
    out.exit_change_mm_per_s[i] = exit_change;
    out.time_change_s[i] = (entry_change - exit_change) / acceleration_mm_per_s2;
    exit_change = entry_change;
  }
  return out;
}

double three_point_radius(const Vec3& a_mm, const Vec3& b_mm, const Vec3& c_mm) {
  const Vec3 ab = b_mm - a_mm, bc = c_mm - b_mm, ca = a_mm - c_mm;
  const double twice_area = ab.cross(bc).norm();
  const double product = ab.norm() * bc.norm() * ca.norm();
  return twice_area > 1e-12 * ab.norm() * bc.norm() ? product / (2.0 * twice_area)
                                                    : std::numeric_limits<double>::infinity();
}

}  // namespace camber::feedmodel
