// Lines, arcs, poles; machine coordinates.
#include "nc/heidenhain/klartext_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "base/units.h"

namespace camber::nc::heidenhain {

constexpr double kFullTurn_rad = 2 * kPi;

/// PR and PA about the pole; what is not given stays.
Vec3 PathBlocks::polar_target(const BlockValues& b) {
  if (!pole_given_)
    throw FormulaError(at_.statement->begin, "pole", "a polar coordinate without a pole; CC was expected before");
  const PlaneAxes axes = axes_of(pole_plane_);
  Vec3 end = mover_.target(b);
  const Vec3 now = mover_.programmed();
  const double x = now[axes.first] - pole_mm_[axes.first], y = now[axes.second] - pole_mm_[axes.second];
  double radius = std::hypot(x, y), angle = deg_from_rad(std::atan2(y, x));
  const bool from_here = !b.polar.radius || !b.polar.angle || b.polar.radius_step || b.polar.angle_step;
  if (from_here) at_.relied_ends.add(at_.out.moves);
  if (b.polar.radius)
    radius = b.polar.radius_step ? radius + *b.polar.radius * at_.unit_mm() : *b.polar.radius * at_.unit_mm();
  if (b.polar.angle) angle = b.polar.angle_step ? angle + *b.polar.angle : *b.polar.angle;
  const Vec2 direction = direction_at_deg(angle);
  end[axes.first] = pole_mm_[axes.first] + radius * direction.x();
  end[axes.second] = pole_mm_[axes.second] + radius * direction.y();
  return end;
}

/// CC: X and Y, or the axes of another plane; an axis that is not given stays; none at all: where the tool stands.
void PathBlocks::set_centre(const BlockValues& b) {
  const std::uint8_t given = b.given_axes();
  const Vec3 now = mover_.programmed();
  const auto main_plane = tools_.plane();
  if (given == 3)
    pole_plane_ = Plane::xy;
  else if (given == 6)
    pole_plane_ = Plane::yz;
  else if (given == 5)
    pole_plane_ = Plane::zx;
  else if (!pole_given_ || given == 0 || given == 7)
    pole_plane_ = main_plane;
  else if ((given & (1U << axes_of(pole_plane_).normal)) != 0)
    pole_plane_ = (given & (1U << axes_of(main_plane).normal)) == 0 ? main_plane : pole_plane_;
  if (given == 0 || !pole_given_) pole_mm_ = now;
  pole_from_here_ = given == 0 || (b.step & given) != 0;
  if (pole_from_here_) at_.relied_ends.add(at_.out.moves);
  for (int axis = 0; axis < 3; ++axis) {
    const auto& value = b.axis[static_cast<std::size_t>(axis)];
    if (!value) continue;
    const double mm = *value * at_.unit_mm();
    pole_mm_[axis] = (b.step & (1U << axis)) != 0 ? now[axis] + mm : mm;
  }
  pole_given_ = true;
}

int PathBlocks::sense_of(const BlockValues& b) {
  if (b.sense) return last_sense_ = *b.sense;
  if (last_sense_ == 0) {
    at_.error(at_.statement->begin, "arc", "an arc without DR; DR+ or DR- was expected");
    last_sense_ = 1;
  }
  return last_sense_;
}

void PathBlocks::run_line(const BlockValues& b) {
  if (b.has(91) || b.has(92))
    go_in_machine_frame(b);
  else if (b.has(130) && frames_.tilted())
    run_untilted(b);
  else
    run_programmed_line(b);
}

void PathBlocks::run_programmed_line(const BlockValues& b) {
  const bool directed = b.tool[0] || b.tool[1] || b.tool[2];
  if (!b.moves()) {
    if (b.turns() || directed) orientation_.turn_only(b);
    return;
  }
  mover_.line_to(mover_.target(b), b.given_axes(), b);
  const std::size_t move = at_.out.moves.size() - 1;
  if (directed) {
    const Vec3 direction(b.tool[0].value_or(0), b.tool[1].value_or(0), b.tool[2].value_or(0));
    if (direction.norm() < 1e-6)
      at_.error(at_.statement->begin, "tool-direction", "TX TY TZ are all zero; a direction was expected");
    else
      orientation_.direction_target(direction.normalized(), move);
  } else if (b.turns()) {
    orientation_.add_rotary(b, move);
  }
}

/// M91, M92: machine coordinates.
void PathBlocks::go_in_machine_frame(const BlockValues& b) {
  if (!b.moves()) {
    if (b.turns()) orientation_.turn_only(b);
    return;
  }
  Vec3 end = mover_.position_mm(), machine_mm = Vec3::Zero();
  std::uint8_t given = 0;
  const auto origin = frames_.offsets().machine_origin_mm(54);
  const bool known = origin && b.has(91) && frames_.frame().shift_only;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& value = b.axis[static_cast<std::size_t>(axis)];
    if (!value) continue;
    machine_mm[axis] = *value * at_.unit_mm();
    given = static_cast<std::uint8_t>(given | 1U << axis);
    const bool here = known && axis != tools_.axis();  // the height needs the tool's length
    mover_.set_place(axis, here ? Mover::Place::known : Mover::Place::machine);
    end[axis] = here ? (*origin)[axis] + machine_mm[axis] : 0;
  }
  if (at_.has_rotary_axes()) {
    if (b.has(92)) machine_mm = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    at_.out.machine_targets.push_back({machine_mm, static_cast<std::uint32_t>(at_.out.moves.size()), given});
  }
  const double feed = b.feed.rapid ? 0 : modes_.cutting_feed("L");
  Move& move = mover_.add_move(b.feed.rapid ? MoveKind::rapid : MoveKind::linear, end);
  move.feed_mm_per_s = feed;
  move.editable = false;
  if (b.turns()) orientation_.add_rotary(b, at_.out.moves.size() - 1);
}

