#include "repath/post/tip_motion.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "kinematics/rotary_solver.h"

namespace camber::repath {

/// A point that moves: place and derivatives in the middle of the piece, bounds of the derivatives over all of it.
struct JointLine::Jet {
  Vec3 p = Vec3::Zero(), d1 = Vec3::Zero(), d2 = Vec3::Zero();
  double v = 0, a = 0, j = 0;
};

TipPiece TipPiece::line(const Vec3& from_mm, const Vec3& to_mm) {
  TipPiece out;
  out.tip_mm[0] = from_mm;
  out.tip_mm[1] = to_mm;
  out.middle_mm = (from_mm + to_mm) / 2;
  out.middle_rate_mm = to_mm - from_mm;
  out.middle_acceleration_mm = Vec3::Zero();
  out.speed_mm = out.middle_rate_mm.norm();
  return out;
}

JointLine::JointLine(const machine::Machine& machine) {
  const machine::Kinematics& k = machine.kinematics;
  gauge_mm_ = k.gauge_point_mm;
  tool_axis_ = k.tool_axis.normalized();
  for (const char letter : k.chain) {
    Link link;
    link.rotary = letter < 'x';
    link.index = letter - (link.rotary ? 'a' : 'x');
    if (link.rotary) {
      const machine::RotaryAxis& axis = machine.rotary[static_cast<std::size_t>(link.index)];
      link.direction = (axis.positive == machine::PositiveTurn::tool ? 1 : -1) * axis.direction.normalized();
      link.point_mm = axis.point_mm;
    }
    links_.push_back(link);
  }
  const auto linear = [](const Link& l) { return !l.rotary; };
  const auto first = std::find_if(links_.begin(), links_.end(), linear);
  const auto behind = std::find_if(links_.rbegin(), links_.rend(), linear).base();
  contiguous_ = std::all_of(first, behind, linear);
  first_linear_ = static_cast<std::size_t>(first - links_.begin());
  behind_linear_ = static_cast<std::size_t>(behind - links_.begin());
}

/// The jet carried along by a rotation that goes on evenly.
JointLine::Jet JointLine::turned_jet(const Jet& jet, const Link& link, double middle_rad, double rate_rad) const {
  const auto turn = [&](const Vec3& v) { return kinematics::turned(v, link.direction, middle_rad); };
  const Vec3 w = rate_rad * link.direction, r = turn(jet.p - link.point_mm);
  const Vec3 d1 = turn(jet.d1), d2 = turn(jet.d2);
  Jet out;
  out.p = link.point_mm + r;
  out.d1 = w.cross(r) + d1;
  out.d2 = w.cross(w.cross(r)) + 2 * w.cross(d1) + d2;
  const double rate = std::abs(rate_rad);
  const double distance = link.direction.cross(r).norm() + jet.v / 2;
  out.v = rate * distance + jet.v;
  out.a = rate * rate * distance + 2 * rate * jet.v + jet.a;
  out.j = rate * (rate * (rate * distance + 3 * jet.v) + 3 * jet.a) + jet.j;
  return out;
}

double JointLine::deviation_bound_mm(const TipPiece& tip, const Vec3 (&rotary_rad)[2], double tool_length_mm,
                                     const Vec3 (&linear_mm)[2]) const {
  const auto turn = [&](const Jet& jet, const Link& link, double sense) {
    const double from = rotary_rad[0][link.index], to = rotary_rad[1][link.index];
    return turned_jet(jet, link, sense * (from + to) / 2, sense * (to - from));
  };
  Jet spindle{.p = gauge_mm_ - tool_length_mm * tool_axis_};
  if (contiguous_) {
    Jet part{tip.middle_mm, tip.middle_rate_mm,    tip.middle_acceleration_mm,
             tip.speed_mm,  tip.acceleration_mm(), tip.jerk_mm()};
    for (std::size_t i = 0; i < first_linear_; ++i) part = turn(part, links_[i], -1);
    for (std::size_t i = links_.size(); i-- > behind_linear_;) spindle = turn(spindle, links_[i], 1);
    const double exact = (part.d2 - spindle.d2).norm() + (part.j + spindle.j) / 2;
    return std::min(exact, part.a + spindle.a) / 8;
  }
  const Vec3 middle_mm = (linear_mm[0] + linear_mm[1]) / 2, way_mm = linear_mm[1] - linear_mm[0];
  for (std::size_t i = links_.size(); i-- > 0;) {
    const Link& link = links_[i];
    if (link.rotary) {
      spindle = turn(spindle, link, 1);
    } else {
      spindle.p[link.index] += middle_mm[link.index];
      spindle.v += std::abs(way_mm[link.index]);
    }
  }
  return (spindle.a + tip.acceleration_mm()) / 8;
}

}  // namespace camber::repath
