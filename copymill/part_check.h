#pragma once
// Judges a path and the stock that is left against the part.
#include <vector>

#include "base/geometry.h"
#include "base/triangle_mesh.h"
#include "copymill/axis_region.h"
#include "copymill/tip_field.h"
#include "machine/copy_operations.h"
#include "removal/cutter.h"
#include "removal/stock.h"

namespace camber::copymill {

/// Depth of the tip's path in the part, by the exact offset surface at places of the path.
class PathDepth {
 public:
  static constexpr double kStep_mm = 0.2;  ///< way between two places

  /// `field`: without allowance.
  explicit PathDepth(const TipField& field) : field_(field) {}
  void add(const Vec3& tip);
  /// Returns the greatest depth of a place: the least shift, up or sideways, that frees the cutter; up to 0.1 mm.
  double max_mm() const { return max_; }
  const Vec3& worst_mm() const { return worst_; }

 private:
  double depth_at(const Vec3& tip) const;

  const TipField& field_;
  Vec3 last_ = Vec3::Constant(1e30), worst_ = Vec3::Zero();
  double max_ = 0;
};

/// A milling operation's tool: where it could touch the part.
struct Reach {
  removal::CutterShape shape;
  const TipField* field = nullptr;  ///< field without allowance
  const AxisRegion* region = nullptr;
  double lowest_mm = 0, highest_mm = 0;  ///< range of the tip's height
};

/// Material left on the part, along its normal, at points of its surface; up to the stock's band.
struct LeftMaterial {
  double max_um = 0, p95_um = 0, mean_um = 0;  ///< material where a tool could touch the part
  Vec3 worst_mm = Vec3::Zero();
  double gouge_um = 0;  ///< greatest depth of the stock's surface below the part's, at these points
  double reached_mm2 = 0;
  double unreached_mm2 = 0;  ///< area of upward faces and walls with material that no tool could touch
};

/// Points about `step_mm` apart. Points within a voxel of an edge are left out: the field is not that sharp.
LeftMaterial left_material(const TriangleMesh& part, const removal::Stock& stock, const std::vector<Reach>& tools,
                           double step_mm);

}  // namespace camber::copymill
