#include "report/planned_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.h"
#include "feedmodel/motion_plan.h"
#include "feedmodel/path_builder.h"

namespace camber::report {
namespace {

using feedmodel::Segment;
using feedmodel::SegmentMotion;

constexpr double kPieceChords = 40;  ///< a change of speed over less than so many chords is not drawn in pieces
constexpr int kPieces = 6;           ///< of a change of speed
constexpr double kShortest = 1e-6;   ///< of a segment's time; a shorter phase is rounding of numbers

/// Times at which a motion changes its kind of motion, from 0 to its duration, ascending.
std::vector<double> phases(const SegmentMotion& m) {
  std::vector<double> out{0, m.duration_s};
  if (m.kind == SegmentMotion::Kind::along_path) {
    out.push_back(m.along.accelerate_s + m.accelerate_extra_s);
    out.push_back(m.duration_s - m.along.brake_s - m.brake_extra_s);
  } else if (m.kind == SegmentMotion::Kind::axes_apart) {
    for (const feedmodel::Trapezoid& axis : m.axes)
      if (axis.length > 0)
        for (const double t : {axis.accelerate_s, axis.accelerate_s + axis.cruise_s, axis.duration_s()})
          out.push_back(t / m.axes_s * m.duration_s);
  } else {
    for (int i = 1; i < kPieces; ++i) out.push_back(m.duration_s * i / kPieces);
  }
  for (double& t : out) t = std::clamp(t, 0.0, m.duration_s);
  std::sort(out.begin(), out.end());
  const auto same = [&](double a, double b) { return b - a < kShortest * m.duration_s; };
  out.erase(std::unique(out.begin(), out.end() - 1, same), out.end() - 1);
  if (out.size() > 2 && same(out[out.size() - 2], out.back())) out.erase(out.end() - 2);
  return out;
}

/// Length of the way from one point of a segment to the next.
double way_mm(const Segment& segment, const Vec3& from, const Vec3& to) {
  const double chord = (to - from).norm();
  if (segment.radius_mm == 0 || chord >= 2 * segment.radius_mm) return chord;
  return 2 * segment.radius_mm * std::asin(chord / (2 * segment.radius_mm));
}

class PlanDrawer {
 public:
  PlanDrawer(const nc::Interpretation& program, const machine::Machine& machine, double chord_mm)
      : program_(program), machine_(machine), chord_mm_(chord_mm) {
    out_.chord_mm = chord_mm;
  }

  PathPicture draw() {
    const feedmodel::MotionPlan plan = feedmodel::plan_motion(program_, machine_);
    std::size_t i = 0;
    feedmodel::build_segments(program_, machine_, [&](const Segment& segment) {
      if (segment.length_mm > 0) pass(segment, feedmodel::motion_of(plan, i, segment, machine_));
      ++i;
    });
    return std::move(out_);
  }

 private:
  void pass(const Segment& segment, const SegmentMotion& motion) {
    const nc::Move& move = program_.moves[segment.move];
    if (out_.points.empty() || (segment.start_mm - out_.points.back()).norm() > chord_mm_)
      add(segment.start_mm, PathKind::start, move, segment, 0);
    else if (out_.block.back() == move.block)
      out_.ends.back() = 0;  // the block goes on behind a rounded corner
    const PathKind kind = !segment.cutting ? PathKind::rapid : segment.radius_mm == 0 ? PathKind::line : PathKind::arc;
    const std::vector<double> at = phases(motion);
    for (std::size_t k = 1; motion.duration_s > 0 && k < at.size(); ++k)
      add_phase(segment, motion, kind, at[k - 1], at[k]);
    if (motion.duration_s <= 0) add(segment.point_at(segment.length_mm), kind, move, segment, 0);  // takes no time
    out_.ends.back() = 1;
  }

  void add_phase(const Segment& segment, const SegmentMotion& motion, PathKind kind, double from_s, double to_s) {
    const nc::Move& move = program_.moves[segment.move];
    const double length = (motion.point_at(segment, to_s) - motion.point_at(segment, from_s)).norm();
    int n = changes_speed(motion, from_s, to_s) && length > kPieceChords * chord_mm_ ? kPieces : 1;
    if (segment.radius_mm > 0) n = std::max(n, arc_pieces(segment, to_s - from_s, motion.duration_s));
    for (int i = 1; i <= n; ++i) {
      const double before = from_s + (to_s - from_s) * (i - 1) / n, after = from_s + (to_s - from_s) * i / n;
      const Vec3 from = motion.point_at(segment, before), to = motion.point_at(segment, after);
      add(to, kind, move, segment, way_mm(segment, from, to) / (after - before));
    }
  }

