#include "kinematics/machine_moves.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "kinematics/program_joints.h"
#include "kinematics/reference_check.h"

namespace camber::kinematics {
namespace {

constexpr double kSameMm = 1e-6;
/// Deviation of the axes of the part's frame from a right-handed square system, as the linear axes see them.
constexpr double kSquare = 1e-9;
/// Linear maps are found over this distance.
constexpr double kStepMm = 100;

/// Where the linear axes are at the ends of a move.
struct LinearEnds {
  Vec3 start_mm, end_mm;
  bool known = true;  ///< else a part of it is where the axes are known before or after
};

class Placer {
 public:
  Placer(nc::Interpretation& program, const machine::Machine& machine) : program_(program), machine_(machine) {}

  void run() {
    place_machine_targets();
    find_ends();
    fill_unknown_ends();
    // A move is changed after ProgramJoints has passed it; it does not look back.
    while (!joints_.done()) {
      now_ = joints_.next();
      find_targets();
      place(program_.moves[joints_.index()]);
    }
    program_.machine_targets.clear();  // the moves name these places now
  }

 private:
  // --- where the axes are

  /// Without offsets machine coordinates are not known. Reference points of the machine file are program coordinates.
  void place_machine_targets() {
    const bool offsets_known =
        program_.machine_origin_mm &&
        std::ranges::all_of(program_.states, [](const nc::ModalState& s) { return s.tool_length_mm.has_value(); });
    for (nc::MachineTarget& target : program_.machine_targets) {
      const nc::Move& move = program_.moves[target.move];
      const Vec3 zero_mm = linear_mm(move, Vec3::Zero());
      for (int axis = 0; axis < 3; ++axis) {
        double& end_mm = target.end_mm[axis];
        if (!offsets_known) end_mm = std::numeric_limits<double>::quiet_NaN();
        const bool refers = (move.reference_axes >> static_cast<unsigned>(axis) & 1U) != 0;
        const double at_mm = reference_point_mm(machine_, move.reference_point, axis);
        if (refers && std::isnan(end_mm) && std::isfinite(at_mm)) end_mm = zero_mm[axis] + at_mm;
      }
    }
  }

  void find_ends() {
    ends_.reserve(program_.moves.size());
    for (ProgramJoints joints(machine_, program_, MissingOffset::zero); !joints.done();) {
      const MoveJoints now = joints.next();
      LinearEnds ends{joints.start_linear_mm(), joints.end_linear_mm(), now.linear_known && now.start_known};
      for (int axis = 0; axis < 3 && !ends_.empty(); ++axis) fill(ends.start_mm[axis], ends_.back().end_mm[axis]);
      ends_.push_back(ends);
    }
  }

  void fill_unknown_ends() {
    for (int axis = 0; axis < 3 && !ends_.empty(); ++axis) {
      const nc::Move& first = program_.moves.front();
      const double reference = reference_point_mm(machine_, 0, axis), zero_mm = linear_mm(first, Vec3::Zero())[axis];
      if (std::isfinite(reference)) {
        for (LinearEnds& ends : ends_) {
          if (!fill(ends.start_mm[axis], zero_mm + reference)) break;
          if (!fill(ends.end_mm[axis], zero_mm + reference)) break;
        }
      }
      double next_mm = last_known_mm(axis).value_or(zero_mm);
      for (std::size_t i = ends_.size(); i-- > 0;) {
        if (!fill(ends_[i].end_mm[axis], next_mm)) next_mm = ends_[i].end_mm[axis];
        if (!fill(ends_[i].start_mm[axis], next_mm)) next_mm = ends_[i].start_mm[axis];
      }
    }
  }

  static bool fill(double& place_mm, double with_mm) {
    if (std::isfinite(place_mm)) return false;
    place_mm = with_mm;
    return true;
  }

  std::optional<double> last_known_mm(int axis) const {
    for (std::size_t i = ends_.size(); i-- > 0;) {
      if (std::isfinite(ends_[i].end_mm[axis])) return ends_[i].end_mm[axis];
      if (std::isfinite(ends_[i].start_mm[axis])) return ends_[i].start_mm[axis];
    }
    return std::nullopt;
  }

  // --- what the moves say

  void find_targets() {
    const std::size_t index = joints_.index();
    while (next_rotary_ < program_.rotary.size() && program_.rotary[next_rotary_].move < index) ++next_rotary_;
    const auto& targets = program_.machine_targets;
    while (next_target_ < targets.size() && targets[next_target_].move < index) ++next_target_;
    to_machine_ = next_target_ < targets.size() && targets[next_target_].move == index;
  }

  void place(nc::Move& move) {
    const LinearEnds& ends = ends_[joints_.index()];
    const bool in_frame = program_.state_of(move).work_frame != nc::WorkFrame::machine;
    if (!in_frame && !to_machine_) {
      place_ends(move, ends);
    } else {
      fix_angles();
      if (move.arc != nc::Move::kNoArc && ends.known)
        place_arc(move);
      else
        place_line(move, ends);
    }
    move.open_axes = 0;
    move.start_open = false;
    move.reference = !ends.known && move.kind != nc::MoveKind::dwell;
  }

  /// Places the ends of the move where the axes are. Ends that are there already keep the numbers of the text.
  void place_ends(nc::Move& move, const LinearEnds& ends) {
    const Vec3 start = joints_.programmed_mm({ends.start_mm, now_.start_rad}),
               end = joints_.programmed_mm({ends.end_mm, now_.end_rad});
    if (move.arc != nc::Move::kNoArc) {
      if (!ends.known) shift_arc(move, start);
    } else if ((start - move.start_mm).norm() > kSameMm || (end - move.end_mm).norm() > kSameMm) {
      move.start_mm = start, move.end_mm = end;
    }
  }

  /// Shifts the arc so that it starts at `start_mm`, where an axis is that the program has not placed.
  void shift_arc(nc::Move& move, const Vec3& start_mm) {
    const Vec3 by_mm = start_mm - move.start_mm;
    program_.arcs[move.arc].center_mm += by_mm;
    move.start_mm += by_mm;
    move.end_mm += by_mm;
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

  void place_line(nc::Move& move, const LinearEnds& ends) {
    if (move.arc != nc::Move::kNoArc) move.kind = nc::MoveKind::linear;
    move.arc = nc::Move::kNoArc;
    move.start_mm = named_mm(move, ends.start_mm);
    move.end_mm = named_mm(move, ends.end_mm);
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
  }

  /// Returns the coordinates by which a program without tool-centre-point control names these positions of the axes.
  Vec3 named_mm(const nc::Move& move, const Vec3& linear_mm) const {
    return map_.named_mm(linear_mm, program_.state_of(move).tool_length_mm.value_or(0));
  }

  /// The linear axes for what such a program names.
  Vec3 linear_mm(const nc::Move& move, const Vec3& named) const { return named - named_mm(move, Vec3::Zero()); }

  /// The state of the move with X Y Z of the linear axes, or of the tip in the part's frame.
  void to_state(nc::Move& move, nc::TipControl tip_control) {
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
  JointMap map_{machine_, program_};
  ProgramJoints joints_{machine_, program_, MissingOffset::zero};
  MoveJoints now_;
  std::vector<LinearEnds> ends_;  ///< of each move
  std::size_t next_rotary_ = 0, next_target_ = 0;
  bool to_machine_ = false;  ///< the move has a machine target
  std::map<std::pair<std::uint32_t, nc::TipControl>, std::uint32_t> states_;
};

}  // namespace

void place_moves(nc::Interpretation& program, const machine::Machine& machine) { Placer(program, machine).run(); }

}  // namespace camber::kinematics
