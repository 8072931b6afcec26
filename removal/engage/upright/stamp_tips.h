#pragma once
// Gives the tip of a stamp by its number, for a whole run or for one that grows while it is cut, in twelve bytes a
// stamp.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "removal/known_run.h"
#include "removal/simd/upright_block_kernels.h"
#include "removal/tool_path.h"

namespace camber::removal::upright {

/// Reads tips from the stamps themselves, or from integer steps within a box.
class TipView {
 public:
  TipView(std::span<const Stamp> stamps) : stamps_(stamps.data()) {}
  TipView(const std::array<const std::int32_t*, 3>& fixed, const Vec3& min_mm, double step_mm)
      : fixed_(fixed), min_mm_(min_mm), step_mm_(step_mm) {}

  Vec3 operator[](std::int32_t k) const {
    if (stamps_) return stamps_[k].pose.tip_mm;
    return min_mm_ + step_mm_ * Vec3(fixed_[0][k], fixed_[1][k], fixed_[2][k]);
  }

 private:
  const Stamp* stamps_ = nullptr;
  std::array<const std::int32_t*, 3> fixed_{};
  Vec3 min_mm_ = Vec3::Zero();
  double step_mm_ = 0;
};

/// Stores tips as integer steps, a billionth of their range each; twelve bytes per tip.
class StampTips {
 public:
  /// For a whole run, which must outlive the object: view() has the exact tips. `known` (may be null) brings its
  /// own steps.
  explicit StampTips(std::span<const Stamp> stamps, const KnownRun* known = nullptr);
  /// For a run that grows, with tips in this box: view() has them to a billionth of the box. Space for `expected` tips
  /// is reserved, so that no append() takes longer than another.
  StampTips(const Vec3& min_mm, const Vec3& max_mm, std::size_t expected);

  void append(const Vec3& tip_mm);
  std::size_t size() const { return tip_[0].size(); }
  TipView view() const;
  /// Tips as the kernels take them; `own_mm`: tip of the stamp that reads.
  FixedTips fixed(const Vec3& own_mm, std::int32_t first_id) const;

 private:
  std::int32_t steps(const Vec3& tip_mm, int axis) const { return tip_steps(tip_mm[axis], min_mm_[axis], step_mm_); }
  std::array<const std::int32_t*, 3> data() const;

  std::span<const Stamp> stamps_;
  Vec3 min_mm_ = Vec3::Zero();
  float step_mm_ = 1;
  std::shared_ptr<const TipSteps> known_;         ///< tips of a known run
  std::array<std::vector<std::int32_t>, 3> tip_;  ///< tips of any other run
};

}  // namespace camber::removal::upright
