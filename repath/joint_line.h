#pragma once
// How far the tip leaves its path where the axes of a machine go straight, or the joints theirs where the tip does.
//
// Rotary axes turn evenly in both cases, so that the tool's direction is the same. With the rotations P between the
// part and the linear axes, S between them and the spindle, and the tip t0 at the spindle with all axes at 0
//     X(v) = P(v)^-1 tip(v) - S(v) t0
// are the positions of the linear axes that hold the tip on its path, v = 0 to 1. Between the ends, the line of the
// joints is off X by at most max|X''| / 8, in the joints and, as P is a rotation, in the part. X'' is bounded by its
// exact value in the middle and a bound of the third derivative, which follows link by link from
//     p' = w x r + R q',  p'' = w x (w x r) + 2 w x R q' + R q''  ...
// so nothing is sampled. Chains with a rotary axis between two linear ones: the bound of the tip's second derivative
// while the joints go straight.
#include <vector>

#include "kinematics/joints.h"
#include "machine/machine.h"

namespace camber::repath {

/// A piece of motion, v = 0 to 1, in the machine frame carried along by the part.
struct TipPiece {
  Vec3 tip_mm[2];               ///< ends
  Vec3 middle_mm;               ///< at v = 1/2
  Vec3 middle_rate_mm;          ///< d tip / dv there
  Vec3 middle_acceleration_mm;  ///< second derivative there; zero for lines
  double speed_mm = 0;          ///< |d tip / dv|, constant
  double radius_mm = 0;         ///< arcs: the greatest; 0: a line
  double radius_change_mm = 0;  ///< arcs: what rounded ends leave, magnitude over the piece
  double sweep_rad = 0;         ///< arcs: magnitude over the piece

  static TipPiece line(const Vec3& from_mm, const Vec3& to_mm);
  /// Bounds of the second and of the third derivative.
  double acceleration_mm() const { return sweep_rad * (radius_mm * sweep_rad + 2 * radius_change_mm); }
  double jerk_mm() const { return sweep_rad * sweep_rad * (radius_mm * sweep_rad + 3 * radius_change_mm); }
};

class JointLine {
 public:
  /// Requires machine.kinematics.given().
  explicit JointLine(const machine::Machine& machine);

  /// Bound of the distance between the tip on its piece and the tip with the joints on the line between the same ends;
  /// of both, and of every point between. The rotary axes turn evenly from rotary_rad[0] to [1].
  double deviation_bound_mm(const TipPiece& tip, const Vec3 (&rotary_rad)[2], double tool_length_mm,
                            const Vec3 (&linear_mm)[2]) const;

 private:
  struct Link {
    Vec3 direction, point_mm;
    bool rotary = false;
    Eigen::Index index = 0;
  };
  struct Jet;
  Jet turned_jet(const Jet& jet, const Link& link, double middle_rad, double rate_rad) const;

  std::vector<Link> links_;  ///< from the part to the spindle
  std::size_t first_linear_ = 0, behind_linear_ = 0;
  bool contiguous_ = true;  ///< no rotary axis between two linear ones
  Vec3 gauge_mm_, tool_axis_;
};

}  // namespace camber::repath
