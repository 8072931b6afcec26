#include "repath/post/post_divide.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "nc/emit/number_style.h"

namespace camber::repath {
namespace {

constexpr double kMaxStepRad = rad_from_deg(170);  ///< of a block: the shortest way is the way meant
constexpr double kDegree = kPi / 180;
constexpr double kAxisToleranceRad = rad_from_deg(0.005);  ///< where even turns are not those of the tool
constexpr double kReturnMmPerS = 10;                       ///< to a cut whose tip stands still

}  // namespace

double PostRounding::tip_mm(bool inch, const nc::Frame& frame) const {
  const double half = 0.5 * std::pow(10.0, -(inch ? decimals_inch : decimals_mm)) * (inch ? kMmPerInch : 1);
  return 3 * half * (frame.plain || frame.shift_only ? 1 : frame.linear.norm());
}

Vec3 PostRounding::deg(const Vec3& rotary_rad) const {
  Vec3 out;
  for (int i = 0; i < 3; ++i) out[i] = nc::rounded(deg_from_rad(rotary_rad[i]), decimals_deg);
  return out;
}

PostPoint Divider::point(const TipMotion& motion, const RotaryChoice& choice, double from, double to) const {
  PostPoint out;
  out.tip_mm = frame_.tip_mm(motion, to);
  out.rotary_deg = rounding_.deg(choice.of(motion.rotary_rad(to)));
  out.linear_mm = frame_.linear_mm(motion, to, out.rotary_deg * kDegree);
  out.from = from;
  out.to = to;
  out.rapid = motion.rapid;
  out.time_s = (to - from) * motion.time_s;
  return out;
}

double Divider::bound(const TipMotion& motion, const RotaryChoice& choice, double from, double to) const {
  const Vec3 rotary[2] = {rounding_.deg(choice.of(motion.rotary_rad(from))) * kDegree,
                          rounding_.deg(choice.of(motion.rotary_rad(to))) * kDegree};
  return frame_.deviation_bound_mm(motion, from, to, rotary);
}

/// The farthest place that one block may reach; halving of the step narrows it down to 0.2 % of the block.
double Divider::farthest(const TipMotion& motion, const RotaryChoice& choice, double from, double to,
                         double tolerance_mm) const {
  const double turn = (motion.rotary_rad(to) - motion.rotary_rad(from)).lpNorm<Eigen::Infinity>();
  const auto holds = [&](double at) {
    return turn * (at - from) / (to - from) <= kMaxStepRad && bound(motion, choice, from, at) <= tolerance_mm &&
           choice.deviation_rad(motion.rotary_rad(from), motion.rotary_rad(at)) <= kAxisToleranceRad;
  };
  if (holds(to)) return to;
  double good = from, bad = to;
  for (int i = 0; i < 60 && (good == from || bad - good > 0.002 * (good - from)); ++i) {
    const double at = (good + bad) / 2;
    (holds(at) ? good : bad) = at;
  }
  return good == from ? to : good;
}

/// Returns as few cuts as the tolerance allows, each piece as long as it can be.
std::vector<double> Divider::cuts_within(const TipMotion& motion, const RotaryChoice& choice, double from, double to,
                                         double tolerance_mm) const {
  std::vector<double> out;
  for (double at = from; at < to;) out.push_back(at = farthest(motion, choice, at, to, tolerance_mm));
  return out;
}

/// Returns as many cuts, by the least tolerance that needs no more of them, so that no piece is short.
std::vector<double> Divider::even_cuts(const TipMotion& motion, const RotaryChoice& choice, double from, double to,
                                       double tolerance_mm) const {
  constexpr int kTrials = 7;
  std::vector<double> best = cuts_within(motion, choice, from, to, tolerance_mm);
  if (best.size() < 2) return best;
  double good = tolerance_mm, bad = 0;
  for (int i = 0; i < kTrials; ++i) {
    const double middle = (good + bad) / 2;
    std::vector<double> cuts = cuts_within(motion, choice, from, to, middle);
    if (cuts.size() > best.size()) {
      bad = middle;
    } else {
      good = middle;
      best = std::move(cuts);
    }
  }
  return best;
}

/// The seed's rule: a step in which an axis turns by a degree or more is divided so that the larger one stays under it.
std::vector<double> Divider::one_degree_cuts(const TipMotion& motion, double from, double to) const {
  const double turn = (motion.rotary_rad(to) - motion.rotary_rad(from)).lpNorm<Eigen::Infinity>();
  const double pieces = std::floor(deg_from_rad(turn) + 1e-9) + 1;
  std::vector<double> out;
  for (double k = 1; k < pieces; ++k) out.push_back(from + (to - from) * k / pieces);
  out.push_back(to);
  return out;
}

void Divider::go(const TipMotion& motion, const RotaryChoice& choice, double from, double to, double tolerance_mm,
                 bool extra, DividedMotion& out) const {
  if (!motion.start_known) {
    out.points.push_back(point(motion, choice, 0, 1));
    return;
  }
  const std::vector<double> by_degree = one_degree_cuts(motion, from, to);
  double at = from;
  if (!extra) {
    out.one_degree_blocks += by_degree.size();
    for (const double next : by_degree) {
      out.one_degree_bound_mm = std::max(out.one_degree_bound_mm, bound(motion, choice, at, next));
      at = next;
    }
  }
  std::vector<double> even;
  if (!options_.one_degree) even = even_cuts(motion, choice, from, to, tolerance_mm);
  at = from;
  for (const double next : options_.one_degree ? by_degree : even) {
    out.points.push_back(point(motion, choice, at, next));
    out.points.back().extra = extra;
    out.bound_mm = std::max(out.bound_mm, bound(motion, choice, at, next));
    out.axis_bound_rad =
        std::max(out.axis_bound_rad, choice.deviation_rad(motion.rotary_rad(at), motion.rotary_rad(next)));
    at = next;
  }
}

double Divider::retract_within_travel(const TipMotion& turn, const Vec3& axis) const {
  constexpr int kPlaces = 24, kHeights = 20;
  const auto within = [&](double height) {
    TipMotion lifted = turn;
    lifted.start_tip_mm = lifted.end_tip_mm = turn.start_tip_mm + height * axis;
    for (int i = 0; i <= kPlaces; ++i) {
      const double u = static_cast<double>(i) / kPlaces;
      const Vec3 at = frame_.linear_mm(lifted, u, lifted.rotary_rad(u));
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& range = machine_.axis[k].travel_mm;
        if (at[static_cast<Eigen::Index>(k)] < range[0] || at[static_cast<Eigen::Index>(k)] > range[1]) return false;
      }
    }
    return true;
  };
  for (int i = kHeights; i > 0; --i)
    if (const double height = options_.retract_mm * i / kHeights; within(height)) return height;
  return 0;
}

