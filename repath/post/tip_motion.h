#pragma once
// One move of a program with rotary axes: where the tip and the joints truly are along it.
#include <optional>
#include <vector>

#include "base/diagnostics.h"
#include "base/tool_pose.h"
#include "kinematics/chain.h"
#include "kinematics/joints.h"
#include "machine/machine_model.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::repath {

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

/// A move with known place. Points are in the machine frame, carried along by the part where they are of the tip.
struct TipMotion {
  std::uint32_t move = 0;                                 ///< index into Interpretation::moves
  bool follows_tip = true;                                ///< tool-centre-point control; else the joints go straight
  Vec3 start_rad = Vec3::Zero(), end_rad = Vec3::Zero();  ///< as programmed, travel not looked at
  Vec3 start_tip_mm = Vec3::Zero(), end_tip_mm = Vec3::Zero();
  Vec3 start_linear_mm = Vec3::Zero(), end_linear_mm = Vec3::Zero();  ///< X Y Z of the joints
  double tool_length_mm = 0;
  double time_s = 0;  ///< that F asks for; 0: a rapid
  bool start_known = true;
  bool rapid = false;
  bool arc = false;

  Vec3 rotary_rad(double u) const { return start_rad + u * (end_rad - start_rad); }
  bool turns() const { return start_rad != end_rad; }
};

/// Joints and tips along motions.
class MotionFrame {
 public:
  /// Requires machine.kinematics.given() and moves.machine_origin_mm.
  MotionFrame(const machine::Machine& machine, const nc::Interpretation& moves);

  Vec3 tip_mm(const TipMotion& motion, double u) const;
  /// X Y Z that hold the tip there at these angles.
  Vec3 linear_mm(const TipMotion& motion, double u, const Vec3& rotary_rad) const;
  /// The way of the tip between two places.
  TipPiece tip_piece(const TipMotion& motion, double from, double to) const;
  /// Bound of the distance between the tip as it truly goes, and as it goes where the other of the two (joints, tip)
  /// is straight. `rotary_rad`: at the ends of the piece, as emitted.
  double deviation_bound_mm(const TipMotion& motion, double from, double to, const Vec3 (&rotary_rad)[2]) const;

  const kinematics::Chain& chain() const { return chain_; }
  const Vec3& origin_mm() const { return origin_mm_; }

 private:
  Vec3 joint_point_mm(const TipMotion& motion, double u) const;

  const nc::Interpretation& moves_;
  kinematics::Chain chain_;
  JointLine joint_line_;
  Vec3 origin_mm_;
};

/// The machine with axes that go on without end: the joints of a program as it means them.
machine::Machine without_travel(machine::Machine machine);

}  // namespace camber::repath
