#pragma once
// Levels: the heights at which roughing cuts, and the order of the loops at one of them.
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/geometry.h"
#include "base/triangle_mesh.h"
#include "copymill/axis_region.h"
#include "copymill/grid.h"
#include "copymill/outline.h"
#include "copymill/path_piece.h"
#include "copymill/tip_field.h"

namespace camber::copymill {

/// Returns the heights of the part's upward level faces over the region, descending; faces within a micrometre count
/// together and need more than `least_mm2`. A tip at such a height touches the face and does not go into it.
std::vector<double> level_floors(const TriangleMesh& part, const AxisRegion& region, double least_mm2);

/// Returns the levels from the top down to the bottom, each floor (raised by the allowance) on the way included: levels
/// between two of these are evenly spaced, no more than the axial depth apart.
class Levels {
 public:
  Levels(double top_mm, double bottom_mm, std::vector<double> floors_mm);

  /// Finds the next level below one, no deeper than the axial depth. Returns false at the bottom.
  bool next(double above_mm, double axial_depth_mm, double& level_mm) const;
  double top_mm() const { return top_; }
  double bottom_mm() const { return bottom_; }

 private:
  double top_, bottom_;
  std::vector<double> stops_;  ///< floors and the bottom, descending
};

/// Levels of a region of several boxes: evenly spaced from its top to its bottom, and the floors in between, each cut
/// after the even level below it, when only the material on the floor is left.
struct BoxLevels {
  Levels even;
  std::vector<double> floors_mm;  ///< descending

  /// Returns the levels below one, down to another one.
  std::vector<double> floors_between(double above_mm, double level_mm) const;
};

/// `floors_mm`: floors of the part, without allowance. Bottoms of boxes are floors too: with the allowance, or without
/// it where no part is under them.
BoxLevels box_levels(double top_mm, double bottom_mm, std::vector<double> floors_mm, const AxisRegion& region,
                     double allowance_mm);

/// Orders the loops of a region, which are given distance by distance. A loop may be cut when all loops of the distance
/// before beside it have been cut; of these loops the nearest to the tool comes next. So the tool stays at a boss or in
/// a corner until it has come to the wall there, and never has more than one distance beside it.
class LoopOrder {
 public:
  /// Adds the loops of the next distance, `apart_mm` from those before. `may_turn`: open loops may be followed from
  /// either end.
  void add(std::vector<Pass> loops, double apart_mm, bool may_turn);
  /// Returns the next loop, a closed one from its point nearest to the tool on; nothing when all are taken. Without a
  /// tip the first loop is returned.
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

// Level region: where the tip may be at one level, and loops in it at any distance from the part's walls.

/// The tip field at the points of a grid that covers a region and a margin.
struct SampledTips {
  SampledTips(const TipField& field, const AxisRegion& region, double step_mm);
  /// Returns whether a point lies in the region at a level.
  bool holds(std::size_t point, double z_mm) const;

  const TipField& field;
  const AxisRegion& region;
  Grid grid;
  std::vector<double> lowest_mm;
  std::vector<char> in_region;  ///< whether the point is in the region at some level
};

/// The points of the region at which the tip may stand at height z: the set {field <= z}, bounded by walls of the part
/// and by the region's own border. Its outline is exact to kOutline_mm: grid crossings by bisection of the field
/// itself, corners and chords refined.
class LevelRegion {
 public:
  static constexpr double kOutline_mm = 0.001;

  LevelRegion(const SampledTips& tips, double z_mm);

  bool empty() const { return outlines_.empty(); }
  double z_mm() const { return z_; }
  bool contains(const Vec2& p) const { return inside_(p); }
  /// Returns whether the straight way is inside, looked at every half step of the grid.
  bool holds_line(const Vec2& a, const Vec2& b) const;
  /// True where walls of the part bound the region somewhere; distances are from these. Else from the region's border.
  bool walled() const { return walled_; }
  int components() const { return components_; }
  /// Greatest distance in a component.
  double depth_mm(int component) const { return depth_[static_cast<std::size_t>(component)]; }
  /// The component that a point of the region, or one right beside it, belongs to.
  int component_of(const Vec2& p) const;
  /// Loops at a distance, the region on their left; where walls are the measure, only what follows a wall: pieces end
  /// where the region does. Distance 0: the exact outline.
  std::vector<FlatPass> loops(double distance_mm) const;
  /// The stretches of a line inside the region, ends exact, in the line's direction.
  std::vector<FlatPass> stretches(const Vec2& from, const Vec2& to) const;
  const std::vector<Outline>& outline() const { return outlines_; }

 private:
  enum class State : char { inside, wall, border };

  void find_outline();
  void label_components();
  void measure();
  double distance_mm(const Vec2& p) const;
  std::vector<FlatPass> follow(const Outline& loop, double distance_mm) const;

  const SampledTips& tips_;
  double z_;
  Inside inside_;
  std::vector<State> state_;
  std::vector<char> mask_;
  std::vector<Outline> outlines_;
  std::vector<float> distance_;  ///< signed where a wall is in between
  std::vector<std::int32_t> component_;
  std::vector<double> depth_;
  int components_ = 0;
  bool walled_ = false;
};

}  // namespace camber::copymill
