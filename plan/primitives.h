#pragma once
// The removal volume in primitives: boxes and upright cylinders, by one of three ways to divide.
#include <string_view>
#include <vector>

#include "plan/removal_volume.h"

namespace camber::plan {

/// After planes parallel to xy (the heights come first): by planes parallel to yz, parallel to zx, or by both, so that
/// each box is as large as possible.
enum class DivisionPlan : unsigned char { yz, zx, largest };
inline constexpr std::array<DivisionPlan, 3> kDivisionPlans{DivisionPlan::yz, DivisionPlan::zx, DivisionPlan::largest};
std::string_view to_string(DivisionPlan plan);

struct VolumePrimitive {
  bool is_hole = false;
  bool free_form = false;        ///< one of its faces is
  bool contoured = false;        ///< a part stays in it, with upright walls
  bool overhang = false;         ///< a free-form face of it looks down
  std::vector<CellIndex> cells;  ///< ascending; none of a hole; all of the box but of slivers that are joined
  std::size_t hole = 0;          ///< among RemovalVolume::holes
  Vec3 min_mm = Vec3::Zero(), max_mm = Vec3::Zero();
  double volume_mm3 = 0;  ///< to be removed
  Vec3 middle() const { return 0.5 * (min_mm + max_mm); }
};

/// Each layer between two neighbouring planes parallel to xy is divided by itself, and in it each connected region by
/// the planes that its own outline has: a pocket is not cut by planes of another one. A region with a free-form face is
/// one primitive, with those above and below it that it touches. `largest` takes the greatest rectangle that is left
/// again and again (equal: less perimeter, then less x, then less y of the middle), or one of the other ways where that
/// gives fewer boxes. A plane parallel to xy does not divide what is alike above and below: it is the floor of another
/// region. A box narrower than the smallest mill that lies along another one is joined to that, and a layer thinner
/// than a tenth of it to the layer below where that is no larger: then a primitive has more than one box. Boxes first,
/// by layer from below; then holes.
std::vector<VolumePrimitive> divide(const RemovalVolume& removal, DivisionPlan plan);

}  // namespace camber::plan
