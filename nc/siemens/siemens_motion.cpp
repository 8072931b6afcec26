// Words that make moves: lines, arcs, dwells, machine coordinates. Cycles: siemens_cycles.cpp.
#include "nc/siemens/siemens_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "base/units.h"
#include "nc/siemens/line_parser.h"

namespace camber::nc::siemens {
namespace {

constexpr char kAxisLetters[] = "XYZ";
constexpr char kCentreLetters[] = "IJK";

bool is_alnum(char c) { return is_letter(c) || is_digit(c); }

/// Messages of arcs in the words of this control.
std::string in_own_words(const std::string& message) {
  std::string out;
  for (std::size_t i = 0; i < message.size(); ++i) {
    const bool alone = (i == 0 || !is_alnum(message[i - 1]));
    if (message[i] == 'R' && alone && (i + 1 == message.size() || !is_letter(message[i + 1]))) {
      out += i + 1 < message.size() && is_digit(message[i + 1]) ? "CR=" : "CR";
    } else if (message.compare(i, 8, " (G90.1)") == 0) {
      out += " (I=AC(...))";
      i += 7;
    } else {
      out += message[i];
    }
  }
  return out;
}

}  // namespace

Vec3 PathBlocks::target_in_program() {
  const Vec3 start = mover_.programmed();
  if (at_.words.uses_extras() && (at_.words.has(Extra::ap) || at_.words.has(Extra::rp))) return polar_target(start);
  Vec3 end = start;
  for (int axis = 0; axis < 3; ++axis)
    if (at_.words.has(kAxisLetters[axis]))
      end[axis] = modes_.axis_value(at_.words.of(kAxisLetters[axis]), start[axis], modes_.unit_mm());
  if (at_.words.has(Extra::ang)) {
    at_.editable = false;
    at_.relied_ends.add(at_.out.moves);
    const PlaneAxes axes = at_.axes();
    const bool first = at_.words.has(kAxisLetters[axes.first]), second = at_.words.has(kAxisLetters[axes.second]);
    const double angle = rad_from_deg(at_.words.of(Extra::ang).value);
    const double across = first ? std::cos(angle) : std::sin(angle), along = first ? std::sin(angle) : std::cos(angle);
    const int given = first ? axes.first : axes.second, open = first ? axes.second : axes.first;
    if (first == second)
      at_.error(at_.words.of(Extra::ang).offset, "line-angle",
                fmt::format("ANG in a block with {} of {} and {} is not supported; one of them was expected",
                            first ? "both" : "none", kAxisLetters[axes.first], kAxisLetters[axes.second]));
    else if (std::abs(across) < 1e-6)
      at_.error(at_.words.of(Extra::ang).offset, "line-angle",
                fmt::format("a line at {:g} degrees does not lead to another {}", at_.words.of(Extra::ang).value,
                            kAxisLetters[given]));
    else
      end[open] = start[open] + (end[given] - start[given]) * along / across;
  }
  return end;
}

/// AP=, RP= about the pole.
Vec3 PathBlocks::polar_target(Vec3 end) {
  at_.editable = false;
  at_.relied_ends.add(at_.out.moves);
  const PlaneAxes axes = at_.axes();
  const char normal = kAxisLetters[axes.normal];
  if (at_.words.has(normal))
    end[axes.normal] = modes_.axis_value(at_.words.of(normal), end[axes.normal], modes_.unit_mm());
  for (const int axis : {axes.first, axes.second})
    if (at_.words.has(kAxisLetters[axis]))
      at_.error(
          at_.words.of(kAxisLetters[axis]).offset, "polar",
          fmt::format("{} beside AP or RP; a polar end point or a cartesian one was expected", kAxisLetters[axis]));
  const double dx = end[axes.first] - pole_mm_[axes.first], dy = end[axes.second] - pole_mm_[axes.second];
  double angle = deg_from_rad(std::atan2(dy, dx)), radius = std::hypot(dx, dy);
  const Slot &ap = at_.words.of(Extra::ap), &rp = at_.words.of(Extra::rp);
  const auto adds = [&](const Slot& slot) { return at_.is_incremental(slot); };
  if (ap.given) angle = adds(ap) ? angle + ap.value : ap.value;
  if (rp.given)
    radius =
        rp.dimension == Dimension::incremental ? radius + rp.value * modes_.unit_mm() : rp.value * modes_.unit_mm();
  if (radius < 0)
    at_.error(rp.offset, "polar", fmt::format("RP={:g} is negative; zero or more was expected", rp.value));
  // Quarter turns exactly.
  const Eigen::Matrix3d turn = rotation_in(at_.plane, rad_from_deg(angle));
  Vec3 out = Vec3::Zero();
  out[axes.first] = radius;
  out = turn * out;
  end[axes.first] = pole_mm_[axes.first] + out[axes.first];
  end[axes.second] = pole_mm_[axes.second] + out[axes.second];
  return end;
}

/// G110: from where the tool is; G111: from the zero point; G112: from the last pole.
void PathBlocks::set_pole() {
  if (at_.request.pole == 110) at_.relied_ends.add(at_.out.moves);
  const Vec3 from = at_.request.pole == 110   ? mover_.programmed()
                    : at_.request.pole == 112 ? pole_mm_
                                              : Vec3(Vec3::Zero());
  Vec3 pole = from;
  const PlaneAxes axes = at_.axes();
  if (at_.words.has(Extra::ap) || at_.words.has(Extra::rp)) {
    const double angle = rad_from_deg(at_.words.of(Extra::ap).value),
                 radius = at_.words.of(Extra::rp).value * modes_.unit_mm();
    pole[axes.first] = from[axes.first] + radius * std::cos(angle);
    pole[axes.second] = from[axes.second] + radius * std::sin(angle);
  }
  for (int axis = 0; axis < 3; ++axis)
    if (const Slot& slot = at_.words.of(kAxisLetters[axis]); slot.given)
      pole[axis] = slot.dimension == Dimension::absolute ? slot.value * modes_.unit_mm()
                                                         : from[axis] + slot.value * modes_.unit_mm();
  pole_mm_ = pole;
}

/// The end of the block's move in the frame of the moves. Axes that no word moves keep their place to the last bit.
Vec3 PathBlocks::target() {
  const Vec3 in_program = target_in_program();
  if (frames_.frame().plain) return in_program;
  Vec3 end = frames_.frame().from_program(in_program);
  if (!frames_.frame().shift_only || at_.words.uses_extras()) return end;
  for (int axis = 0; axis < 3; ++axis)
    if (!at_.words.has(kAxisLetters[axis])) end[axis] = mover_.position_mm()[axis];
  return end;
}

/// G4 F (seconds) or S (turns of the spindle).
void PathBlocks::dwell() {
  const Slot &f = at_.words.of('F'), &s = at_.words.of('S');
  double seconds = 0;
  if (f.given) {
    seconds = f.value;
  } else if (s.given && modes_.state().spindle_speed_rpm > 0) {
    seconds = s.value * 60 / modes_.state().spindle_speed_rpm;
  } else if (s.given) {
    return at_.error(s.offset, "dwell", "G4 S counts turns of the spindle, which has no speed; S was expected before");
  } else {
    return at_.error(at_.words.offset(), "dwell", "G4 has no time; F in seconds or S in turns was expected");
  }
  if (at_.words.has_any("XYZ"))
    at_.error(at_.words.offset(), "dwell",
              "G4 with X, Y or Z, which it does not move; a block of its own was expected");
  if (!(seconds >= 0))
    return at_.error(at_.words.offset(), "dwell",
                     fmt::format("a dwell of {:g} s is negative; zero or more was expected", seconds));
  mover_.add_move(MoveKind::dwell, mover_.position_mm()).dwell_s = seconds;
}

void PathBlocks::move() {
  if (const std::uint32_t positioned = std::exchange(at_.request.positioned, 0); positioned != 0) {
    // Alone in the block it is a rapid; beside the path two movements would overlap.
    for (const char letter : std::string_view("XYZABC"))
      if (at_.words.has(letter) && (positioned & 1U << static_cast<unsigned>(letter - 'A')) == 0)
        return at_.error(
            at_.words.of(letter).offset, "not-supported",
            fmt::format("{} beside POS or POSA, which moves another axis at the same time, is not supported; a "
                        "block of its own was expected",
                        letter));
    const Motion modal = std::exchange(at_.motion, Motion::rapid);
    move();
    at_.motion = modal;
    return;
  }
  const bool axes = at_.words.has_any("XYZ") || at_.words.has(Extra::ap) || at_.words.has(Extra::rp);
  const bool arc = at_.motion == Motion::clockwise || at_.motion == Motion::counter_clockwise;
  const bool of_arc =
      at_.words.has_any("IJK") || at_.words.has(Extra::cr) || at_.words.has(Extra::ar) || at_.words.has(Extra::turn);
  if (arc && (axes || of_arc)) return move_on_arc();
  if (arc && mover_.turns()) {
    at_.error(at_.words.offset(), "arc", "a rotary axis alone under G2 or G3; G0 or G1 was expected");
    return;
  }
  if (at_.motion == Motion::through_point &&
      (axes || at_.words.has(Extra::i1) || at_.words.has(Extra::j1) || at_.words.has(Extra::k1)))
    return move_through_point();
  if (at_.motion == Motion::tangential && axes) return move_tangentially();
  if (axes || mover_.turns()) {
    if (of_arc && at_.motion <= Motion::linear && !at_.words.has(Extra::turn))
      at_.report.warning(at_.words.offset(), "unused-word", "I, J, K or CR in a block that is no arc is not used",
                         "unused centre");
    move_on_line();
  }
}

void PathBlocks::move_on_line() {
  modes_.check_unit();
  mover_.settle_axes_for("cutter radius compensation", !at_.radius.moves_path());
  const Vec3 end = target();
  if (at_.motion == Motion::rapid) {
    mover_.add_move(MoveKind::rapid, end);
  } else if (at_.motion == Motion::tapping_in || at_.motion == Motion::tapping_out) {
    mover_.prepare_cutting("G331");
    const char letter = kCentreLetters[at_.axes().normal];
    const double pitch = std::abs(at_.words.of(letter).value) * modes_.unit_mm();
    at_.editable = false;
    if (!(pitch > 0 && modes_.state().spindle_speed_rpm > 0)) {
      at_.error(at_.words.offset(), "feed-per-turn",
                fmt::format("G331 and G332 need a pitch ({}) and a spindle speed (S)", letter));
      return mover_.settle_axes();
    }
    Move& move = mover_.add_move(MoveKind::linear, end);
    move.feed_mm_per_s = pitch * modes_.state().spindle_speed_rpm / 60;
    move.canned = true;
    move.cycle = 84;
  } else {
    mover_.prepare_cutting("G1");
    const auto feed = modes_.cutting_feed((end - mover_.position_mm()).norm(), "G1");
    mover_.add_move(MoveKind::linear, end).feed_mm_per_s = feed.value_or(0);
  }
  mover_.settle_axes();
}

void PathBlocks::go_in_machine_frame() {
  if (!at_.words.has_any("XYZ") && !mover_.turns()) return;
  modes_.check_unit();
  if (at_.refuse_under_radius(at_.words.offset(), "machine coordinates")) return;
  if (at_.motion != Motion::rapid && at_.motion != Motion::linear)
    return at_.error(at_.words.offset(), "machine-frame",
                     "machine coordinates (SUPA, G53, G153) go with G0 or G1; another motion is active");
  Vec3 end = mover_.position_mm(), machine_mm = Vec3::Zero();
  std::uint8_t given = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Slot& slot = at_.words.of(kAxisLetters[axis]);
    if (!slot.given) continue;
    if (slot.dimension == Dimension::incremental) {
      at_.error(slot.offset, "machine-frame",
                "an increment in machine coordinates is not supported; an absolute one was expected");
      continue;
    }
    machine_mm[static_cast<Eigen::Index>(axis)] = slot.value * modes_.unit_mm();
    given = static_cast<std::uint8_t>(given | 1U << axis);
    mover_.settle_machine_axis(axis, machine_mm[static_cast<Eigen::Index>(axis)], end);
  }
  mover_.add_machine_target(machine_mm, given);
  std::optional<double> feed;
  at_.editable = false;
  if (at_.motion == Motion::linear) feed = modes_.cutting_feed((end - mover_.position_mm()).norm(), "G1");
  Move& move = mover_.add_move(at_.motion == Motion::linear ? MoveKind::linear : MoveKind::rapid, end);
  move.feed_mm_per_s = feed.value_or(0);
}

