#pragma once
// The moves of a program with rotary motion as the tool goes along them in the part's frame.
//
// Places are in the frame of the program's X Y Z, which is the machine's with every axis at 0, moved by the work
// offset; the table carries it along. Under tool-centre-point control the tip goes along the programmed line or arc and
// the tool turns at a constant rate of the rotary axes; else all joints go straight, so that the tip follows a curve
// where rotary axes turn.
#include <cstdint>
#include <optional>
#include <vector>

#include "base/tool_pose.h"
#include "kinematics/joint_map.h"
#include "kinematics/joints.h"
#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::kinematics {

class PartPath {
 public:
  /// `text`: in the coordinates of the program, with lines as the machine runs them
  /// (MachineProgram::moves_in_program); must outlive this.
  /// Requires machine.kinematics.given().
  PartPath(const machine::Machine& machine, const nc::Interpretation& text);

  /// Start and end: where the work offset, the tool length or the position before are not known, they are not.
  bool start_known(std::uint32_t move) const { return at_[move].start_known; }
  bool end_known(std::uint32_t move) const { return at_[move].end_known; }
  /// Between two known ends, at the fraction u of the move; where only the end is known, there.
  ToolPose pose_at(std::uint32_t move, double u) const;
  /// Length of the tip's way.
  double length_mm(std::uint32_t move) const { return at_[move].length_mm; }
  /// Sum of what the rotary axes turn by, rad.
  double turn_rad(std::uint32_t move) const { return at_[move].turn_rad; }
  /// For a move that turns: the unbounded fraction of the move at which X, Y, Z and the angles are nearest to those
  /// of the joints, an angle of 1 rad counted as kLever_mm.
  double nearest_fraction(std::uint32_t move, const Joints& joints) const;
  /// How far the rotary axes are from where they are at this fraction of the move, 1 rad counted as kLever_mm.
  double angle_distance_mm(std::uint32_t move, double u, const Joints& joints) const;
  static constexpr double kLever_mm = 20;

  /// X Y Z of the program's text (in the frame of nc::Move) that put the tip there at the end of the move. Nothing
  /// where it is not known, or where two linear axes are parallel.
  std::optional<Vec3> text_mm(std::uint32_t move, const Vec3& tip_mm) const;

  /// The moves with their starts and ends on the part, arcs as well, without rotary words: the straight line from
  /// start to end stands for a curve of the tip. Arcs in which rotary axes turn are not editable. Moves of unknown end
  /// are marked as `reference`, those of unknown start begin at their end.
  nc::Interpretation moves_in_part() const;
  /// Arcs that are none on the part: rotary axes turn in them without tool-centre-point control, or linear axes are not
  /// square to each other at their angles.
  const std::vector<std::uint32_t>& bent_arcs() const { return bent_arcs_; }

 private:
  struct At {
    Joints start, end;
    double tool_length_mm = 0, length_mm = 0, turn_rad = 0;
    bool start_known = false, end_known = false;
    bool follows_tip = false;  ///< X Y Z of the text are the tip in the part's frame, or in one that stands in it
  };

  Joints joints_at(std::uint32_t move, double u) const;
  double measured_length_mm(std::uint32_t move) const;
  std::optional<nc::Arc> arc_in_part(std::uint32_t move) const;
  void find_bent_arcs();

  const nc::Interpretation& text_;
  JointMap map_;
  std::vector<At> at_;
  std::vector<std::uint32_t> bent_arcs_;
};

}  // namespace camber::kinematics
