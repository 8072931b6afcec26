#include "deflection/part_compliance.h"

#include <algorithm>
#include <cassert>

namespace camber::deflection {

Eigen::MatrixXd PartCompliance::at(std::size_t stamp) const {
  assert(!places.empty());
  const auto after = std::ranges::upper_bound(places, stamp, {}, &Place::stamp);
  if (after == places.begin()) return places.front().mm_per_N;
  const auto before = after - 1;
  if (after == places.end()) return before->mm_per_N;
  const double way = static_cast<double>(stamp - before->stamp) / static_cast<double>(after->stamp - before->stamp);
  return (1 - way) * before->mm_per_N + way * after->mm_per_N;
}

HeightWeight height_weight(const PartCompliance& part, double height_mm) {
  assert(part.heights() >= 2);
  const double at = std::clamp(height_mm / part.height_mm[1], 0.0, static_cast<double>(part.heights() - 1));
  const std::size_t lower = std::min(static_cast<std::size_t>(at), part.heights() - 2);
  return {lower, at - static_cast<double>(lower)};
}

Vec2 lateral_at(const PartCompliance& part, double height_mm, const Eigen::VectorXd& moved) {
  const HeightWeight w = height_weight(part, height_mm);
  const auto lower = 2 * static_cast<Eigen::Index>(w.lower);
  return w.of_lower() * moved.segment<2>(lower) + w.upper_fraction * moved.segment<2>(lower + 2);
}

}  // namespace camber::deflection