/// G74: reference point; G75: a fixed point of the machine. Where they are is not known here.
void PathBlocks::go_to_fixed_point() {
  Vec3 end = mover_.position_mm(), machine_mm = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  std::uint8_t given = 0;
  const bool g74 = std::ranges::any_of(at_.words.g, [](const CodeWord& c) { return c.number == 74; });
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!at_.words.has(kAxisLetters[axis])) continue;
    const auto i = static_cast<Eigen::Index>(axis);
    end[i] = 0;
    mover_.set_place(static_cast<int>(axis), AxisPlace::reference);
    given = static_cast<std::uint8_t>(given | 1U << axis);
    if (const auto& at = at_.options.reference_points_mm[0]; at && g74) {
      machine_mm[i] = (*at)[i];
      mover_.settle_machine_axis(axis, (*at)[i], end);
    }
  }
  if (given == 0) return;
  mover_.add_machine_target(machine_mm, given);
  at_.editable = false;
  Move& move = mover_.add_move(MoveKind::rapid, end);
  if (g74) move.reference_axes = static_cast<std::uint8_t>(given & 7U);
}

bool PathBlocks::arc_error(const ArcResult& result, const ArcWords& arc) {
  const std::size_t at = at_.motion_offset();
  if (!result.error.empty()) {
    at_.error(at, "arc", in_own_words(result.error));
    return true;
  }
  if (result.radius_difference_mm < kArcRadiusWarningMm) return false;
  // CIRCLE_ERROR_FACTOR: the control accepts a thousandth of the radius.
  const double most = std::max(kArcRadiusErrorMm, 1e-3 * result.start_radius_mm);
  std::string message = fmt::format("the radius of the arc is {:.4f} mm at its start and {:.4f} mm at its end",
                                    result.start_radius_mm, result.end_radius_mm);
  if (result.radius_difference_mm < most) {
    at_.report.warning(at, "arc-radius",
                       message + fmt::format("; a difference below {:.3f} mm was expected", kArcRadiusWarningMm),
                       "arc-radius");
    return false;
  }
  message += fmt::format("; a difference below {:.2f} mm was expected", most);
  const auto fits = [&](const ArcWords& other) {
    const ArcResult found = make_arc(other);
    return found.error.empty() && found.radius_difference_mm < kArcRadiusWarningMm;
  };
  // Centres as the block has them, counted in other ways.
  ArcWords turned = arc, absolute = arc;
  const double start[3] = {arc.start_mm.x(), arc.start_mm.y(), arc.start_mm.z()};
  std::optional<double>* const of_turned[3] = {&turned.i_mm, &turned.j_mm, &turned.k_mm};
  std::optional<double>* const of_absolute[3] = {&absolute.i_mm, &absolute.j_mm, &absolute.k_mm};
  for (int i = 0; i < 3; ++i) {
    if (*of_turned[i]) **of_turned[i] = 2 * start[i] - **of_turned[i];
    if (*of_absolute[i]) **of_absolute[i] -= start[i];
  }
  if (fits(turned))
    message += " (with the signs of I, J, K turned over it would fit: they lead from the start to the centre)";
  else if (fits(absolute))
    message += " (with an absolute centre, I=AC(...), it would fit)";
  at_.error(at, "arc-radius", std::move(message));
  return true;
}

