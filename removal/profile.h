#pragma once
// The profile of a rotating cutter in its meridian plane: bottom, corner, wall, and the cylinder above.
#include <array>
#include <limits>
#include <vector>

#include "base/geometry.h"
#include "machine/cutter_parameters.h"

namespace camber::removal {

/// One point of the profile, s mm from the tip along it.
struct ProfilePoint {
  double radius_mm = 0;         ///< from the axis
  double height_mm = 0;         ///< above the tip
  double normal_angle_rad = 0;  ///< kappa: normal = (sin k cos phi, sin k sin phi, -cos k)
  double meridian_curvature_per_mm = 0;
  double parallel_curvature_per_mm = 0;  ///< normal curvature along the circle of latitude
};

/// Lines and at most one arc, convex, from the axis upwards; the last line is unbounded. Points are (r, z).
class Profile {
 public:
  struct Piece {
    bool arc = false;
    double from_s_mm = 0, length_mm = 0;
    Vec2 start = Vec2::Zero(), end = Vec2::Zero();  ///< the end of the last piece means "unbounded"
    double normal_from_rad = 0, normal_to_rad = 0;  ///< a line's are the same
    Vec2 along = Vec2::Zero();                      ///< a line's direction
    Vec2 normal = Vec2::Zero();                     ///< a line's outward normal
    Vec2 centre = Vec2::Zero();                     ///< an arc's
    double radius_mm = 0;                           ///< an arc's
  };

  Profile() = default;
  /// Requires profile_fault(parameters) to be empty.
  explicit Profile(const machine::CutterParameters& parameters);

  bool empty() const { return pieces_.empty(); }
  const std::vector<Piece>& pieces() const { return pieces_; }
  double largest_radius_mm() const { return pieces_.back().start.x(); }

  /// Nearest point of the profile to a point of the meridian plane, r >= 0.
  struct Nearest {
    double distance_mm = 0;      ///< signed, negative inside; exact
    Vec2 place = Vec2::Zero();   ///< on the profile
    Vec2 normal = Vec2::Zero();  ///< outward there; in an edge the direction to the point
  };
  Nearest nearest(const Vec2& point) const;
  double distance_mm(const Vec2& point) const { return nearest(point).distance_mm; }

  ProfilePoint at(double s_mm) const;
  /// Length along the profile up to a height above the tip; a flat bottom belongs to height 0.
  double length_to_height_mm(double height_mm) const;
  /// Height above the tip at which the profile reaches a radius; infinity beyond its largest.
  double height_at_radius_mm(double radius_mm) const;

 private:
  void add_line(const Vec2& from, const Vec2& to);
  std::vector<Piece> pieces_;
};

}  // namespace camber::removal
