#pragma once
// The joints of a machine along an interpreted program.
//
// Without tool-centre-point control X Y Z are positions of the linear axes, with the tool's length along its axis:
//     joints_xyz = p - machine origin + length * tool axis - gauge point.
// With it, p is the tip in the part's frame, and the linear axes follow from inverse kinematics (kinematics/chain.h).
// Rotary axes move at a constant rate from the start to the end of a move. Under G43.5 the end is the solution of the
// direction that is nearest to the start, within travel.
#include <cstddef>
#include <string>

#include "kinematics/chain.h"
#include "kinematics/joints.h"
#include "nc/move.h"

namespace camber::kinematics {

/// One move in joints.
struct MoveJoints {
  Vec3 start_rad = Vec3::Zero(), end_rad = Vec3::Zero();  ///< a, b, c
  double g93_time_s = 0;  ///< duration that G93 asks for; 0: not G93, or no rotary words
  /// x, y, z can be had (at()): work offset and tool length are known, and the move is not one to a reference point.
  bool linear_known = false;
  Reach reach = Reach::reached;  ///< of the end; direction: the axes stay where they were
  /// False for the first move after tool-centre-point control was switched with turned axes: its start is then where
  /// the joints of the last move ended, and at(u) holds for u = 1 alone.
  bool start_known = true;
  bool turns() const { return start_rad != end_rad; }
};

class ProgramJoints {
 public:
  /// `moves` must outlive this. Requires machine.kinematics.given().
  ProgramJoints(const machine::Machine& machine, const nc::Interpretation& moves);

  bool done() const { return next_ >= moves_.moves.size(); }
  /// Goes to the next move, in the order of the program. Requires !done().
  const MoveJoints& next();
  /// Index of the move of the last next().
  std::size_t index() const { return next_ - 1; }
  /// Joints at the fraction u of that move. x, y, z are 0 where they are not known, or where two linear axes are
  /// parallel.
  Joints at(double u) const;
  const Chain& chain() const { return chain_; }

 private:
  bool linear_known(const nc::Move& move) const;
  Vec3 tip_in_machine_mm(const nc::Move& move, double u) const;
  void take_target(const nc::RotaryTarget& target, const nc::Move& move);

  const nc::Interpretation& moves_;
  Chain chain_;
  Vec3 tool_axis_, gauge_mm_;
  std::size_t next_ = 0, next_target_ = 0;
  bool tip_control_ = false;  ///< of the last move
  MoveJoints now_;
};

}  // namespace camber::kinematics