void PathBlocks::move_on_arc() {
  modes_.check_unit();
  ArcWords arc;
  arc.plane = at_.plane;
  arc.clockwise = at_.motion == Motion::clockwise;
  arc.absolute_centre = true;
  const char* g = arc.clockwise ? "G2" : "G3";
  mover_.settle_axes_for("an arc", false);
  mover_.prepare_cutting(g, true);
  if (mover_.leaving()) {
    at_.error(
        at_.words.offset(), "cutter-radius",
        fmt::format("the move off the contour after G40 is an arc ({}); a straight move (G0, G1) was expected", g));
    mover_.leave_no_more();
  }
  const PlaneAxes axes = at_.axes();
  arc.start_mm = mover_.programmed();
  const bool polar = at_.words.has(Extra::ap) || at_.words.has(Extra::rp);
  Vec3 end = target_in_program();
  // The centre: of I J K, each from the start or absolute; those of the plane that are missing are that of the start.
  const bool centre = at_.words.has_any("IJK") || (polar && !at_.words.has(Extra::cr) && !at_.words.has(Extra::ar));
  std::optional<double>* const of_arc[3] = {&arc.i_mm, &arc.j_mm, &arc.k_mm};
  int absolute_words = 0, relative_words = 0;
  if (centre) {
    for (const int axis : {axes.first, axes.second}) {
      const Slot& slot = at_.words.of(kCentreLetters[axis]);
      const double start = arc.start_mm[axis];
      if (polar && !at_.words.has_any("IJK")) {
        *of_arc[axis] = pole_mm_[axis];
        continue;
      }
      *of_arc[axis] =
          slot.dimension == Dimension::absolute ? slot.value * modes_.unit_mm() : start + slot.value * modes_.unit_mm();
      if (slot.given) ++(slot.dimension == Dimension::absolute ? absolute_words : relative_words);
    }
    const Slot& across = at_.words.of(kCentreLetters[axes.normal]);
    if (across.given && across.value != 0)
      at_.error(across.offset, "arc",
                fmt::format("{} does not belong to an arc in this plane; {} and {} were expected",
                            kCentreLetters[axes.normal], kCentreLetters[std::min(axes.first, axes.second)],
                            kCentreLetters[std::max(axes.first, axes.second)]));
    if (absolute_words == 1) at_.editable = false;
  }
  if (at_.words.has(Extra::cr)) arc.r_mm = at_.words.of(Extra::cr).value * modes_.unit_mm();
  if (centre && arc.r_mm) {
    at_.error(at_.words.of(Extra::cr).offset, "arc",
              "the arc has both CR and a centre (I, J, K); one of them was expected");
    arc.r_mm.reset();
  }
  if (at_.words.has(Extra::ar)) {  // the opening angle, with the centre or with the end point
    at_.editable = false;
    at_.relied_ends.add(at_.out.moves);
    const Slot& ar = at_.words.of(Extra::ar);
    const double angle = ar.value;
    if (!(angle > 0 && angle < 360)) {
      at_.error(ar.offset, "arc",
                fmt::format("an opening angle AR={:g}; more than 0 and less than 360 degrees was expected", angle));
      return mover_.settle_axes();
    }
    const bool has_end = at_.words.has(kAxisLetters[axes.first]) || at_.words.has(kAxisLetters[axes.second]) || polar;
    if (centre && !has_end) {
      const Eigen::Matrix3d turn = rotation_in(at_.plane, rad_from_deg(arc.clockwise ? -angle : angle));
      Vec3 middle = Vec3::Zero(), out = Vec3::Zero();
      for (const int axis : {axes.first, axes.second}) {
        middle[axis] = **of_arc[axis];
        out[axis] = arc.start_mm[axis] - middle[axis];
      }
      out = turn * out;
      for (const int axis : {axes.first, axes.second}) end[axis] = middle[axis] + out[axis];
    } else if (!centre) {
      const double chord =
          std::hypot(end[axes.first] - arc.start_mm[axes.first], end[axes.second] - arc.start_mm[axes.second]);
      const double radius = 0.5 * chord / std::sin(rad_from_deg(angle / 2));
      arc.r_mm = angle > 180 ? -radius : radius;
    }
  }
  if (at_.words.has(Extra::turn)) {
    const Slot& turn = at_.words.of(Extra::turn);
    const double turns = std::trunc(turn.value);
    if (turns != turn.value)
      at_.report.warning(turn.offset, "arc-turns",
                         fmt::format("TURN={:g} is no whole number; {:g} full turns are taken", turn.value, turns));
    if (!(turns >= 0 && turns <= 999))
      at_.error(turn.offset, "arc-turns", fmt::format("TURN={:g} turns; 0 to 999 was expected", turn.value));
    else
      arc.turns = static_cast<int>(turns) + 1;
  }
  arc.end_mm = end;
  make_arc_move(arc, frames_.frame().from_program(end), g);
}

