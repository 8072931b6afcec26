#pragma once
// Gives the path builder the rotary motion of a program, move by move.
#include <cstddef>
#include <memory>

#include "feedmodel/segment.h"
#include "kinematics/joint_map.h"
#include "kinematics/program_joints.h"

namespace camber::feedmodel {

class MoveTurns {
 public:
  /// Requires has_rotary_motion.
  MoveTurns(const nc::Interpretation& program, const machine::Machine& machine);

  /// Advances to a move; moves are asked for in the order of the program.
  const kinematics::MoveJoints& at(std::size_t move);
  /// Result of the last at().
  const kinematics::MoveJoints& now() const { return now_; }
  /// The first move from `move` to `end` that turns an axis; `end` if none does.
  std::size_t next_turning(std::size_t move, std::size_t end) const;
  /// Along a path of this length (mm, or degrees) from the start to the end of the move of the last at().
  std::shared_ptr<const Turn> turn_along(double length) const;
  /// The axes rest where the move of the last at() begins, or ends.
  std::shared_ptr<const Turn> rest(bool at_end) const;
  const kinematics::JointMap& map() const { return map_; }

 private:
  Turn base() const;

  const nc::Interpretation& program_;
  const machine::Machine& machine_;
  kinematics::ProgramJoints joints_;
  kinematics::JointMap map_;
  kinematics::MoveJoints now_;
};

}  // namespace camber::feedmodel
