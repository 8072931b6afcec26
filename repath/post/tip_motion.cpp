#include "repath/post/tip_motion.h"

#include <cmath>

#include <Eigen/Geometry>

namespace camber::repath {
namespace {

/// The part of an arc between two places; `p`: the point in the middle.
TipPiece arc_piece(const nc::Interpretation& moves, const nc::Move& move, double from, double to, const Vec3& p) {
  const nc::Arc& arc = moves.arcs[move.arc];
  const auto radial = [&](const Vec3& point) -> Vec3 {
    const Vec3 r = point - arc.center_mm;
    return r - r.dot(arc.normal) * arc.normal;
  };
  const double share = to - from, sweep = arc.sweep_rad * share;
  const double start_radius = radial(move.start_mm).norm(), end_radius = radial(move.end_mm).norm();
  const double change = (end_radius - start_radius) * share;
  const double rise = (move.end_mm - move.start_mm).dot(arc.normal) * share;
  const Vec3 r = radial(p), out = r.norm() > 0 ? Vec3(r.normalized()) : Vec3(arc.normal.unitOrthogonal());
  const Vec3 along = arc.normal.cross(out);
  TipPiece piece;
  piece.middle_rate_mm = change * out + sweep * r.norm() * along + rise * arc.normal;
  piece.middle_acceleration_mm = -sweep * sweep * r.norm() * out + 2 * change * sweep * along;
  piece.radius_mm = std::max(start_radius, end_radius);
  piece.radius_change_mm = std::abs(change);
  piece.sweep_rad = std::abs(sweep);
  piece.speed_mm = std::hypot(piece.radius_mm * sweep, change, rise);
  return piece;
}

}  // namespace

machine::Machine without_travel(machine::Machine machine) {
  for (machine::Axis& axis : machine.axis) axis.travel_mm = machine::Axis{}.travel_mm;
  for (machine::RotaryAxis& axis : machine.rotary) axis.travel_rad = machine::RotaryAxis{}.travel_rad;
  return machine;
}

MotionFrame::MotionFrame(const machine::Machine& machine, const nc::Interpretation& moves)
    : moves_(moves), chain_(machine), joint_line_(machine), origin_mm_(*moves.machine_origin_mm) {}

Vec3 MotionFrame::joint_point_mm(const TipMotion& motion, double u) const {
  if (u >= 1) return motion.end_linear_mm;
  if (!motion.arc) return motion.start_linear_mm + u * (motion.end_linear_mm - motion.start_linear_mm);
  const nc::Move& move = moves_.moves[motion.move];
  return motion.end_linear_mm + nc::point_at(moves_, move, u) - move.end_mm;
}

Vec3 MotionFrame::tip_mm(const TipMotion& motion, double u) const {
  if (!motion.follows_tip)
    return chain_.pose({joint_point_mm(motion, u), motion.rotary_rad(u)}, motion.tool_length_mm).tip_mm;
  if (u >= 1) return motion.end_tip_mm;
  if (motion.arc) return nc::point_at(moves_, moves_.moves[motion.move], u) - origin_mm_;
  return motion.start_tip_mm + u * (motion.end_tip_mm - motion.start_tip_mm);
}

Vec3 MotionFrame::linear_mm(const TipMotion& motion, double u, const Vec3& rotary_rad) const {
  return chain_.linear_mm(tip_mm(motion, u), rotary_rad, motion.tool_length_mm).value_or(Vec3::Zero());
}

TipPiece MotionFrame::tip_piece(const TipMotion& motion, double from, double to) const {
  const Vec3 start = tip_mm(motion, from), end = tip_mm(motion, to);
  if (!motion.follows_tip || !motion.arc) return TipPiece::line(start, end);
  const Vec3 middle = tip_mm(motion, (from + to) / 2);
  TipPiece piece = arc_piece(moves_, moves_.moves[motion.move], from, to, middle + origin_mm_);
  piece.tip_mm[0] = start;
  piece.tip_mm[1] = end;
  piece.middle_mm = middle;
  return piece;
}

double MotionFrame::deviation_bound_mm(const TipMotion& motion, double from, double to,
                                       const Vec3 (&rotary_rad)[2]) const {
  const TipPiece piece = tip_piece(motion, from, to);
  const Vec3 linear_mm_ends[2] = {linear_mm(motion, from, rotary_rad[0]), linear_mm(motion, to, rotary_rad[1])};
  double bound = joint_line_.deviation_bound_mm(piece, rotary_rad, motion.tool_length_mm, linear_mm_ends);
  if (!motion.follows_tip && motion.arc) {  // and the joints' arc against its chord
    const nc::Move& move = moves_.moves[motion.move];
    bound += arc_piece(moves_, move, from, to, nc::point_at(moves_, move, (from + to) / 2)).acceleration_mm() / 8;
  }
  return bound;
}

}  // namespace camber::repath
