#pragma once
// A stock seen from above: what stands in each cell of a grid in X and Y. Exact for upright cutters without undercuts,
// and far quicker than the distance field: for checks, not for chips.
#include <cstddef>
#include <optional>
#include <vector>

#include "base/geometry.h"
#include "base/triangle_mesh.h"
#include "removal/cutter.h"

namespace camber::removal {

/// The lower side of a cutter as a height over the distance from its axis, from the tip.
class CutterBottom {
 public:
  /// shrink_mm: the cutter made smaller along its normal; its tip rises by as much. Requires it to be less than the
  /// radius.
  explicit CutterBottom(const CutterShape& shape, double shrink_mm = 0);
  double radius_mm() const { return radius_; }
  /// Heights of `count` cells of a row, `step_mm` apart from `first_x_mm` on, at the distance `y_mm` from the axis;
  /// infinite beside the cutter.
  void row(double first_x_mm, double step_mm, double y_mm, std::size_t count, float* out) const;
  /// Distance between two places of the cutter at which what stands between them is below `tolerance_mm`.
  double step_mm(double tolerance_mm) const;

 private:
  double radius_ = 0, corner_ = 0, rise_ = 0;
  std::vector<float> table_;  ///< height of the lower side over the distance from the axis; general cutters alone
};

class HeightMap {
 public:
  HeightMap(const Vec3& min_mm, const Vec3& max_mm, double cell_mm);
  /// Highest point of the mesh over each cell; cells beside it are empty.
  HeightMap(const TriangleMesh& mesh, double cell_mm);

  const Vec3& min_mm() const { return lo_; }
  const Vec3& max_mm() const { return hi_; }
  double cell_mm() const { return cell_; }
  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  double at(std::size_t column, std::size_t row) const { return height_[row * columns_ + column]; }
  Vec2 centre(std::size_t column, std::size_t row) const {
    return {lo_.x() + (static_cast<double>(column) + 0.5) * cell_, lo_.y() + (static_cast<double>(row) + 0.5) * cell_};
  }
  /// Empties the cells beside an upright cylinder.
  void keep_cylinder(const Vec2& middle_mm, double radius_mm);
  /// A part of the mesh lies above air: a map does not describe it.
  bool undercut() const { return undercut_; }
  /// Material above min_mm().z(), mm^3.
  double volume_mm3() const;
  /// Area of the surface that lies lower than max_mm().z(), steps between cells included, mm^2.
  double cut_area_mm2() const;

  /// The material that a cutter takes away at one place.
  struct Cut {
    double volume_mm3 = 0;
    double area_mm2 = 0;      ///< area of the cells that are lowered
    double deepest_mm = 0;    ///< largest lowering of a cell
    double above_tip_mm = 0;  ///< height of the highest material that is removed
  };
  Cut cut(const CutterBottom& cutter, const Vec3& tip);
  /// A cell in which material stands above the cutter's lower side; its top.
  std::optional<Vec3> touch(const CutterBottom& cutter, const Vec3& tip) const;
  /// A cell nearer to the axis than `radius_mm` whose material stands above z.
  std::optional<Vec3> touch_disc(const Vec2& axis, double radius_mm, double z) const;

 private:
  struct Range {
    std::size_t from = 0, to = 0;
  };
  void take_size(const Vec3& min_mm, const Vec3& max_mm, double cell_mm);
  Range cells(double from_mm, double to_mm, int axis) const;
  /// Highest of a block of cells, brought up to date where it seems to be above z.
  double block_top(std::size_t block_column, std::size_t block_row, double z) const;
  std::size_t blocks_per_row() const;

  Vec3 lo_ = Vec3::Zero(), hi_ = Vec3::Zero();
  double cell_ = 1;
  std::size_t columns_ = 0, rows_ = 0;
  std::vector<float> height_;
  mutable std::vector<float> block_top_;  ///< never too low
  bool undercut_ = false;
};

}  // namespace camber::removal
