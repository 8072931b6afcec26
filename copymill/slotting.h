#pragma once
// Slotting: cuts trochoids where a pass would have the cutter's full width in the cut.
#include <optional>
#include <vector>

#include "base/geometry.h"
#include "copymill/approach.h"
#include "copymill/operation.h"
#include "copymill/path_piece.h"
#include "copymill/standing.h"

namespace camber::copymill {

// Trochoidal milling: circles that advance by a step, so that a slot is cut without a full cut.

/// Returns the angle of the cutter's circumference in the cut at a radial depth on a straight wall: acos(1 - a_e / R);
/// pi from 2 R on.
double engagement_angle_rad(double cutter_radius_mm, double radial_depth_mm);

/// A circle that the cutter's axis runs.
struct Circle {
  Vec2 centre = Vec2::Zero();
  double radius_mm = 0;
};

/// The greatest engagement angle of a cutter, radius R, whose axis runs around `next` after it has run around `before`
/// (radius r0) and all within it. With the axis at c, e the unit vector from the circle's centre to it, and q = c -
/// before.centre, the circumference is in material where |q + R u| > R + r0, u a unit vector:
///
///   cos(angle of u and q) > ((R + r0)^2 - |q|^2 - R^2) / (2 R |q|),
///
/// and on the side of e to which the cutter moves, since the circle itself has just cut the other side. The greatest
/// angle over the circle is found in steps of a degree and then by golden section. It is the same in either sense. The
/// radial depth, measured across the circle, is next.radius + |next.centre - before.centre| - r0 at most; since the
/// wall that it cuts is hollow, the angle is greater than that depth takes on a straight one.
double greatest_engagement_rad(double cutter_radius_mm, const Circle& before, const Circle& next);

/// Returns the angle by which the line to a larger circle goes outwards; it adds at most this to the engagement angle.
double outward_rad(const Circle& before, const Circle& next);

/// The greatest advance from circle to circle of one radius whose engagement stays within a limit (below half a turn).
double trochoid_step_mm(double cutter_radius_mm, double circle_radius_mm, double limit_rad);

/// Returns the path around one circle after the other, joined by tangent lines: on the right of the way from centre to
/// centre where the circles are counter-clockwise, else on the left. The path lies at one height and begins on the
/// first circle, at start_of().
std::vector<PathPiece> trochoid(const std::vector<Circle>& circles, double z_mm, bool counter_clockwise,
                                double increment_mm);
/// Returns where the line to the second circle leaves the first one.
Vec2 start_of(const std::vector<Circle>& circles, bool counter_clockwise);

/// Cuts circles around a pass before it, where the pass would cut the tool's full width. The circles advance so that
/// the engagement angle stays within that of the operation's radial depth; the pass then cuts the rest. With
/// CopyOperation::slotting `by_load` this is done only where a full cut would exceed the operation's target force even
/// at the lowest feed and depth, and never without a target.
class Slotting {
 public:
  /// Fraction of the tool's diameter: no smaller circles are run. A slot, less the allowance on either side, must be
  /// wider than the tool by twice as much, and a hundredth of it.
  static constexpr double kSmallest = 0.05;
  static constexpr double kLargest = 0.25;  ///< fraction of the diameter: no larger circles are run

  Slotting(const Workplace& place, Approach& approach) : place_(place), approach_(approach) {}

  /// Returns whether trochoids may be needed at the present radial depth.
  bool wanted() const;
  double smallest_mm() const { return 2 * kSmallest * place_.cut.shape.radius_mm; }
  double largest_mm() const { return 2 * kLargest * place_.cut.shape.radius_mm; }
  /// Returns whether a pass would have the full width in the cut somewhere.
  bool full_width(const Pass& pass) const;
  /// Cuts trochoids around the stretches of a level pass that would be full cuts. `own`: the pass itself is cut next,
  /// and the log tells why a stretch of it stays a full cut.
  Runner::Ended clear(const Pass& pass, bool own);

 private:
  struct Stretch {
    std::vector<Vec2> guide;  ///< close together
    double z_mm = 0;
  };
  /// Circles that follow each other in material; the first may lie in air.
  using Row = std::vector<Circle>;

  std::vector<Stretch> full_stretches(const Pass& pass) const;
  bool full_at(const Standing& standing, const Vec3& tip, const Vec2& direction) const;
  double limit_rad() const;
  double greatest_share(const Stretch& stretch) const;
  bool inside(const Vec2& p, double z_mm) const;
  double room_mm(const Vec2& centre, double z_mm) const;
  bool joined(const Circle& a, const Circle& b, double z_mm) const;
  bool meets(const Standing& standing, const Circle& circle, double z_mm) const;
  std::vector<Row> rows(const Stretch& stretch) const;
  Runner::Ended cut(const Row& row, double z_mm);

  const Workplace& place_;
  Approach& approach_;
};

}  // namespace camber::copymill
