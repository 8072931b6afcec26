#pragma once
// Clear height: a height above which rapids meet nothing, cell by cell, kept over all operations.
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/geometry.h"
#include "copymill/grid.h"
#include "removal/cutter.h"
#include "removal/stock.h"

namespace camber::copymill {

/// Upper bound of the material's height in each cell; Standing has a sample at the cell's middle instead. It also
/// covers material narrower than a cell, such as the fin between two cuts that nearly meet. It is kept over all
/// operations of a run, since the stock's voxels lose such fins. Cells along walls keep the height of the wall.
///
/// Material of the given stock that is narrower than a voxel is not seen.
class ClearHeight {
 public:
  static constexpr double kAir = -1e30;

  /// `smallest_mm`: the smallest tool diameter; cells are a fraction of it wide, and at most two million.
  ClearHeight(const removal::Stock& stock, double smallest_mm);

  /// Lowers the cells that lie completely under the cutter at a place where it has cut.
  void lower(const removal::CutterShape& shape, const Vec3& tip);
  /// Returns the lowest height of the tip at which the cutter certainly meets nothing; kAir where there is no material.
  double lowest_clear_tip_mm(const removal::CutterShape& shape, const Vec2& axis) const;
  /// Returns the greatest height of all cells that a rectangle touches; kAir where there are none.
  double over_mm(const Vec2& min, const Vec2& max) const;
  double cell_mm() const { return grid_.step_mm; }

 private:
  struct Row {
    int j, first, last;  ///< cells of row j whose middles are within a disc
  };
  template <class Visit>
  void rows(const Vec2& axis, double radius_mm, Visit visit) const;

  Grid grid_;
  double half_diagonal_mm_;
  std::vector<float> height_;
};

/// Height of the cutter's underside above its tip at a distance from the axis; 1e30 at the radius and beyond.
inline double underside_mm(const removal::CutterShape& shape, double r) {
  if (r >= shape.radius_mm) return 1e30;
  if (shape.general) return shape.profile.height_at_radius_mm(r);
  const double out = r - (shape.radius_mm - shape.corner_radius_mm);
  return out <= 0 ? 0
                  : shape.corner_radius_mm -
                        std::sqrt(std::max(0.0, shape.corner_radius_mm * shape.corner_radius_mm - out * out));
}

}  // namespace camber::copymill
