#include "kinematics/program_joints.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

namespace camber::kinematics {
namespace {

const Vec3 kUnknown = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
/// Rounding of the way through a frame and back: places within it are the same.
constexpr double kSamePlaceMm = 1e-6;

/// m p, of which only those coordinates are unknown (NaN) that depend on unknown ones.
Vec3 known_product(const Eigen::Matrix3d& m, const Vec3& p) {
  Vec3 out = Vec3::Zero();
  for (Eigen::Index row = 0; row < 3; ++row)
    for (Eigen::Index column = 0; column < 3; ++column)
      if (m(row, column) != 0) out[row] += m(row, column) * p[column];
  return out;
}

}  // namespace

ProgramJoints::ProgramJoints(const machine::Machine& machine, const nc::Interpretation& moves, MissingOffset missing)
    : moves_(moves), map_(machine, moves), missing_(missing), last_linear_mm_(kUnknown) {}

std::optional<ProgramJoints::Offsets> ProgramJoints::offsets_of(const nc::Move& move) const {
  const std::optional<double>& length_mm = moves_.state_of(move).tool_length_mm;
  if (missing_ == MissingOffset::unknown && (!moves_.machine_origin_mm || !length_mm)) return std::nullopt;
  return Offsets{moves_.machine_origin_mm.value_or(Vec3::Zero()), length_mm.value_or(0)};
}

/// X, Y and Z of the program belong to one linear axis each.
bool ProgramJoints::names_axes(const nc::Move& move) const {
  const nc::ModalState& state = moves_.state_of(move);
  return state.tip_control == nc::TipControl::off && state.work_frame == nc::WorkFrame::machine;
}

/// The path of the tip is programmed; else that of the joints is, and lines are straight in the joints.
bool ProgramJoints::follows_tip(const nc::Move& move) const {
  return moves_.state_of(move).tip_control != nc::TipControl::off || move.arc != nc::Move::kNoArc;
}

/// Positions of the linear axes for the programmed point; nothing where offsets are not known or axes are parallel.
std::optional<Vec3> ProgramJoints::linear_of(const nc::Move& move, const Vec3& tip_mm, const Vec3& rotary_rad) const {
  const nc::ModalState& state = moves_.state_of(move);
  const auto offsets = offsets_of(move);
  if (!offsets) return std::nullopt;
  if (state.tip_control != nc::TipControl::off || state.work_frame == nc::WorkFrame::tilted)
    return map_.linear_of_tip_mm(tip_mm, rotary_rad, offsets->tool_length_mm);
  if (state.work_frame == nc::WorkFrame::machine) return map_.linear_of_axes_mm(tip_mm, offsets->tool_length_mm);
  const Vec3 tip_in_machine_mm = tip_mm - offsets->origin_mm;
  const Vec3 origin_mm = moves_.frame_of(move).origin_mm - offsets->origin_mm;
  const Vec3 in_part_mm = origin_mm + chain().table_rotation(rotary_rad) * (tip_in_machine_mm - origin_mm);
  return chain().linear_mm(in_part_mm, rotary_rad, offsets->tool_length_mm);
}

/// The reverse. Requires what linear_of() needs.
Vec3 ProgramJoints::tip_of(const nc::Move& move, const Joints& joints) const {
  const Offsets offsets = *offsets_of(move);
  if (names_axes(move)) return map_.named_mm(joints.linear_mm, offsets.tool_length_mm);
  const Vec3 tip_mm = map_.tool(joints, offsets.tool_length_mm).tip_mm;
  if (moves_.state_of(move).work_frame != nc::WorkFrame::dynamic) return tip_mm;
  const Vec3 origin_mm = moves_.frame_of(move).origin_mm;
  return origin_mm + chain().table_rotation(joints.rotary_rad).transpose() * (tip_mm - origin_mm);
}

/// The point with its open programmed coordinates as the joints of the last move have them; NaN: not known.
Vec3 ProgramJoints::closed(const nc::Move& move, const Vec3& given_mm, std::uint8_t open,
                           const Vec3& rotary_rad) const {
  if (open == 0) return given_mm;
  if (!offsets_of(move)) return kUnknown;
  const bool all_known = last_linear_mm_.allFinite();
  if (!all_known && !names_axes(move)) return kUnknown;
  const nc::Frame& frame = moves_.frame_of(move);
  const Vec3 tip_mm = tip_of(move, {last_linear_mm_, rotary_rad});
  const Vec3 here =
      all_known || frame.plain ? frame.to_program(tip_mm) : known_product(frame.inverse, tip_mm - frame.shift_mm);
  Vec3 programmed = frame.to_program(given_mm);
  for (int axis = 0; axis < 3; ++axis)
    if ((open & (1U << static_cast<unsigned>(axis))) != 0) programmed[axis] = here[axis];
  return all_known || frame.plain ? frame.from_program(programmed)
                                  : Vec3(known_product(frame.linear, programmed) + frame.shift_mm);
}

void ProgramJoints::take_target(const nc::RotaryTarget& target, const nc::Move& move) {
  now_.g93_time_s = target.time_s;
  if (!target.is_direction) {
    for (int i = 0; i < 3; ++i) {
      const auto bit = 1U << static_cast<unsigned>(i);
      if ((target.given & bit) == 0) continue;
      now_.end_rad[i] = (target.shortest & bit) != 0 ? nearest_turn(target.end[i], now_.start_rad[i]) : target.end[i];
    }
    return;
  }
  Joints near;
  near.rotary_rad = now_.start_rad;
  const auto offsets = move.open_axes == 0 ? offsets_of(move) : std::nullopt;
  const Solution solution =
      offsets ? chain().solve({move.end_mm - offsets->origin_mm, target.end}, offsets->tool_length_mm, near)
              : chain().solve_tool_axis(target.end, near);
  now_.reach = solution.reach;
  if (solution.reach == Reach::reached || solution.reach == Reach::travel) now_.end_rad = solution.joints.rotary_rad;
}

/// G53, G28, G30: the axes given go to machine coordinates, the others stay.
void ProgramJoints::take_machine_target(const nc::MachineTarget& target) {
  start_linear_mm_ = end_linear_mm_ = last_linear_mm_;
  for (int axis = 0; axis < 3; ++axis)
    if ((target.given & (1U << static_cast<unsigned>(axis))) != 0) end_linear_mm_[axis] = target.end_mm[axis];
}

/// Where the last move has left the axes. The program's own number stays where it says the same, and for axes of which
/// the last place is not known.
void ProgramJoints::settle_start(const nc::Move& move) {
  start_tip_mm_ = closed(move, move.start_mm, move.start_open ? 7 : 0, now_.start_rad);
  start_linear_mm_ = linear_of(move, start_tip_mm_, now_.start_rad).value_or(kUnknown);
  if (!offsets_of(move) || move.arc != nc::Move::kNoArc) return;
  if (!names_axes(move) && !last_linear_mm_.allFinite()) return;
  bool elsewhere = false;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(last_linear_mm_[axis])) continue;
    if (std::abs(start_linear_mm_[axis] - last_linear_mm_[axis]) <= kSamePlaceMm) continue;
    start_linear_mm_[axis] = last_linear_mm_[axis];
    elsewhere = true;
  }
  if (elsewhere) start_tip_mm_ = tip_of(move, {start_linear_mm_, now_.start_rad});
}

