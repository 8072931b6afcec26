#pragma once
// Standing material: the height of the material in each cell, as the planner sees the stock.
#include <vector>

#include "base/geometry.h"
#include "copymill/grid.h"
#include "copymill/path_piece.h"
#include "removal/cutter.h"
#include "removal/stock.h"

namespace camber::copymill {

/// Height of the stock in each cell, at the cell's middle. It serves planning only: where a pass meets material, how
/// high the tool must be lifted. Loads and the result come from the stock itself.
class Standing {
 public:
  static constexpr double kAir = -1e30;

  /// Reads the stock, column by column, down to `floor_mm`, where all cells end at the latest.
  Standing(const removal::Stock& stock, double cell_mm, double floor_mm);

  /// Lowers the cells that the cutter passes on its way from one place to another.
  void cut(const removal::CutterShape& shape, const Vec3& from, const Vec3& to);
  /// Returns whether the cutter, its tip there, meets material by more than `more_than_mm` of height.
  bool meets(const removal::CutterShape& shape, const Vec3& tip, double more_than_mm) const;
  /// Returns the angle of the cutter's leading half circumference, up to pi, that has material beside it, for a level
  /// motion along a unit vector. Sampled every 7.5 degrees, at 0.97, 0.8 and 0.6 of the radius.
  double engaged_rad(const removal::CutterShape& shape, const Vec3& tip, const Vec2& direction,
                     double more_than_mm) const;
  /// Returns the greatest height of the material in a rectangle; kAir where there is none.
  double highest_mm(const Vec2& min, const Vec2& max) const;
  /// Returns the greatest height of the material under a disc.
  double highest_under_mm(const Vec2& axis, double radius_mm) const;
  double at(const Vec2& p) const;
  double top_mm() const { return top_; }  ///< greatest height when it was read
  double cell_mm() const { return grid_.step_mm; }
  const Grid& grid() const { return grid_; }

 private:
  template <class Visit>
  void visit(const Vec2& axis, double radius_mm, Visit visit) const;

  Grid grid_;
  std::vector<float> top_of_cell_;
  double top_ = kAir;
};

/// Returns the stretches of a pass that meet material, `lead_mm` longer at either end; gaps shorter than `join_mm` are
/// included. A pass that meets material everywhere stays as it is.
std::vector<Pass> stretches_in_material(const Standing& standing, const removal::CutterShape& shape, const Pass& pass,
                                        double more_than_mm, double lead_mm, double join_mm);

}  // namespace camber::copymill