/// `arc` in program coordinates.
void PathBlocks::make_arc_move(const ArcWords& words, const Vec3& end_in_frame, const char* g) {
  ArcWords arc = words;
  Vec3 end_mm = frames_.frame().plain ? arc.end_mm : end_in_frame;
  if (frames_.frame().shift_only && !at_.words.uses_extras())
    for (int axis = 0; axis < 3; ++axis)
      if (!at_.words.has(kAxisLetters[axis])) end_mm[axis] = mover_.position_mm()[axis];
  const ArcResult result = make_arc(arc);
  if (result.is_point) {
    const auto feed = modes_.cutting_feed((end_mm - mover_.position_mm()).norm(), g);
    Move& move = mover_.add_move(MoveKind::linear, end_mm);
    move.feed_mm_per_s = feed.value_or(0);
    move.editable = false;
    return mover_.settle_axes();
  }
  const auto in_moves =
      frames_.frame().plain || !result.error.empty() ? result.arc : from_program(frames_.frame(), result.arc);
  if (!in_moves) at_.refuse_ellipse();
  if (arc_error(result, arc) || !in_moves) {
    mover_.stand_at(end_mm);
    return mover_.settle_axes();
  }
  at_.out.arcs.push_back(*in_moves);
  Move& move = mover_.add_move(MoveKind::arc, end_mm);
  move.arc = static_cast<std::uint32_t>(at_.out.arcs.size() - 1);
  if (!at_.words.has(Extra::cr)) at_.out.arcs.back().by_radius = false;
  mover_.settle_axes();
  move.feed_mm_per_s = modes_.cutting_feed(length_mm(at_.out, move), g).value_or(0);
}