void ProgramJoints::take_line(const nc::Move& move) {
  if (move.open_axes == 7) {  // the linear axes stay
    start_linear_mm_ = end_linear_mm_ = last_linear_mm_;
    return;
  }
  end_tip_mm_ = closed(move, move.end_mm, move.open_axes, now_.end_rad);
  follows_path_ = follows_tip(move);
  in_frame_ = true;
  const auto end = linear_of(move, end_tip_mm_, now_.end_rad);
  end_linear_mm_ = end.value_or(kUnknown);
  if (!end && offsets_of(move)) now_.reach = Reach::linear;
  settle_start(move);
}

const MoveJoints& ProgramJoints::next() {
  assert(!done());
  const std::size_t index = next_++;
  const nc::Move& move = moves_.moves[index];
  const Vec3 last_rad = now_.end_rad;
  now_ = {};
  now_.start_rad = now_.end_rad = last_rad;
  follows_path_ = in_frame_ = false;
  start_linear_mm_ = end_linear_mm_ = last_linear_mm_;
  if (next_target_ < moves_.rotary.size() && moves_.rotary[next_target_].move == index)
    take_target(moves_.rotary[next_target_++], move);
  const auto& targets = moves_.machine_targets;
  if (next_machine_target_ < targets.size() && targets[next_machine_target_].move == index)
    take_machine_target(targets[next_machine_target_++]);
  else if (move.kind != nc::MoveKind::dwell)
    take_line(move);
  now_.linear_known = end_linear_mm_.allFinite();
  now_.start_known = start_linear_mm_.allFinite();
  last_linear_mm_ = end_linear_mm_;
  return now_;
}

/// The programmed point: on the arc, or between the ends of the line as the machine has them.
Vec3 ProgramJoints::tip_at(const nc::Move& move, double u) const {
  if (move.arc != nc::Move::kNoArc) return nc::point_at(moves_, move, u);
  return start_tip_mm_ + u * (end_tip_mm_ - start_tip_mm_);
}

Joints ProgramJoints::at(double u) const {
  const nc::Move& move = moves_.moves[index()];
  Joints out;
  out.rotary_rad = u >= 1 ? now_.end_rad : Vec3(now_.start_rad + u * (now_.end_rad - now_.start_rad));
  if (!now_.linear_known) return out;
  if (u >= 1)
    out.linear_mm = end_linear_mm_;
  else if (!follows_path_)
    out.linear_mm = start_linear_mm_ + u * (end_linear_mm_ - start_linear_mm_);
  else
    out.linear_mm = linear_of(move, tip_at(move, u), out.rotary_rad).value_or(Vec3::Zero());
  return out;
}

std::optional<ToolPose> ProgramJoints::pose_at(double u) const {
  const auto& length_mm = moves_.state_of(moves_.moves[index()]).tool_length_mm;
  if (!now_.linear_known || !length_mm) return std::nullopt;
  return chain().pose(at(u), *length_mm);
}

std::optional<Vec3> ProgramJoints::programmed_mm(const Vec3& linear_mm, const Vec3& rotary_rad) const {
  const nc::Move& move = moves_.moves[index()];
  if (!linear_mm.allFinite() || !offsets_of(move)) return std::nullopt;
  return tip_of(move, {linear_mm, rotary_rad});
}

double ProgramJoints::tilt_error_rad() const {
  const nc::Move& move = moves_.moves[index()];
  if (!in_frame_ || moves_.state_of(move).work_frame != nc::WorkFrame::tilted) return 0;
  const Vec3 normal = moves_.frame_of(move).linear.col(2).normalized();
  const Vec3 axis = chain().pose({Vec3::Zero(), now_.end_rad}, 0).axis;
  return std::atan2(normal.cross(axis).norm(), normal.dot(axis));
}

}  // namespace camber::kinematics