/// Off along the tool, the turn with the tip held there, and back; to a cut with its feed.
TurnBack Divider::turn_back(const TipMotion& motion, const PlannedStretch& stretch, DividedMotion& out) const {
  TipMotion turn = motion;
  turn.follows_tip = true;
  turn.arc = false;
  turn.rapid = true;
  turn.time_s = 0;
  turn.start_known = true;
  turn.start_rad = stretch.before.of(motion.rotary_rad(stretch.from));
  turn.end_rad = stretch.choice.of(motion.rotary_rad(stretch.from));
  const Vec3 tip = frame_.tip_mm(motion, stretch.from);
  turn.start_tip_mm = turn.end_tip_mm = tip;
  const Vec3 axis = frame_.chain().pose({Vec3::Zero(), turn.start_rad}, 0).axis;
  const TurnBack back{motion.move, stretch.in_air, turn.start_rad, turn.end_rad, retract_within_travel(turn, axis)};
  const Vec3 lifted = tip + back.retract_mm * axis;
  const double length = (motion.end_tip_mm - motion.start_tip_mm).norm();
  const double speed = motion.time_s > 0 && length > 0 ? length / motion.time_s : kReturnMmPerS;
  const auto along_tool = [&](const Vec3& from, const Vec3& to, const Vec3& rotary, bool rapid) {
    TipMotion way = turn;
    way.start_tip_mm = from;
    way.end_tip_mm = to;
    way.start_rad = way.end_rad = rotary;
    way.rapid = rapid;
    way.time_s = rapid ? 0 : (to - from).norm() / speed;
    go(way, {}, 0, 1, options_.rapid_tolerance_mm, true, out);
  };
  if (back.retract_mm > 0) along_tool(tip, lifted, turn.start_rad, true);
  turn.start_tip_mm = turn.end_tip_mm = lifted;
  go(turn, {}, 0, 1, options_.rapid_tolerance_mm, true, out);
  if (back.retract_mm > 0) along_tool(lifted, tip, turn.end_rad, motion.rapid);
  return back;
}

DividedMotion Divider::divide(const TipMotion& motion, std::span<const PlannedStretch> stretches, double rounding_mm,
                              std::vector<TurnBack>& turns_back) const {
  DividedMotion out;
  const double tolerance = motion.rapid ? options_.rapid_tolerance_mm : options_.tolerance_mm;
  for (const PlannedStretch& s : stretches) {
    if (s.turns_back) {
      const double before = out.bound_mm;
      turns_back.push_back(turn_back(motion, s, out));
      out.bound_mm = before;
    }
    go(motion, s.choice, s.from, s.to, tolerance - rounding_mm, false, out);
  }
  out.bound_mm += rounding_mm;
  return out;
}

}  // namespace camber::repath