/// M130: coordinates of the untilted system, for this block.
void PathBlocks::run_untilted(const BlockValues& b) {
  if (!at_.has_rotary_axes()) return go_in_machine_frame(b);
  const WorkPlane plane = frames_.change_plane({});
  const WorkFrame work_frame = std::exchange(modes_.change().work_frame, WorkFrame::machine);
  run_programmed_line(b);
  modes_.change().work_frame = work_frame;
  mover_.set_open({7, true});
  frames_.change_plane(plane);
}

/// M140 MB: off along the tool axis by so much, or to the end of the travel (MAX); at the F of its block, else rapid.
void PathBlocks::retract(const BlockValues::Function& f, const BlockValues& b) {
  if (!f.argument) {
    at_.error(f.offset, "retract", "M140 without MB; MB MAX or MB with a length was expected");
    return;
  }
  Vec3 end = mover_.position_mm();
  const bool as_far_as_possible = std::isinf(*f.argument);
  if (as_far_as_possible) {
    mover_.set_place(tools_.axis(), Mover::Place::machine);
    end[tools_.axis()] = 0;
    if (at_.has_rotary_axes()) {
      const auto bit = static_cast<std::uint8_t>(1U << tools_.axis());
      at_.out.machine_targets.push_back({Vec3::Constant(std::numeric_limits<double>::quiet_NaN()),
                                         static_cast<std::uint32_t>(at_.out.moves.size()), bit});
    }
  } else {
    Vec3 up = Vec3::Zero();
    up[tools_.axis()] = *f.argument * at_.unit_mm();
    up = frames_.frame().linear * up;
    if (modes_.state().tip_control != TipControl::off && orientation_.turned()) {
      // Along the tool, where a vector gives it; by angles only the machine knows where that is.
      const auto direction = orientation_.direction();
      up = direction ? Vec3(up.norm() * *direction) : Vec3(Vec3::Zero());
      if (!direction) mover_.set_open({7, mover_.open().start});
    }
    end = mover_.position_mm() + up;
  }
  const double feed = b.feed.value && !b.feed.rapid ? modes_.cutting_feed("M140") : 0;
  Move& move = mover_.add_move(feed > 0 ? MoveKind::linear : MoveKind::rapid, end);
  move.feed_mm_per_s = feed;
  move.editable = false;
}

void PathBlocks::run_circle(const BlockValues& b) {
  if (!pole_given_)
    throw FormulaError(at_.statement->begin, "pole", "C without a circle centre; CC was expected before");
  if (pole_from_here_) at_.editable = false;
  ArcWords words;
  words.start_mm = mover_.programmed();
  words.end_mm = mover_.target(b);
  words.plane = pole_plane_;
  words.clockwise = sense_of(b) < 0;
  words.absolute_centre = true;
  const PlaneAxes axes = axes_of(pole_plane_);
  for (const int axis : {axes.first, axes.second})
    (axis == 0 ? words.i_mm : axis == 1 ? words.j_mm : words.k_mm) = pole_mm_[axis];
  mover_.make_arc_of(words, b);
}

void PathBlocks::run_radius_arc(const BlockValues& b) {
  if (!b.radius || *b.radius == 0) {
    at_.error(at_.statement->begin, "arc", "CR without a radius; R was expected");
    return;
  }
  ArcWords words;
  words.start_mm = mover_.programmed();
  words.end_mm = mover_.target(b);
  const Vec3 way = words.end_mm - words.start_mm;
  words.plane = tools_.plane();
  // A circle in another plane: its end is given in the axes of that plane.
  const std::uint8_t given = b.given_axes();
  if (tools_.axis() == 2 && (given & 4U) != 0 && (given & 3U) != 3U && way.z() != 0)
    words.plane = (given & 1U) != 0 ? Plane::zx : (given & 2U) != 0 ? Plane::yz : words.plane;
  words.clockwise = sense_of(b) < 0;
  words.r_mm = *b.radius * at_.unit_mm();
  mover_.make_arc_of(words, b);
}

