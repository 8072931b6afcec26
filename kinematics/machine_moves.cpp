#include "kinematics/machine_moves.h"

#include <algorithm>
#include <map>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "kinematics/program_joints.h"

namespace camber::kinematics {
namespace {

constexpr double kSameMm = 1e-6;
/// Deviation of the axes of the part's frame from a right-handed square system, as the linear axes see them.
constexpr double kSquare = 1e-9;
/// Linear maps are found over this distance.
constexpr double kStepMm = 100;

/// A move is changed after ProgramJoints has passed it; it does not look back.
class Placer {
 public:
  Placer(nc::Interpretation& program, const machine::Machine& machine)
      : program_(program), machine_(machine), joints_(machine, program) {}

  void run() {
    while (!joints_.done()) {
      now_ = joints_.next();
      find_targets();
      place(program_.moves[joints_.index()]);
    }
  }

 private:
  void find_targets() {
    const std::size_t index = joints_.index();
    while (next_rotary_ < program_.rotary.size() && program_.rotary[next_rotary_].move < index) ++next_rotary_;
    const auto& targets = program_.machine_targets;
    while (next_target_ < targets.size() && targets[next_target_].move < index) ++next_target_;
    to_machine_ = next_target_ < targets.size() && targets[next_target_].move == index;
  }

  bool known() const { return now_.linear_known && now_.start_known; }

  void place(nc::Move& move) {
    const bool in_frame = program_.state_of(move).work_frame != nc::WorkFrame::machine;
    if (!in_frame && !(to_machine_ && known())) return place_ends(move);
    fix_angles();
    if (!now_.linear_known)
      leave_unknown(move);
    else if (move.arc != nc::Move::kNoArc && now_.start_known)
      place_arc(move);
    else
      place_line(move);
  }

  /// What the move names stays what it is.
  void place_ends(nc::Move& move) {
    const auto start_mm = joints_.start_mm(), end_mm = joints_.end_mm();
    if (move.reference) {
      if (!known() || !start_mm) return;
      move.start_mm = *start_mm, move.end_mm = *end_mm;
      move.reference = false;
      return;
    }
    if (move.arc != nc::Move::kNoArc) return;
    const Vec3 start = start_mm.value_or(move.start_mm), end = end_mm.value_or(move.end_mm);
    if ((start - move.start_mm).norm() > kSameMm || (end - move.end_mm).norm() > kSameMm)
      move.start_mm = start, move.end_mm = end;
  }

  /// G53.1: the angles instead of the direction.
  void fix_angles() {
    if (next_rotary_ == program_.rotary.size()) return;
    nc::RotaryTarget& target = program_.rotary[next_rotary_];
    if (target.move != joints_.index() || !target.is_direction) return;
    target.is_direction = false;
    target.end = now_.end_rad;
    target.given = 7;
    target.shortest = 0;
  }

  /// A way to an unknown reference point stays one; any other move has no way.
  void leave_unknown(nc::Move& move) {
    if (joints_.start_linear_mm().allFinite())
      move.start_mm = move.end_mm = named_mm(move, joints_.start_linear_mm());
    else
      move.start_mm = move.end_mm;
    for (int axis = 0; axis < 3; ++axis)
      if ((move.reference_axes >> static_cast<unsigned>(axis) & 1U) != 0) move.end_mm[axis] = 0;
    move.reference = move.kind != nc::MoveKind::dwell;
    to_state(move, nc::TipControl::off);
  }

  void place_line(nc::Move& move) {
    move.end_mm = named_mm(move, joints_.at(1).linear_mm);
    move.start_mm = now_.start_known ? named_mm(move, joints_.at(0).linear_mm) : move.end_mm;
    move.reference = !now_.start_known && move.kind != nc::MoveKind::dwell;
    to_state(move, nc::TipControl::off);
  }

  void place_arc(nc::Move& move) {
    const Vec3 at_mm = joints_.at(0).linear_mm;
    Eigen::Isometry3d map = Eigen::Isometry3d::Identity();
    bool square = true;
    Eigen::Matrix3d linear;
    for (int axis = 0; axis < 3; ++axis) {
      const auto there = joints_.linear_mm(move.start_mm + kStepMm * Vec3::Unit(axis));
      square = square && there;
      if (there) linear.col(axis) = (*there - at_mm) / kStepMm;
    }
    square = square && (linear.transpose() * linear - Eigen::Matrix3d::Identity()).norm() < kSquare &&
             linear.determinant() > 0;
    if (square) {
      map.linear() = linear;
      map.translation() = named_mm(move, at_mm) - linear * move.start_mm;
    } else if (program_.state_of(move).work_frame == nc::WorkFrame::dynamic) {
      const Vec3 origin_mm = program_.frame_of(move).origin_mm;
      map.linear() = joints_.chain().table_rotation(now_.end_rad);
      map.translation() = origin_mm - map.linear() * origin_mm;
    }
    turn_arc(move, map);
    to_state(move, square ? nc::TipControl::off : nc::TipControl::angles);
  }

  void turn_arc(nc::Move& move, const Eigen::Isometry3d& map) {
    nc::Arc arc = program_.arcs[move.arc];
    arc.center_mm = map * arc.center_mm;
    arc.normal = map.linear() * arc.normal;
    program_.arcs[move.arc] = arc;
    move.start_mm = map * move.start_mm;
    move.end_mm = map * move.end_mm;
    move.reference = false;
  }

  /// What a program without tool-centre-point control names for these positions of the axes.
  Vec3 named_mm(const nc::Move& move, const Vec3& linear_mm) const {
    const machine::Kinematics& k = machine_.kinematics;
    return linear_mm - program_.state_of(move).tool_length_mm.value_or(0) * k.tool_axis.normalized() +
           k.gauge_point_mm + program_.machine_origin_mm.value_or(Vec3::Zero());
  }

  /// The state of the move with X Y Z of the linear axes, or of the tip in the part's frame.
  void to_state(nc::Move& move, nc::TipControl tip_control) {
    move.open_axes = 0;
    move.start_open = false;
    const auto key = std::pair(move.state, tip_control);
    auto known = states_.find(key);
    if (known == states_.end()) {
      nc::ModalState state = program_.state_of(move);
      state.work_frame = nc::WorkFrame::machine;
      state.tip_control = tip_control;
      known = states_.emplace(key, static_cast<std::uint32_t>(program_.states.size())).first;
      program_.states.push_back(state);
    }
    move.state = known->second;
  }

  nc::Interpretation& program_;
  const machine::Machine& machine_;
  ProgramJoints joints_;
  MoveJoints now_;
  std::size_t next_rotary_ = 0, next_target_ = 0;
  bool to_machine_ = false;  ///< the move has a machine target
  std::map<std::pair<std::uint32_t, nc::TipControl>, std::uint32_t> states_;
};

}  // namespace

void place_moves(nc::Interpretation& program, const machine::Machine& machine) { Placer(program, machine).run(); }

}  // namespace camber::kinematics
