#pragma once
// Levels: the heights at which roughing cuts, and the order of the loops at one of them.
#include <optional>
#include <vector>

#include "base/geometry.h"
#include "base/triangle_mesh.h"
#include "copymill/axis_region.h"
#include "copymill/path_piece.h"

namespace camber::copymill {

/// Level faces of the part that look up, over the region: heights, descending, with more than `least_mm2` each, those
/// within a micrometre together. A tip that goes to such a height touches the face and does not go into it.
std::vector<double> level_floors(const TriangleMesh& part, const AxisRegion& region, double least_mm2);

/// Returns the levels from the top down to the bottom, each floor (raised by the allowance) on the way included: levels
/// between two of these are evenly spaced, no more than the axial depth apart.
class Levels {
 public:
  Levels(double top_mm, double bottom_mm, std::vector<double> floors_mm);

  /// The next level below one, no deeper than the axial depth; nothing at the bottom.
  bool next(double above_mm, double axial_depth_mm, double& level_mm) const;
  double top_mm() const { return top_; }
  double bottom_mm() const { return bottom_; }

 private:
  double top_, bottom_;
  std::vector<double> stops_;  ///< floors and the bottom, descending
};

/// Levels of a region of several boxes: from its top to its bottom evenly, and the floors in between, which are cut
/// after the even level below them, so that nothing is left there but what stands on them.
struct BoxLevels {
  Levels even;
  std::vector<double> floors_mm;  ///< descending

  /// Returns the levels below one, down to another one.
  std::vector<double> floors_between(double above_mm, double level_mm) const;
};

/// `floors_mm` of the part, without allowance; bottoms of boxes are floors too, with the allowance and, where no part
/// is under them, without it.
BoxLevels box_levels(double top_mm, double bottom_mm, std::vector<double> floors_mm, const AxisRegion& region,
                     double allowance_mm);

/// Loops of a region at one distance after the other. A loop may be cut when all loops of the distance before that lie
/// beside it are; of those that may, the nearest to the tool comes next. So the tool stays at a boss or in a corner
/// until it has come to the wall there, and never has more than one distance beside it.
class LoopOrder {
 public:
  /// The loops of the next distance, `apart_mm` from those of the one before. `may_turn`: open ones may be followed
  /// from either end.
  void add(std::vector<Pass> loops, double apart_mm, bool may_turn);
  /// The next one, a closed one beginning as near to the tool as its points allow; nothing when all are taken. A tool
  /// that is nowhere yet gets the first.
  std::optional<Pass> next(const std::optional<Vec3>& tip);

 private:
  struct Loop {
    Pass pass;
    std::vector<std::size_t> after;  ///< loops that have to be cut before
    bool may_turn = false;
    bool taken = false;
  };
  bool may_be_next(const Loop& loop) const;

  std::vector<Loop> loops_;
  std::size_t first_of_last_ = 0;  ///< distance
};

}  // namespace camber::copymill
