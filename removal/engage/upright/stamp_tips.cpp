#include "removal/engage/upright/stamp_tips.h"

#include <algorithm>
#include <limits>

namespace camber::removal::upright {
StampTips::StampTips(std::span<const Stamp> stamps, const KnownRun* known) : stamps_(stamps) {
  if (stamps.empty()) return;
  if (known) {
    min_mm_ = known->min_mm;
    step_mm_ = tip_step_mm(known->max_mm - known->min_mm);
    known_ = known->tips;
    return;
  }
  min_mm_ = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 max = -min_mm_;
  for (const Stamp& s : stamps) {
    min_mm_ = min_mm_.cwiseMin(s.pose.tip_mm);
    max = max.cwiseMax(s.pose.tip_mm);
  }
  step_mm_ = tip_step_mm(max - min_mm_);
  for (auto& tips : tip_) tips.reserve(stamps.size());
  for (const Stamp& s : stamps) append(s.pose.tip_mm);
}

StampTips::StampTips(const Vec3& min_mm, const Vec3& max_mm, std::size_t expected)
    : min_mm_(min_mm), step_mm_(tip_step_mm(max_mm - min_mm)) {
  for (auto& tips : tip_) tips.reserve(expected);
}

void StampTips::append(const Vec3& tip_mm) {
  for (int a = 0; a < 3; ++a) tip_[static_cast<std::size_t>(a)].push_back(steps(tip_mm, a));
}

std::array<const std::int32_t*, 3> StampTips::data() const {
  if (known_) return {(*known_)[0].all().data(), (*known_)[1].all().data(), (*known_)[2].all().data()};
  return {tip_[0].data(), tip_[1].data(), tip_[2].data()};
}

TipView StampTips::view() const {
  if (!stamps_.empty()) return {stamps_};
  return {data(), min_mm_, static_cast<double>(step_mm_)};
}

FixedTips StampTips::fixed(const Vec3& own_mm, std::int32_t first_id) const {
  const auto tips = data();
  return {tips[0], tips[1], tips[2], {steps(own_mm, 0), steps(own_mm, 1), steps(own_mm, 2)}, step_mm_, first_id};
}

}  // namespace camber::removal::upright