/// CIP: through I1 J1 K1 to the end; anywhere in space.
void PathBlocks::move_through_point() {
  modes_.check_unit();
  mover_.settle_axes_for("an arc", false);
  mover_.prepare_cutting("CIP", true);
  at_.editable = false;
  const Vec3 start = mover_.programmed(), end = target_in_program();
  Vec3 via = start;
  const Extra extras[3] = {Extra::i1, Extra::j1, Extra::k1};
  for (int axis = 0; axis < 3; ++axis)
    if (const Slot& slot = at_.words.of(extras[axis]); slot.given)
      via[axis] = modes_.axis_value(slot, start[axis], modes_.unit_mm());
  const Vec3 end_mm = frames_.frame().from_program(end);
  const auto fail = [&](std::string message) {
    at_.error(at_.motion_offset(), "arc", std::move(message));
    mover_.stand_at(end_mm);
    mover_.settle_axes();
  };
  const Vec3 a = via - start, b = end - start;
  const Vec3 cross = a.cross(b);
  if (b.norm() < 1e-6 || a.norm() < 1e-6 || (via - end).norm() < 1e-6)
    return fail(
        "CIP needs three places that differ; the point on the arc (I1, J1, K1) or the end is one of the others");
  if (cross.norm() < 1e-9 * a.norm() * b.norm())
    return fail("the three points of CIP lie on a line; an arc was expected");
  const Vec3 normal = cross.normalized();
  const Vec3 to_centre = Vec3(a.squaredNorm() * b - b.squaredNorm() * a).cross(cross) / (2 * cross.squaredNorm());
  Arc arc;
  arc.center_mm = start + to_centre;
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const double sign = normal[axis] < 0 ? -1.0 : 1.0;
  arc.normal = sign * normal;
  if (1 - std::abs(normal[axis]) < 1e-12) arc.normal = Vec3::Unit(axis);
  const Vec3 from = start - arc.center_mm, to = end - arc.center_mm;
  double sweep = std::atan2(from.cross(to).dot(normal), from.dot(to));
  if (sweep <= 0) sweep += 2 * kPi;
  arc.sweep_rad = sign * sweep;
  const auto in_moves = frames_.frame().plain ? arc : from_program(frames_.frame(), arc);
  if (!in_moves)
    return fail(
        "an arc under a scale that differs along its two axes would be an ellipse; one scale for both was expected");
  at_.out.arcs.push_back(*in_moves);
  Move& move = mover_.add_move(MoveKind::arc, end_mm);
  move.arc = static_cast<std::uint32_t>(at_.out.arcs.size() - 1);
  mover_.settle_axes();
  move.feed_mm_per_s = modes_.cutting_feed(length_mm(at_.out, move), "CIP").value_or(0);
}

