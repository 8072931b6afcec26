#pragma once
// The joints of a machine along an interpreted program.
//
// Where X Y Z of the program put the tip p depends on the frame of the move:
//     machine   joints_xyz = p - machine origin + length * tool axis - gauge point;
//     part      tool-centre-point control, tilted frame (G68.2): p is the tip in the part's frame, and the linear axes
//               follow from inverse kinematics (kinematics/chain.h);
//     dynamic   G254: the tip in the part's frame is O + T (p - O), with O the origin of the work offset and T the
//               rotation of the table at the angles of the move.
// Under tool-centre-point control the tip follows its path. In every other mode the joints do: rotary axes move at a
// constant rate from the start to the end of a move, and so do the linear axes of a line. The machine goes on from
// where it is: a line starts where the last move has left the axes, whatever tool length or frame was switched since,
// and where the program leaves coordinates open after rotary axes have turned (Move::open_axes), they are those of the
// joints. Under G43.5 and G53.1 the end is the solution of the direction that is nearest to the start, within travel.
#include <cstddef>
#include <cstdint>
#include <optional>

#include "kinematics/joint_map.h"
#include "kinematics/joints.h"
#include "nc/move.h"

namespace camber::kinematics {

/// One move in joints.
struct MoveJoints {
  Vec3 start_rad = Vec3::Zero(), end_rad = Vec3::Zero();  ///< a, b, c
  double g93_time_s = 0;  ///< duration that G93 asks for; 0: not G93, or no rotary words
  /// x, y, z can be had (at()): work offset, tool length and reference points are known as far as they matter.
  bool linear_known = false;
  Reach reach = Reach::reached;  ///< reach of the end; direction: the axes stay where they were
  /// False where the start is not known, as at the first move of a program: at(u) holds for u = 1 alone.
  bool start_known = true;
  bool turns() const { return start_rad != end_rad; }
};

/// Value of a work offset or a tool length that is not known.
enum class MissingOffset : std::uint8_t { unknown, zero };

class ProgramJoints {
 public:
  /// `moves` must outlive this. Requires machine.kinematics.given().
  ProgramJoints(const machine::Machine& machine, const nc::Interpretation& moves,
                MissingOffset missing = MissingOffset::unknown);

  bool done() const { return next_ >= moves_.moves.size(); }
  /// Goes to the next move, in the order of the program. Requires !done().
  const MoveJoints& next();
  /// Index of the move of the last next().
  std::size_t index() const { return next_ - 1; }
  /// Joints at the fraction u of that move. x, y, z are 0 where they are not known, or where two linear axes are
  /// parallel.
  Joints at(double u) const;
  /// The tool there, in the part's frame with the origin of the machine frame; nothing where x, y, z or the tool length
  /// are not known.
  std::optional<ToolPose> pose_at(double u) const;
  /// Start and end of that move in the coordinates of nc::Move, as the machine has them: after tool-centre-point
  /// control was switched with turned axes, they are not those that the program named last. Nothing where they are not
  /// known.
  std::optional<Vec3> start_mm() const { return programmed_mm(start_linear_mm_, now_.start_rad); }
  std::optional<Vec3> end_mm() const { return programmed_mm(end_linear_mm_, now_.end_rad); }
  /// X, Y, Z of the machine where that move begins and ends; NaN: not known.
  const Vec3& start_linear_mm() const { return start_linear_mm_; }
  const Vec3& end_linear_mm() const { return end_linear_mm_; }
  /// The joints in the coordinates of that move. Requires offsets that are known, or taken as zero.
  Vec3 programmed_mm(const Joints& joints) const { return tip_of(moves_.moves[index()], joints); }
  /// X, Y, Z of the machine for a point in the coordinates of that move, at the angles of its end; nothing where
  /// offsets are not known or axes are parallel.
  std::optional<Vec3> linear_mm(const Vec3& point_mm) const {
    return linear_of(moves_.moves[index()], point_mm, now_.end_rad);
  }
  /// At a move of X, Y or Z in a tilted frame: angle between the tool and Z of the frame at its end, rad; else 0.
  double tilt_error_rad() const;
  const Chain& chain() const { return map_.chain(); }

 private:
  /// Work offset and tool length of a move.
  struct Offsets {
    Vec3 origin_mm = Vec3::Zero();
    double tool_length_mm = 0;
  };
  std::optional<Offsets> offsets_of(const nc::Move& move) const;
  bool names_axes(const nc::Move& move) const;
  bool follows_tip(const nc::Move& move) const;
  std::optional<Vec3> linear_of(const nc::Move& move, const Vec3& tip_mm, const Vec3& rotary_rad) const;
  Vec3 tip_of(const nc::Move& move, const Joints& joints) const;
  std::optional<Vec3> programmed_mm(const Vec3& linear_mm, const Vec3& rotary_rad) const;
  Vec3 closed(const nc::Move& move, const Vec3& given_mm, std::uint8_t open, const Vec3& rotary_rad) const;
  void take_target(const nc::RotaryTarget& target, const nc::Move& move);
  void take_machine_target(const nc::MachineTarget& target);
  void take_line(const nc::Move& move);
  Vec3 tip_at(const nc::Move& move, double u) const;
  void settle_start(const nc::Move& move);

  const nc::Interpretation& moves_;
  JointMap map_;
  MissingOffset missing_;
  std::size_t next_ = 0, next_target_ = 0, next_machine_target_ = 0;
  MoveJoints now_;
  bool follows_path_ = false;                                     ///< the tip follows its path; else joints go straight
  bool in_frame_ = false;                                         ///< the end of the move is a programmed point
  Vec3 start_tip_mm_ = Vec3::Zero(), end_tip_mm_ = Vec3::Zero();  ///< ends of the move, in its frame
  Vec3 start_linear_mm_ = Vec3::Zero(), end_linear_mm_ = Vec3::Zero();  ///< NaN: not known
  Vec3 last_linear_mm_;                                                 ///< where the last move left the axes
};

}  // namespace camber::kinematics
