#pragma once
// Tip field: the lowest height of the tool's tip over (x, y), that is the part's offset surface with an allowance.
#include <limits>

#include "base/geometry.h"
#include "base/triangle_mesh.h"
#include "removal/cutter.h"
#include "repath/raster/drop_cutter.h"

namespace camber::copymill {

/// Lowest height of the tip above each point at which the cutter stays an allowance away from the part, measured along
/// the normal. Exact but for rounding: a cutter grown by the allowance (its rounding and its radius alike) is lowered
/// onto the mesh (repath/raster/drop_cutter.h), and its tip is the allowance lower than the tool's own.
class TipField {
 public:
  static constexpr double kNothingBelow = -std::numeric_limits<double>::infinity();

  /// Requires a shape that is not general.
  TipField(const TriangleMesh& part, const removal::CutterShape& shape, double allowance_mm);

  /// Returns the lowest height of the tip; kNothingBelow where no part lies under the cutter.
  double lowest_mm(const Vec2& axis) const {
    const auto contact = drop_.at(axis);
    return contact ? contact->tip_mm + allowance_mm_ : kNothingBelow;
  }
  /// Returns whether the tip may be there; contact counts as free.
  bool free(const Vec2& axis, double tip_mm) const { return lowest_mm(axis) <= tip_mm + kContact_mm; }

  double allowance_mm() const { return allowance_mm_; }
  const repath::DropCutter& drop() const { return drop_; }  ///< drop cutter of the tool grown by the allowance

 private:
  static constexpr double kContact_mm = 1e-7;
  repath::DropCutter drop_;
  double allowance_mm_;
};

}  // namespace camber::copymill
