#pragma once
// Where the stamps of a run stand, by number: of a whole run, or of one that grows while it is cut.
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

/// Tips as the stamps have them, or from whole steps of a box.
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

/// Tips in steps that are a billionth of their range, twelve bytes each.
class StampTips {
 public:
  /// Of a whole run, which must outlive the object: view() has the tips as they are. Of a known_run() its own are used.
  explicit StampTips(std::span<const Stamp> stamps);
  /// Of a run that grows, with tips in this box: view() has them to a billionth of it. Room for `expected` is set
  /// aside, so that none of them takes longer than another; memory is used as they come.
  StampTips(const Vec3& min_mm, const Vec3& max_mm, std::size_t expected);

  void append(const Vec3& tip_mm);
  std::size_t size() const { return tip_[0].size(); }
  TipView view() const;
  /// For the kernels; `own_mm`: of the stamp that reads.
  FixedTips fixed(const Vec3& own_mm, std::int32_t first_id) const;

 private:
  std::int32_t steps(const Vec3& tip_mm, int axis) const { return tip_steps(tip_mm[axis], min_mm_[axis], step_mm_); }
  std::array<const std::int32_t*, 3> data() const;

  std::span<const Stamp> stamps_;
  Vec3 min_mm_ = Vec3::Zero();
  float step_mm_ = 1;
  std::shared_ptr<const TipSteps> known_;         ///< of a known run
  std::array<std::vector<std::int32_t>, 3> tip_;  ///< of any other
};

}  // namespace camber::removal::upright
