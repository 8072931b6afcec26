#pragma once
// A grid of values at points in X and Y.
#include <cmath>
#include <cstddef>

#include "base/geometry.h"

namespace camber::copymill {

struct Grid {
  Vec2 origin = Vec2::Zero();  ///< position of point (0, 0)
  double step_mm = 1;
  int nx = 0, ny = 0;

  /// Covers the rectangle and a margin around it.
  static Grid over(const Vec2& min, const Vec2& max, double margin_mm, double step_mm) {
    Grid out;
    out.step_mm = step_mm;
    out.origin = min - Vec2::Constant(margin_mm);
    const Vec2 size = max - min + Vec2::Constant(2 * margin_mm);
    out.nx = static_cast<int>(std::ceil(size.x() / step_mm)) + 1;
    out.ny = static_cast<int>(std::ceil(size.y() / step_mm)) + 1;
    return out;
  }
  std::size_t size() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny); }
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
  bool holds(int i, int j) const { return i >= 0 && j >= 0 && i < nx && j < ny; }
  Vec2 at(int i, int j) const { return origin + step_mm * Vec2(i, j); }
  /// Position in steps from the origin.
  Vec2 cells(const Vec2& p) const { return (p - origin) / step_mm; }
};

}  // namespace camber::copymill
