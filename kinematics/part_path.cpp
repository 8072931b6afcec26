#include "kinematics/part_path.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "kinematics/program_joints.h"

namespace camber::kinematics {
namespace {

/// A turn of this much between two places: at 100 mm from the axis the chord leaves the arc by 4 um.
constexpr double kTurnStep_rad = kPi / 180;

/// Maps X Y Z of the text to the tip on the part, where rotary axes stand and X Y Z count in a frame on the part: under
/// G254 it is parallel to the machine, as the work lies at these angles.
Eigen::Isometry3d part_from_text(const nc::Interpretation& text, const nc::Move& move, const Chain& chain,
                                 const Vec3& rotary_rad) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  const nc::ModalState& state = text.state_of(move);
  if (state.work_frame != nc::WorkFrame::dynamic || state.tip_control != nc::TipControl::off) return out;
  const Vec3 origin_mm = text.frame_of(move).origin_mm;
  out.linear() = chain.table_rotation(rotary_rad);
  out.translation() = origin_mm - out.linear() * origin_mm;
  return out;
}

}  // namespace

PartPath::PartPath(const machine::Machine& machine, const nc::Interpretation& text) : text_(text), map_(machine, text) {
  at_.resize(text.moves.size());
  auto target = text.machine_targets.begin();
  for (ProgramJoints program(machine, text); !program.done();) {
    const MoveJoints now = program.next();
    const nc::Move& move = text.moves[program.index()];
    const nc::ModalState& state = text.state_of(move);
    At& at = at_[program.index()];
    at.start = program.at(0);
    at.end = program.at(1);
    at.end_known = now.linear_known && state.tool_length_mm && text.machine_origin_mm;
    at.start_known = at.end_known && now.start_known;
    at.tool_length_mm = state.tool_length_mm.value_or(0);
    at.turn_rad = (now.end_rad - now.start_rad).lpNorm<1>();
    const bool to_machine_place = target != text.machine_targets.end() && target->move == program.index();
    if (to_machine_place) ++target;
    const bool in_frame = state.work_frame != nc::WorkFrame::machine && at.turn_rad == 0;  // lines are straight there
    at.follows_tip = !to_machine_place && move.open_axes != 7 && move.kind != nc::MoveKind::dwell &&
                     (state.tip_control != nc::TipControl::off || in_frame);
  }
  for (std::uint32_t i = 0; i < at_.size(); ++i) at_[i].length_mm = measured_length_mm(i);
  find_bent_arcs();
}

Joints PartPath::joints_at(std::uint32_t move, double u) const {
  const At& at = at_[move];
  if (u >= 1 || !at.start_known) return at.end;
  if (u <= 0) return at.start;
  Joints out;
  out.rotary_rad = at.start.rotary_rad + u * (at.end.rotary_rad - at.start.rotary_rad);
  out.linear_mm = text_.moves[move].arc == nc::Move::kNoArc
                      ? Vec3(at.start.linear_mm + u * (at.end.linear_mm - at.start.linear_mm))
                      : map_.linear_of_axes_mm(nc::point_at(text_, text_.moves[move], u), at.tool_length_mm);
  return out;
}

ToolPose PartPath::pose_at(std::uint32_t move, double u) const {
  const At& at = at_[move];
  if (!at.follows_tip || !at.end_known) {
    return map_.tool(joints_at(move, u), at.tool_length_mm);
  }
  if (!at.start_known) u = 1;
  const Vec3 angles =
      u >= 1 ? at.end.rotary_rad : Vec3(at.start.rotary_rad + u * (at.end.rotary_rad - at.start.rotary_rad));
  ToolPose pose = map_.chain().pose({Vec3::Zero(), angles}, at.tool_length_mm);
  const nc::Move& m = text_.moves[move];
  pose.tip_mm = part_from_text(text_, m, map_.chain(), at.end.rotary_rad) * nc::point_at(text_, m, u);
  return pose;
}

double PartPath::measured_length_mm(std::uint32_t move) const {
  const At& at = at_[move];
  if (!at.start_known || text_.moves[move].kind == nc::MoveKind::dwell) return 0;
  if (at.follows_tip) return nc::length_mm(text_, text_.moves[move]);
  const bool arc = text_.moves[move].arc != nc::Move::kNoArc;
  const int steps = std::max(arc ? 64 : 1, static_cast<int>(std::ceil(at.turn_rad / kTurnStep_rad)));
  double length = 0;
  Vec3 last = pose_at(move, 0).tip_mm;
  for (int i = 1; i <= steps; ++i) {
    const Vec3 tip = pose_at(move, static_cast<double>(i) / steps).tip_mm;
    length += (tip - last).norm();
    last = tip;
  }
  return length;
}