/// CT: an arc in the plane that leaves in the direction in which the last move ended.
void PathBlocks::move_tangentially() {
  modes_.check_unit();
  mover_.settle_axes_for("an arc", false);
  mover_.prepare_cutting("CT", true);
  at_.editable = false;
  at_.relied_ends.add_direction(at_.out.moves);
  const PlaneAxes axes = at_.axes();
  const Vec3 start = mover_.programmed(), end = target_in_program(), end_mm = frames_.frame().from_program(end);
  const auto direction = mover_.last_direction();
  Vec3 along = direction.value_or(Vec3(Vec3::Zero()));
  along[axes.normal] = 0;
  if (along.norm() < 1e-9) {
    at_.error(at_.words.offset(), "arc",
              "CT continues the last move, which has no direction in the plane; a move in it was expected before");
    mover_.stand_at(end_mm);
    return mover_.settle_axes();
  }
  along.normalize();
  Vec3 chord = end - start;
  chord[axes.normal] = 0;
  const Vec3 left = normal_of(at_.plane).cross(along);
  const double across = chord.dot(left), length = chord.norm();
  if (std::abs(across) < 1e-9 * std::max(length, 1.0)) {  // straight on
    if (chord.dot(along) <= 0) {
      at_.error(at_.words.offset(), "arc",
                "CT would have to turn back on itself; an end beside the direction of the last move was expected");
      mover_.stand_at(end_mm);
      return mover_.settle_axes();
    }
    const auto feed = modes_.cutting_feed((end_mm - mover_.position_mm()).norm(), "CT");
    mover_.add_move(MoveKind::linear, end_mm).feed_mm_per_s = feed.value_or(0);
    return mover_.settle_axes();
  }
  const double radius = length * length / (2 * across);  // positive: the centre is on the left
  ArcWords arc;
  arc.plane = at_.plane;
  arc.clockwise = radius < 0;
  arc.absolute_centre = true;
  arc.start_mm = start;
  arc.end_mm = end;
  const Vec3 centre = start + radius * left;
  std::optional<double>* const of_arc[3] = {&arc.i_mm, &arc.j_mm, &arc.k_mm};
  for (const int axis : {axes.first, axes.second}) *of_arc[axis] = centre[axis];
  make_arc_move(arc, end_mm, "CT");
}

}  // namespace camber::nc::siemens
