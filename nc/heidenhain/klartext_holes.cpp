// The moves of cycles: holes, bores, threads, pockets.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/heidenhain/klartext_flow.h"

namespace camber::nc::heidenhain {

constexpr double kAboveLastDepthMm = 0.2;  ///< rapids in a hole stop so far above the last depth (MP7410 and its like)

void CycleMoves::run(std::size_t offset) {
  const int number = cycle_.number;
  cycle_.offset = offset;
  if (number == 208)
    mill_bore();
  else if (number == 262)
    mill_thread();
  else if (number == 4 || number == 5)
    mill_old_pocket();
  else if (number >= 251 && number <= 253)
    mill_pocket_cycle();
  else if (cycle_.is_old() && number != 12)  // 12: a program
    drill_old();
  else if (number != 12)
    drill(number);
  g_ = 0;
}

double CycleMoves::q(int number) {
  const double value = at_.parameters.value({'Q', number}, cycle_.offset);
  return at_.known(value, cycle_.offset);
}

std::optional<double> CycleMoves::q_if_set(int number) {
  try {
    return q(number);
  } catch (const FormulaError&) {
    return std::nullopt;
  }
}

/// mm/s; infinite: rapid.
double CycleMoves::feed_q(int number) {
  const double value = q(number);
  if (value >= 9999 * (at_.inch ? 0.1 : 10)) return std::numeric_limits<double>::infinity();
  return mm_per_s_from_mm_per_min(value * at_.unit_mm());
}

void CycleMoves::go(MoveKind kind, const Vec3& programmed_end, double feed_mm_per_s, double dwell_s) {
  const Vec3 end = mover_.end_in_moves(programmed_end, 7);
  if (kind != MoveKind::dwell && end == mover_.position_mm()) return;
  if (++count_ > kMaxCycleMoves)
    refuse("cycle", fmt::format("the cycles make more than {} moves; fewer pecks were expected", kMaxCycleMoves));
  const bool rapid = kind == MoveKind::linear && std::isinf(feed_mm_per_s);
  Move& move = mover_.add_move(rapid ? MoveKind::rapid : kind, end);
  move.canned = true;
  move.editable = false;
  move.cycle = static_cast<std::uint8_t>(g_);
  move.dwell_s = dwell_s;
  if (kind == MoveKind::linear && !rapid) move.feed_mm_per_s = feed_mm_per_s;
}

void CycleMoves::go_to_height(MoveKind kind, double height_mm, double feed_mm_per_s) {
  Vec3 end = mover_.programmed();
  end[tools_.axis()] = height_mm;
  go(kind, end, feed_mm_per_s);
}

void CycleMoves::drill_hole(const Hole& h) {
  const int normal = tools_.axis();
  const double top = h.surface_mm + h.clearance_mm, bottom = h.surface_mm + h.depth_mm;
  const auto dwell = [&](double seconds) {
    if (seconds > 0) go(MoveKind::dwell, mover_.programmed(), 0, seconds);
  };
  if (h.depth_mm < 0 && mover_.at_machine_place(normal)) {
    go_to_height(MoveKind::rapid, top, 0);  // from a machine coordinate; the height of the cycle is absolute
    mover_.settle(static_cast<std::uint8_t>(1U << normal));
  }
  mover_.prepare_cutting("a cycle", 0);
  if (h.depth_mm == 0) return;
  if (h.depth_mm > 0)
    refuse("cycle", fmt::format("the depth of cycle {} is positive ({}); a negative one was expected", cycle_.number,
                                h.depth_mm / at_.unit_mm()));
  if (h.feed_mm_per_s <= 0)
    refuse("feed-missing", fmt::format("cycle {} has no feed; a feed greater than zero was expected", cycle_.number));
  go_to_height(MoveKind::rapid, top, 0);
  const double begin = h.start_mm < 0 ? h.surface_mm + h.start_mm : top;
  if (h.start_mm < 0)
    go_to_height(MoveKind::linear, begin + std::min(h.clearance_mm, top - begin), h.pre_feed_mm_per_s);
  double depth = h.start_mm < 0 ? h.surface_mm + h.start_mm : h.surface_mm;
  double peck = h.peck_mm > 0 ? h.peck_mm : depth - bottom;
  if ((depth - bottom) / std::max(1e-12, h.less_mm > 0 ? std::min(peck, std::max(h.least_mm, 1e-12)) : peck) >
      kMaxPecks)
    refuse("cycle", "the cycle would peck more than 100000 times; a larger Q202 was expected");
  int breaks = h.breaks;
  while (depth > bottom) {
    const double next = std::max(depth - peck, bottom);
    peck = h.less_mm > 0 ? std::max(peck - h.less_mm, std::max(h.least_mm, 1e-6)) : peck;
    go_to_height(MoveKind::linear, next, h.feed_mm_per_s);
    depth = next;
    if (depth <= bottom) break;
    if (breaks > 0) {
      --breaks;
      go_to_height(MoveKind::linear, depth + h.break_mm, std::numeric_limits<double>::infinity());
      continue;
    }
    breaks = h.breaks;
    go_to_height(MoveKind::rapid, top, 0);
    dwell(h.dwell_top_s);
    go_to_height(MoveKind::rapid, std::min(depth + h.above_mm, top), 0);
  }
  dwell(h.dwell_s);
  Vec3 off = Vec3::Zero();
  if (h.off_mm != Vec3::Zero()) {
    off = h.off_mm;
    go(MoveKind::rapid, mover_.programmed() + off, 0);
  }
  if (h.feed_out_mm_per_s)
    go_to_height(MoveKind::linear, top, *h.feed_out_mm_per_s);
  else
    go_to_height(MoveKind::rapid, top, 0);
  go_to_height(MoveKind::rapid, std::max(top, h.surface_mm + h.second_mm), 0);
  if (off != Vec3::Zero()) go(MoveKind::rapid, mover_.programmed() - off, 0);
}

/// Cycles 200 to 209, 240, 241 at the place of the tool.
void CycleMoves::drill(int number) {
  const double unit = at_.unit_mm();
  Hole h;
  h.surface_mm = q_if_set(203).value_or(0) * unit;
  h.clearance_mm = q(200) * unit;
  h.second_mm = q_if_set(204).value_or(0) * unit;
  h.dwell_s = q_if_set(211).value_or(0);
  if (number != 240) h.depth_mm = number == 204 ? 0 : q(201) * unit;
  const auto tap = [&](double pitch) {
    h.feed_mm_per_s = tapping_feed(pitch * unit);
    h.feed_out_mm_per_s = h.feed_mm_per_s;
    h.dwell_s = 0;
  };
  if (number != 204 && number != 207 && number != 209) h.feed_mm_per_s = feed_q(206);
  // 201 and 202 must have it; of the others it is not known where it is negative.
  const double out = number == 201 || number == 202 || q_if_set(208) ? feed_q(208) : -1;
  switch (number) {
    case 200:
      h.peck_mm = q(202) * unit;
      h.above_mm = h.clearance_mm;
      h.dwell_top_s = q_if_set(210).value_or(0);
      g_ = h.peck_mm < -h.depth_mm ? 83 : h.dwell_s > 0 ? 82 : 81;
      break;
    case 201:
      h.feed_out_mm_per_s = out > 0 ? out : h.feed_mm_per_s;
      g_ = h.dwell_s > 0 ? 89 : 85;
      break;
    case 202: {
      h.feed_out_mm_per_s = out > 0 ? out : h.feed_mm_per_s;
      if (std::isinf(*h.feed_out_mm_per_s)) h.feed_out_mm_per_s.reset();
      const int direction = static_cast<int>(q_if_set(214).value_or(0));
      const PlaneAxes axes = tools_.axes();
      // 1: the tool leaves the wall towards minus of the first axis, 2: of the second, 3 and 4: towards plus.
      if (direction >= 1 && direction <= 4)
        h.off_mm[direction % 2 == 1 ? axes.first : axes.second] =
            direction <= 2 ? -kAboveLastDepthMm : kAboveLastDepthMm;
      g_ = 76;
      break;
    }
    case 203:
      h.above_mm = h.clearance_mm;
      h.peck_mm = q(202) * unit;
      h.less_mm = q_if_set(212).value_or(0) * unit;
      h.least_mm = q_if_set(205).value_or(0) * unit;
      h.breaks = static_cast<int>(q_if_set(213).value_or(0));
      h.break_mm = q_if_set(256).value_or(kAboveLastDepthMm) * unit;
      h.dwell_top_s = q_if_set(210).value_or(0);
      if (out > 0 && !std::isinf(out)) h.feed_out_mm_per_s = out;
      if (out == 0) h.feed_out_mm_per_s = h.feed_mm_per_s;
      g_ = h.peck_mm < -h.depth_mm ? (h.breaks > 0 ? 73 : 83) : 81;
      break;
    case 205:
      h.peck_mm = q(202) * unit;
      h.less_mm = q_if_set(212).value_or(0) * unit;
      h.least_mm = q_if_set(205).value_or(0) * unit;
      h.above_mm = q_if_set(258).value_or(kAboveLastDepthMm) * unit;
      h.start_mm = -std::abs(q_if_set(379).value_or(0) * unit);
      h.pre_feed_mm_per_s = q_if_set(253) ? feed_q(253) : h.feed_mm_per_s;
      h.break_mm = q_if_set(256).value_or(kAboveLastDepthMm) * unit;
      if (const auto every = q_if_set(257); every && *every > 0 && h.peck_mm > 0) {
        // Chip breaks every so much; the chip is cleared after each depth of Q202.
        h.breaks = std::max(0, static_cast<int>(std::ceil(h.peck_mm / (*every * unit) - 1e-9)) - 1);
        h.peck_mm = *every * unit;
      }
      g_ = h.breaks > 0 ? 73 : 83;
      break;
    case 206:
      h.feed_out_mm_per_s = h.feed_mm_per_s;
      g_ = 84;
      break;
    case 207:
    case 209:
      tap(q(239));
      if (const auto every = q_if_set(257); number == 209 && every && *every > 0) {
        h.peck_mm = *every * unit;
        h.break_mm = q_if_set(256).value_or(0) * unit;
        h.breaks = h.break_mm > 0 ? 1'000'000 : 0;
      }
      break;
    case 240:
      if (q_if_set(343).value_or(0) == 1) {
        // By the diameter of the cone: the point angle is in the tool table; 90 degrees are taken.
        h.depth_mm = -0.5 * std::abs(q(344)) * unit;
        at_.warn(cycle_.offset, "point-angle",
                 "cycle 240 by its diameter needs the point angle of the tool table; 90 degrees are assumed");
      } else {
        h.depth_mm = q(201) * unit;
      }
      g_ = 82;
      break;
    case 241:
      h.start_mm = -std::abs(q_if_set(379).value_or(0) * unit);
      h.pre_feed_mm_per_s = q_if_set(253) ? feed_q(253) : h.feed_mm_per_s;
      if (out > 0 && !std::isinf(out)) h.feed_out_mm_per_s = out;
      g_ = h.dwell_s > 0 ? 82 : 81;
      break;
    default:  // 204
      return bore_back();
  }
  drill_hole(h);
}

/// Cycle 204: a counterbore from below.
void CycleMoves::bore_back() {
  const double unit = at_.unit_mm();
  const double surface = q_if_set(203).value_or(0) * unit, clearance = q(200) * unit;
  const double depth = q(249) * unit, thickness = q(250) * unit, off = q(251) * unit, edge = q(252) * unit;
  const double feed = feed_q(254), pre_feed = feed_q(253), dwell = q_if_set(255).value_or(0);
  const int direction = static_cast<int>(q_if_set(214).value_or(1));
  const PlaneAxes axes = tools_.axes();
  Vec3 shift = Vec3::Zero();
  if (direction >= 1 && direction <= 4)
    shift[direction % 2 == 1 ? axes.first : axes.second] = direction <= 2 ? -off : off;
  if (feed <= 0) refuse("feed-missing", "cycle 204 has no feed; Q254 greater than zero was expected");
  g_ = 87;
  mover_.prepare_cutting("a cycle", 0);
  constexpr double kRapid = std::numeric_limits<double>::infinity();
  const Vec3 centre = mover_.programmed();
  go_to_height(MoveKind::linear, surface + clearance, kRapid);
  go(MoveKind::rapid, mover_.programmed() + shift, 0);
  go_to_height(MoveKind::linear, surface - thickness - edge - clearance, pre_feed);
  go(MoveKind::linear, mover_.programmed() - shift, pre_feed);
  go_to_height(MoveKind::linear, surface - thickness - edge + depth, feed);
  if (dwell > 0) go(MoveKind::dwell, mover_.programmed(), 0, dwell);
  go_to_height(MoveKind::linear, surface - thickness - edge - clearance, pre_feed);
  go(MoveKind::linear, mover_.programmed() + shift, pre_feed);
  go_to_height(MoveKind::linear, surface + std::max(clearance, q_if_set(204).value_or(0) * unit), kRapid);
  Vec3 back = centre;
  back[tools_.axis()] = mover_.programmed()[tools_.axis()];
  go(MoveKind::rapid, back, 0);
}

/// mm/s, of a pitch that is negative for left-hand threads.
double CycleMoves::tapping_feed(double pitch_mm) {
  const double rpm = modes_.state().spindle_speed_rpm;
  if (rpm <= 0) refuse("spindle-speed", "tapping without a spindle speed; S was expected");
  g_ = pitch_mm < 0 ? 74 : 84;
  return std::abs(pitch_mm) * rpm / 60;
}

/// The feed beside such a value, else the one that is active.
double CycleMoves::old_feed(int part) const {
  const auto found = cycle_.feeds.find(part);
  return found != cycle_.feeds.end() ? found->second : modes_.feed().value_or(0);
}

/// The value of CYCL DEF 1.2 and the like.
double CycleMoves::old_value(int part) const {
  if (const auto found = cycle_.values.find(part); found != cycle_.values.end()) return found->second;
  refuse("cycle", fmt::format("cycle {0} without its part {0}.{1}", cycle_.number, part));
}

/// Cycles 1, 2 and 17: the tool stands at the clearance above the surface.
void CycleMoves::drill_old() {
  const double unit = at_.unit_mm();
  const auto value = [&](int part) { return old_value(part); };
  Hole h;
  h.clearance_mm = std::abs(value(1)) * unit;
  h.surface_mm = mover_.programmed()[tools_.axis()] - h.clearance_mm;
  h.depth_mm = value(2) * unit;
  if (cycle_.number == 1) {
    h.peck_mm = std::abs(value(3)) * unit;
    h.above_mm = std::clamp(-h.depth_mm / 50, 0.6, 7.0);  // t of the manuals
    h.dwell_s = cycle_.values.contains(4) ? value(4) : 0;
    h.feed_mm_per_s = old_feed(5);
    g_ = h.peck_mm < -h.depth_mm ? 83 : 81;
  } else if (cycle_.number == 2) {
    h.dwell_s = cycle_.values.contains(3) ? value(3) : 0;
    h.feed_mm_per_s = old_feed(4);
    h.feed_out_mm_per_s = h.feed_mm_per_s;
    g_ = 84;
  } else {
    h.feed_mm_per_s = tapping_feed(value(3) * unit);
    h.feed_out_mm_per_s = h.feed_mm_per_s;
  }
  drill_hole(h);
}

/// A circle or helix about `centre` from where the tool stands.
void CycleMoves::go_round(const Vec3& centre, double sweep_rad, double end_height_mm, double feed_mm_per_s) {
  const PlaneAxes axes = tools_.axes();
  const Vec3 start = mover_.programmed();
  Arc arc;
  arc.normal = normal_of(tools_.plane());
  arc.center_mm = centre;
  arc.center_mm[axes.normal] = start[axes.normal];
  arc.sweep_rad = sweep_rad;
  const double x = start[axes.first] - centre[axes.first], y = start[axes.second] - centre[axes.second];
  Vec3 end = start;
  const double turn = std::fmod(sweep_rad, 2 * kPi);
  if (std::abs(turn) > 1e-12) {
    end[axes.first] = centre[axes.first] + std::cos(turn) * x - std::sin(turn) * y;
    end[axes.second] = centre[axes.second] + std::sin(turn) * x + std::cos(turn) * y;
  }
  end[axes.normal] = end_height_mm;
  const auto in_moves = frames_.frame().plain ? std::optional(arc) : from_program(frames_.frame(), arc);
  if (!in_moves) refuse("scaling", "a circle of a cycle under a scale of single axes is an ellipse");
  at_.out.arcs.push_back(*in_moves);
  Move& move = mover_.add_move(MoveKind::arc, mover_.end_in_moves(end, 7));
  move.arc = static_cast<std::uint32_t>(at_.out.arcs.size() - 1);
  move.canned = true;
  move.editable = false;
  move.feed_mm_per_s = feed_mm_per_s;
  ++count_;
}

/// Cycle 208: a helix down to the depth, a full circle, back to the middle.
void CycleMoves::mill_bore() {
  const double unit = at_.unit_mm();
  const double surface = q_if_set(203).value_or(0) * unit, top = surface + q(200) * unit,
               bottom = surface + q(201) * unit;
  const double feed = feed_q(206), pitch = std::abs(q(334)) * unit, diameter = q(335) * unit;
  const bool climb = q_if_set(351).value_or(1) >= 0;
  const double high = std::max(top, surface + q_if_set(204).value_or(0) * unit);
  const auto tool = tools_.cutter_radius_mm();
  if (feed <= 0 || std::isinf(feed))
    refuse("feed-missing", "cycle 208 has no feed; Q206 greater than zero was expected");
  if (bottom >= top) refuse("cycle", "the depth of cycle 208 is positive; a negative one was expected");
  mover_.prepare_cutting("a cycle", 0);
  if (!tool)
    at_.warn(cycle_.offset, "radius-unknown",
             fmt::format(
                 "cycle 208 needs the radius of tool {}, which nothing gives (TOOL DEF with R); its helix is read as a "
                 "plunge at its middle",
                 modes_.state().tool),
             "cycle 208");
  const double radius = tool ? 0.5 * diameter - *tool : 0;
  if (tool && radius < 0)
    refuse("cutter-too-large",
           fmt::format("the hole of cycle 208 ({:.4f} mm) is smaller than the tool ({:.4f} mm)", diameter, 2 * *tool));
  const Vec3 middle = mover_.programmed();
  go_to_height(MoveKind::rapid, top, feed);
  if (radius > 1e-6) {
    Vec3 beside = mover_.programmed();
    beside[tools_.axes().first] += radius;
    go(MoveKind::linear, beside, feed);
    const double turns = pitch > 0 ? (top - bottom) / pitch : 1;
    if (turns > kMaxPecks) refuse("cycle", "cycle 208 would make more than 100000 turns; a larger Q334 was expected");
    const double sense = climb ? 1 : -1;
    go_round(middle, sense * 2 * kPi * turns, bottom, feed);
    go_round(middle, sense * 2 * kPi, bottom, feed);
    Vec3 back = middle;
    back[tools_.axis()] = bottom;
    go(MoveKind::linear, back, feed);
  } else {
    go_to_height(MoveKind::linear, bottom, feed);
  }
  go_to_height(MoveKind::rapid, high, feed);
}

/// Cycle 262: an inside thread by helices, with semicircles in and out. Q355: 0 one turn at the depth, 1 the whole
/// length at once, else single turns so many pitches apart.
void CycleMoves::mill_thread() {
  const double unit = at_.unit_mm(), surface = q_if_set(203).value_or(0) * unit,
               top = surface + std::abs(q(200)) * unit;
  const double depth = -q(201) * unit, pitch = std::abs(q(239)) * unit,
               apart = std::max(0.0, q_if_set(355).value_or(0));
  const double feed = feed_q(207), down = q_if_set(253) ? feed_q(253) : feed;
  if (!(feed > 0) || std::isinf(feed) || !(down > 0))
    refuse("feed-missing", "cycle 262 has no feed; Q207 greater than zero was expected");
  if (!(depth > 0) || !(pitch > 0) || depth / pitch > kMaxPecks)
    refuse("cycle", "cycle 262 needs a negative depth Q201 and a pitch Q239");
  mover_.prepare_cutting("a cycle", 0);
  const double tool = tools_.cutter_radius_mm().value_or(0), radius = 0.5 * q(335) * unit - tool;
  if (tool == 0)
    at_.warn(cycle_.offset, "radius-unknown",
             fmt::format("no radius is given for tool {}; cycle 262 takes 0", modes_.state().tool), "cycle 262");
  if (!(radius > 0))
    refuse("cutter-too-large", fmt::format("the thread of cycle 262 ({:.4f} mm) is smaller than the tool ({:.4f} mm)",
                                           q(335) * unit, 2 * tool));
  at_.warn(cycle_.offset, "cycle",
           "the ways in and out of cycle 262 are taken as semicircles; the control's are helices", "cycle 262 ways");
  const bool clockwise_spindle = modes_.state().spindle != SpindleDirection::counter_clockwise;
  const double sense = (q_if_set(351).value_or(1) >= 0) == clockwise_spindle ? 1 : -1;
  const bool up = (q(239) > 0) == (sense > 0);
  const double length = apart == 1 ? depth : pitch, count = apart > 1 ? std::ceil(depth / (apart * pitch) - 1e-9) : 1;
  const Vec3 middle = mover_.programmed();
  const int first = tools_.axes().first;
  const auto at = [&](double beside, double height) {
    Vec3 p = middle;
    p[first] += beside;
    p[tools_.axis()] = height;
    return p;
  };
  go(MoveKind::rapid, at(0, top), 0);
  for (int i = 0; i < static_cast<int>(count); ++i) {
    const double low = surface - depth + (up ? i : count - 1 - i) * apart * pitch;
    const double from = up ? low : low + length, to = up ? low + length : low;
    go(MoveKind::linear, at(0, from), down);
    go_round(at(radius / 2, from), sense * kPi, from, feed);
    go_round(middle, sense * 2 * kPi * length / pitch, to, feed);
    go_round(0.5 * (at(0, to) + mover_.programmed()), sense * kPi, to, feed);
  }
  go(MoveKind::rapid, at(0, std::max(top, surface + q_if_set(204).value_or(0) * unit)), 0);
}

PocketMoves CycleMoves::pocket_moves() {
  return {[this](const Vec3& end, double feed) { go(MoveKind::linear, end, feed); },
          [this](const Vec3& centre, double sweep, double feed) {
            go_round(centre, sweep, mover_.programmed()[tools_.axis()], feed);
          }};
}

/// Radius of the cutter; without it there is no pocket.
double CycleMoves::pocket_cutter_mm() const {
  if (const auto tool = tools_.cutter_radius_mm(); tool && *tool > 0) return *tool;
  refuse("radius-unknown",
         fmt::format("cycle {} (pocket milling) needs the radius of tool {}, which nothing gives; TOOL DEF {} "
                     "with R, or the finished path, was expected",
                     cycle_.number, modes_.state().tool, modes_.state().tool));
}

/// Cycles 4 and 5: a pocket from its middle outwards, in depths. The tool stands at the clearance above the middle.
void CycleMoves::mill_old_pocket() {
  const double unit = at_.unit_mm();
  const bool round = cycle_.number == 5;
  const double tool = pocket_cutter_mm();
  const auto value = [&](int part) { return old_value(part) * unit; };
  const PlaneAxes axes = tools_.axes();
  const double clearance = std::abs(value(1)), depth = std::abs(value(2)), step = std::abs(value(3));
  const double plunge = old_feed(3), feed = old_feed(round ? 5 : 6);
  if (plunge <= 0 || feed <= 0) refuse("feed-missing", "the pocket has no feed; F was expected in its parts");
  if (step <= 0) refuse("cycle", "the pocket has no depth of each cut; its part 3 was expected");
  PocketCycle pocket;
  pocket.round = round;
  pocket.half_mm[0] = round ? value(4) - tool : 0.5 * std::abs(value(4)) - tool;
  pocket.half_mm[1] = round ? pocket.half_mm[0] : 0.5 * std::abs(value(5)) - tool;
  if (pocket.least_mm() < -1e-9 || pocket.half_mm[1] < -1e-9)
    refuse("cutter-too-large", "the pocket is smaller than the tool");
  constexpr double kOverlap = 1.4;  // of the radius: MP7430
  pocket.sideways_mm = kOverlap * tool;
  pocket.sense = cycle_.sense;
  pocket.feed_mm_per_s = feed;
  pocket.middle_mm = mover_.programmed();
  const Vec3 middle = pocket.middle_mm;
  const double surface = middle[axes.normal] - clearance;
  mover_.prepare_cutting("a cycle", 0);
  for (double z = surface; z > surface - depth + 1e-9;) {
    z = std::max(z - step, surface - depth);
    Vec3 floor = middle;
    floor[axes.normal] = z;
    go(MoveKind::linear, floor, plunge);
    if (!mill_pocket_level(pocket, axes, z, pocket.least_mm(), 0, pocket_moves())) return too_many_cuts();
    go(MoveKind::linear, floor, feed);
  }
  go(MoveKind::rapid, middle, 0);
}

void CycleMoves::refuse(const char* check, const std::string& message) const {
  throw FormulaError(cycle_.offset, check, message);
}

void CycleMoves::too_many_cuts() const {
  refuse("cycle",
         fmt::format("cycle {} would take more than 100000 rings or depths; larger ones were expected", cycle_.number));
}

/// Cycles 251 to 253.
void CycleMoves::mill_pocket_cycle() {
  const double unit = at_.unit_mm();
  const int number = cycle_.number;
  const double tool = pocket_cutter_mm();
  PocketCycle pocket;
  pocket.round = number == 252;
  pocket.side_mm = q_if_set(368).value_or(0) * unit;
  pocket.floor_mm = q_if_set(369).value_or(0) * unit;
  pocket.surface_mm = q_if_set(203).value_or(0) * unit;
  pocket.bottom_mm = pocket.surface_mm + q(201) * unit;
  pocket.clearance_mm = pocket.surface_mm + std::abs(q(200)) * unit;
  pocket.step_mm = std::abs(q(202)) * unit;
  pocket.plunge_mm_per_s = feed_q(206);
  pocket.finishing_step_mm = std::abs(q_if_set(338).value_or(0)) * unit;
  const int operation = static_cast<int>(q_if_set(215).value_or(0));
  pocket.roughs = operation != 2;
  pocket.finishes = operation != 1;
  const bool slot = number == 253;
  const double overlap = slot ? 1 : q_if_set(370).value_or(1);
  pocket.feed_mm_per_s = feed_q(207);
  pocket.finishing_mm_per_s = q_if_set(385) ? feed_q(385) : pocket.feed_mm_per_s;
  if (pocket.feed_mm_per_s <= 0 || pocket.plunge_mm_per_s <= 0 || pocket.finishing_mm_per_s <= 0 ||
      std::isinf(pocket.feed_mm_per_s))
    refuse("feed-missing", fmt::format("cycle {} has no feed; Q206 and Q207 greater than zero were expected", number));
  if (pocket.bottom_mm >= pocket.surface_mm || pocket.step_mm <= 0)
    refuse("cycle", fmt::format("cycle {} needs a negative depth Q201 and a depth of each cut Q202", number));
  if (!(overlap > 0 && overlap < 2))
    refuse("cycle", fmt::format("an overlap Q370 of {:g}; greater than 0 and less than 2 was expected", overlap));
  const double whole_x = (pocket.round ? q(223) : q(218)) * unit, whole_y = (pocket.round ? q(223) : q(219)) * unit;
  pocket.half_mm[0] = 0.5 * std::abs(whole_x) - tool;
  pocket.half_mm[1] = 0.5 * std::abs(whole_y) - tool;
  if (pocket.least_mm() - pocket.side_mm < -1e-9)
    refuse("cutter-too-large",
           fmt::format("the pocket of cycle {} is smaller than the tool of {:.4f} mm and its allowance", number,
                       2 * tool));
  if (!pocket.round) {
    pocket.corner_mm = slot ? pocket.half_mm[1] : std::max(0.0, std::abs(q_if_set(220).value_or(0)) * unit - tool);
    pocket.angle_rad = rad_from_deg(q_if_set(slot ? 374 : 224).value_or(0));
  }
  const PlaneAxes axes = tools_.axes();
  pocket.middle_mm = mover_.programmed();
  if (const int place = static_cast<int>(q_if_set(367).value_or(0)); place > 0 && !pocket.round) {
    // The tool stands at a corner: 1 lower left, 2 lower right, 3 upper right, 4 upper left. Of a slot: 1 left end, 2
    // and 3 centres of its left and right arc, 4 right end.
    const bool left = slot ? place <= 2 : place == 1 || place == 4, at_arc = slot && (place == 2 || place == 3);
    const double x = (left ? 0.5 : -0.5) * (std::abs(whole_x) - (at_arc ? std::abs(whole_y) : 0)),
                 y = slot ? 0 : (place <= 2 ? 0.5 : -0.5) * std::abs(whole_y);
    const double c = std::cos(pocket.angle_rad), s = std::sin(pocket.angle_rad);
    pocket.middle_mm[axes.first] += c * x - s * y;
    pocket.middle_mm[axes.second] += s * x + c * y;
  }
  // Climb cutting inside goes round counter-clockwise where the spindle turns clockwise.
  const bool climb = q_if_set(351).value_or(1) >= 0;
  pocket.sense = climb == (modes_.state().spindle != SpindleDirection::counter_clockwise) ? 1 : -1;
  pocket.sideways_mm = overlap * tool;
  mover_.prepare_cutting("a cycle", 0);
  if (q_if_set(366).value_or(0) != 0 && operation != 2)
    at_.warn(
        cycle_.offset, "cycle",
        fmt::format("the plunge of cycle {} along a helix or to and fro (Q366) takes ANGLE of the tool table; it is "
                    "read as a vertical one",
                    number),
        "Q366");
  if (!mill_pocket(pocket, axes, mover_.programmed(), pocket_moves())) return too_many_cuts();
  Vec3 high = mover_.programmed();
  high[axes.normal] = std::max(pocket.clearance_mm, pocket.surface_mm + q_if_set(204).value_or(0) * unit);
  go(MoveKind::rapid, high, 0);
}

}  // namespace camber::nc::heidenhain