double PartPath::nearest_fraction(std::uint32_t move, const Joints& joints) const {
  const At& at = at_[move];
  const Vec3 turn = kLever_mm * (at.end.rotary_rad - at.start.rotary_rad);
  double along = kLever_mm * (joints.rotary_rad - at.start.rotary_rad).dot(turn), square = turn.squaredNorm();
  const nc::Move& m = text_.moves[move];
  if (m.arc == nc::Move::kNoArc) {
    // Straight in X Y Z of the text.
    const Vec3 from = at.follows_tip ? m.start_mm : at.start.linear_mm,
               to = at.follows_tip ? m.end_mm : at.end.linear_mm,
               is = at.follows_tip ? map_.tool(joints, at.tool_length_mm).tip_mm : joints.linear_mm;
    along += (is - from).dot(to - from);
    square += (to - from).squaredNorm();
  }
  return square > 0 ? along / square : 1.0;
}

double PartPath::angle_distance_mm(std::uint32_t move, double u, const Joints& joints) const {
  const At& at = at_[move];
  return kLever_mm * (at.start.rotary_rad + u * (at.end.rotary_rad - at.start.rotary_rad) - joints.rotary_rad).norm();
}

std::optional<Vec3> PartPath::text_mm(std::uint32_t move, const Vec3& tip_mm) const {
  const At& at = at_[move];
  if (!at.end_known) return std::nullopt;
  const nc::Move& m = text_.moves[move];
  if (at.follows_tip || text_.state_of(m).work_frame != nc::WorkFrame::machine)
    return part_from_text(text_, m, map_.chain(), at.end.rotary_rad).inverse() * tip_mm;
  const auto linear = map_.linear_of_tip_mm(tip_mm, at.end.rotary_rad, at.tool_length_mm);
  if (!linear) return std::nullopt;
  return map_.named_mm(*linear, at.tool_length_mm);
}

/// Returns the arc in the part's frame; nothing where it is no arc there.
std::optional<nc::Arc> PartPath::arc_in_part(std::uint32_t move) const {
  const At& at = at_[move];
  nc::Arc arc = text_.arcs[text_.moves[move].arc];
  if (at.follows_tip) {
    const Eigen::Isometry3d map = part_from_text(text_, text_.moves[move], map_.chain(), at.end.rotary_rad);
    arc.center_mm = map * arc.center_mm;
    arc.normal = map.linear() * arc.normal;
    return arc;
  }
  if (at.turn_rad > 0) return std::nullopt;
  Mat3 turn;  // part from axes
  const Joints zero{Vec3::Zero(), at.end.rotary_rad};
  const Vec3 tip = map_.chain().pose(zero, 0).tip_mm;
  for (int i = 0; i < 3; ++i) turn.col(i) = map_.chain().pose({Vec3::Unit(i), zero.rotary_rad}, 0).tip_mm - tip;
  constexpr double kSquare = 1e-9;
  if ((turn.transpose() * turn - Mat3::Identity()).norm() > kSquare || turn.determinant() < 0) return std::nullopt;
  arc.center_mm = pose_at(move, 0).tip_mm + turn * (arc.center_mm - text_.moves[move].start_mm);
  arc.normal = turn * arc.normal;
  return arc;
}

void PartPath::find_bent_arcs() {
  for (std::uint32_t i = 0; i < at_.size(); ++i)
    if (text_.moves[i].arc != nc::Move::kNoArc && at_[i].start_known && !arc_in_part(i)) bent_arcs_.push_back(i);
}

nc::Interpretation PartPath::moves_in_part() const {
  nc::Interpretation out = text_;
  for (std::uint32_t i = 0; i < at_.size(); ++i) {
    nc::Move& move = out.moves[i];
    if (!at_[i].end_known) {
      move.reference = move.reference || move.kind != nc::MoveKind::dwell;
      continue;
    }
    if (move.arc != nc::Move::kNoArc) {
      if (const auto arc = arc_in_part(i)) out.arcs[move.arc] = *arc;
      if (at_[i].turn_rad > 0) move.editable = false;  // it could not stay one arc
    }
    move.end_mm = pose_at(i, 1).tip_mm;
    move.start_mm = at_[i].start_known ? pose_at(i, 0).tip_mm : move.end_mm;
  }
  out.rotary.clear();
  out.machine_targets.clear();
  return out;
}

}  // namespace camber::kinematics