/// An arc that goes on along the last move.
void PathBlocks::run_tangent_arc(const BlockValues& b, const Vec3& end) {
  const PlaneAxes axes = tools_.axes();
  const Vec3 start = mover_.programmed(), along = mover_.last_direction();
  if (along == Vec3::Zero()) {
    at_.error(at_.statement->begin, "arc", "CT without a move before it that gives its direction");
    return;
  }
  const Vec2 d(along[axes.first], along[axes.second]);
  const Vec2 chord(end[axes.first] - start[axes.first], end[axes.second] - start[axes.second]);
  const double across = d.x() * chord.y() - d.y() * chord.x();
  at_.editable = false;
  at_.relied_ends.add_direction(at_.out.moves);
  if (std::abs(across) < 1e-9 * std::max(1.0, chord.norm())) {
    if (chord.dot(d) < 0 || chord.norm() == 0)
      return at_.error(at_.statement->begin, "arc",
                       "CT ends behind its start on the line that it is tangent to; no arc leads there");
    return mover_.line_to(end, 7, b);
  }
  const double radius = chord.squaredNorm() / (2 * across);  // positive: the centre is on the left
  Arc arc;
  arc.normal = normal_of(tools_.plane());
  arc.center_mm = start;
  arc.center_mm[axes.first] += -d.y() * radius;
  arc.center_mm[axes.second] += d.x() * radius;
  const double turn = 2 * std::atan2(std::abs(across), chord.dot(d));
  arc.sweep_rad = radius > 0 ? turn : -turn;
  const auto given = b.absolute_axes();
  mover_.prepare_cutting("CT", given);
  mover_.arc_to(end, arc, b, false);
  mover_.settle(given);
}

/// CP: about the pole, at the radius of where the tool stands; IPA may be more than a turn, Z makes it a helix.
void PathBlocks::run_polar_circle(const BlockValues& b) {
  if (!pole_given_) throw FormulaError(at_.statement->begin, "pole", "CP without a pole; CC was expected before");
  const PlaneAxes axes = axes_of(pole_plane_);
  const Vec3 start = mover_.programmed();
  Vec3 end = mover_.target(b);
  const double x = start[axes.first] - pole_mm_[axes.first], y = start[axes.second] - pole_mm_[axes.second];
  const double radius = std::hypot(x, y);
  if (radius < 1e-9) {
    at_.error(at_.statement->begin, "arc", "CP from its pole; a start beside CC was expected");
    return;
  }
  const int sense = b.sense || !b.polar.angle_step ? sense_of(b) : (*b.polar.angle < 0 ? -1 : 1);
  if (b.polar.angle_step && sense * *b.polar.angle < 0 && std::fmod(*b.polar.angle, 360.0) != 0)
    at_.warn(
        at_.statement->begin, "arc-sense",
        "IPA and DR have different signs; the arc is read with the size of IPA in the sense of DR; the same sign was "
        "expected",
        "IPA");
  double sweep = 0;
  at_.editable = false;
  at_.relied_ends.add(at_.out.moves);  // it gives the radius
  if (b.polar.angle && b.polar.angle_step) {
    sweep = sense * rad_from_deg(std::abs(*b.polar.angle));
    const double degrees = std::fmod(std::abs(*b.polar.angle), 360.0);
    const double c = direction_at_deg(sense * degrees).x(), s = direction_at_deg(sense * degrees).y();
    end[axes.first] = pole_mm_[axes.first] + c * x - s * y;
    end[axes.second] = pole_mm_[axes.second] + s * x + c * y;
    if (degrees == 0)
      for (const int axis : {axes.first, axes.second}) end[axis] = start[axis];
  } else if (b.polar.angle) {
    const Vec2 direction = direction_at_deg(*b.polar.angle);
    end[axes.first] = pole_mm_[axes.first] + radius * direction.x();
    end[axes.second] = pole_mm_[axes.second] + radius * direction.y();
    double turn = rad_from_deg(*b.polar.angle) - std::atan2(y, x);
    constexpr double kSameAngle = 1e-9;
    while (sense * turn <= kSameAngle) turn += sense * kFullTurn_rad;
    while (sense * turn > kFullTurn_rad + kSameAngle) turn -= sense * kFullTurn_rad;
    sweep = turn;
  } else {
    sweep = sense * kFullTurn_rad;
    for (const int axis : {axes.first, axes.second}) end[axis] = start[axis];
  }
  if (sweep == 0) return mover_.line_to(end, b.given_axes(), b);
  if (std::abs(sweep) > kFullTurn_rad * 1e5) {
    at_.error(at_.statement->begin, "arc-turns", "more than 100000 turns in one block");
    return;
  }
  Arc arc;
  arc.normal = normal_of(pole_plane_);
  arc.center_mm = pole_mm_;
  arc.center_mm[axes.normal] = start[axes.normal];
  arc.sweep_rad = sweep;
  const auto given = b.absolute_axes();
  mover_.prepare_cutting("CP", given);
  mover_.arc_to(end, arc, b, false);
  mover_.settle(static_cast<std::uint8_t>(given | 1U << axes.first | 1U << axes.second));
}

}  // namespace camber::nc::heidenhain