  /// Twice as many as at an even speed: an acceleration from rest covers the second half of its way faster.
  int arc_pieces(const Segment& segment, double phase_s, double duration_s) const {
    const int all = chords_of(segment.turn_rad_per_mm * segment.length_mm, segment.radius_mm, chord_mm_);
    return static_cast<int>(std::ceil(2 * all * phase_s / duration_s));
  }

  static bool changes_speed(const SegmentMotion& m, double from_s, double to_s) {
    if (m.kind != SegmentMotion::Kind::along_path) return true;
    const double middle_s = (from_s + to_s) / 2;
    return middle_s < m.along.accelerate_s + m.accelerate_extra_s ||
           middle_s > m.duration_s - m.along.brake_s - m.brake_extra_s;
  }

  void add(const Vec3& p, PathKind kind, const nc::Move& move, const Segment& segment, double speed_mm_per_s) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    const bool cuts = segment.cutting && kind != PathKind::start;
    out_.points.push_back(p);
    out_.kind.push_back(kind);
    out_.block.push_back(move.block);
    out_.ends.push_back(0);
    out_.tool.push_back(static_cast<std::uint32_t>(std::max(0, program_.state_of(move).tool)));
    out_.feed_mm_per_min.push_back(
        segment.cutting ? static_cast<float>(mm_per_min_from_mm_per_s(segment.feed_command_mm_per_s)) : kNone);
    out_.speed_mm_per_min.push_back(cuts ? static_cast<float>(mm_per_min_from_mm_per_s(speed_mm_per_s)) : kNone);
  }

  const nc::Interpretation& program_;
  const machine::Machine& machine_;
  const double chord_mm_;
  PathPicture out_;
};

PathPicture tip_path(const kinematics::MachineProgram& program) {
  constexpr double kTurn_rad = kPi / 90, kArc_rad = kPi / 24;
  const nc::Interpretation& moves = program.moves_in_program();
  const kinematics::PartPath& path = *program.part_path();
  PathPicture out;
  for (std::uint32_t i = 0; i < moves.moves.size(); ++i) {
    const nc::Move& move = moves.moves[i];
    if (move.kind == nc::MoveKind::dwell || !path.end_known(i)) continue;
    const bool begins = !path.start_known(i);
    double pieces = path.turn_rad(i) / kTurn_rad;
    if (move.arc != nc::Move::kNoArc) pieces = std::max(pieces, std::abs(moves.arcs[move.arc].sweep_rad) / kArc_rad);
    const int n = begins ? 1 : std::max(1, static_cast<int>(std::ceil(pieces)));
    for (int k = begins || out.points.empty() ? 0 : 1; k <= (begins ? 0 : n); ++k) {
      out.points.push_back(path.pose_at(i, static_cast<double>(k) / n).tip_mm);
      out.kind.push_back(k == 0                             ? PathKind::start
                         : move.kind == nc::MoveKind::rapid ? PathKind::rapid
                         : move.arc != nc::Move::kNoArc     ? PathKind::arc
                                                            : PathKind::line);
      out.block.push_back(move.block);
      out.ends.push_back(k == n ? 1 : 0);
      out.tool.push_back(static_cast<std::uint32_t>(std::max(0, moves.state_of(move).tool)));
      out.feed_mm_per_min.push_back(feed_of(move));
    }
  }
  return out;
}

}  // namespace

PathPicture tip_picture(const kinematics::MachineProgram& program, std::size_t most) {
  return thinned_picture(tip_path(program), picture_chord_mm(program.commanded()), most);
}

PathPicture planned_picture(const nc::Interpretation& program, const machine::Machine& machine, std::size_t most) {
  const double chord_mm = picture_chord_mm(program);
  return thinned_picture(PlanDrawer(program, machine, chord_mm).draw(), chord_mm, most);
}

}  // namespace camber::report
