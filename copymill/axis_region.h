#pragma once
// Region of an operation: where the tool's axis may be in X and Y while it cuts.
#include <vector>

#include "base/geometry.h"
#include "machine/copy_operations.h"

namespace camber::copymill {

/// A rectangle, a polygon or boxes, each with the levels of the tip there; the border belongs to it.
class AxisRegion {
 public:
  /// Takes the region of an operation; where it is not given, the rectangle of the stock.
  AxisRegion(const machine::CopyRegion& region, const Vec2& stock_min, const Vec2& stock_max);

  /// Returns whether the axis may be at p at some level.
  bool contains(const Vec2& p) const;
  /// Returns whether the axis may be at p at a level of the tip. A box's upper end does not belong to it: what is cut
  /// there lies above.
  bool contains(const Vec2& p, double z_mm) const;
  bool depends_on_level() const { return !boxes_.empty(); }
  const std::vector<machine::CopyRegion::Box>& boxes_mm() const { return boxes_; }
  const Vec2& min_mm() const { return min_; }
  const Vec2& max_mm() const { return max_; }

 private:
  std::vector<Vec2> polygon_;  ///< empty: the rectangle
  std::vector<machine::CopyRegion::Box> boxes_;
  Vec2 min_, max_;
};

}  // namespace camber::copymill
