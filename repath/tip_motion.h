#pragma once
// One move of a program with rotary axes: where the tip and the joints truly are along it.
#include <optional>
#include <vector>

#include "base/diagnostics.h"
#include "base/tool_pose.h"
#include "kinematics/chain.h"
#include "kinematics/joints.h"
#include "machine/machine.h"
#include "nc/move.h"
#include "nc/program.h"
#include "repath/joint_line.h"

namespace camber::repath {

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
