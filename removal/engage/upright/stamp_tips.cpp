#include "removal/engage/upright/stamp_tips.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace camber::removal::upright {
namespace {

float tip_step_mm(const Vec3& extent_mm) {
  constexpr double kSteps = 1 << 30;
  return static_cast<float>(std::max(1.0, extent_mm.maxCoeff()) / kSteps);
}

}  // namespace

StampTips::StampTips(std::span<const Stamp> stamps) : stamps_(stamps) {
  if (stamps.empty()) return;
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

std::int32_t StampTips::steps(const Vec3& tip_mm, int axis) const {
  return static_cast<std::int32_t>(std::lround((tip_mm[axis] - min_mm_[axis]) / static_cast<double>(step_mm_)));
}

void StampTips::append(const Vec3& tip_mm) {
  for (int a = 0; a < 3; ++a) tip_[static_cast<std::size_t>(a)].push_back(steps(tip_mm, a));
}

TipView StampTips::view() const {
  if (!stamps_.empty()) return {stamps_};
  return {{tip_[0].data(), tip_[1].data(), tip_[2].data()}, min_mm_, static_cast<double>(step_mm_)};
}

FixedTips StampTips::fixed(const Vec3& own_mm, std::int32_t first_id) const {
  return {tip_[0].data(), tip_[1].data(), tip_[2].data(), {steps(own_mm, 0), steps(own_mm, 1), steps(own_mm, 2)},
          step_mm_,       first_id};
}

}  // namespace camber::removal::upright
