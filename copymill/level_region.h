#pragma once
// Level region: where the tip may be at one level, and loops in it at any distance from the part's walls.
#include <cstdint>
#include <memory>
#include <vector>

#include "copymill/axis_region.h"
#include "copymill/grid.h"
#include "copymill/outline.h"
#include "copymill/path_piece.h"
#include "copymill/tip_field.h"

namespace camber::copymill {

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
