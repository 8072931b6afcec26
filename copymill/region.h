#pragma once
// Where the tool's axis may be while it cuts, in X and Y.
#include <vector>

#include "base/geometry.h"
#include "machine/copy_operations.h"

namespace camber::copymill {

/// A rectangle or a polygon; the border belongs to it.
class AxisRegion {
 public:
  /// That of an operation; without one, the rectangle.
  AxisRegion(const machine::CopyRegion& region, const Vec2& stock_min, const Vec2& stock_max);

  bool contains(const Vec2& p) const;
  const Vec2& min_mm() const { return min_; }
  const Vec2& max_mm() const { return max_; }

 private:
  std::vector<Vec2> polygon_;  ///< empty: the rectangle
  Vec2 min_, max_;
};

}  // namespace camber::copymill
