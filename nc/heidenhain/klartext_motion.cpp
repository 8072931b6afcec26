// Moves from where the tool stands, and radius compensation.
#include "nc/heidenhain/klartext_motion.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/cutter_radius.h"

namespace camber::nc::heidenhain {

Mover::Mover(StatementContext& at, Modes& modes, Tools& tools, DatumFrames& frames)
    : at_(at), modes_(modes), tools_(tools), frames_(frames), open_{0, at.has_rotary_axes()} {}

void Mover::leave_from(const Vec3& beside_mm) {
  beside_mm_ = beside_mm;
  leaving_ = beside_mm != Vec3::Zero();
}

/// The end of the block in programmed coordinates.
Vec3 Mover::target(const BlockValues& b) const {
  Vec3 end = programmed();
  for (int axis = 0; axis < 3; ++axis) {
    const auto& value = b.axis[static_cast<std::size_t>(axis)];
    if (!value) continue;
    const double mm = *value * at_.unit_mm();
    end[axis] = (b.step & (1U << axis)) != 0 ? end[axis] + mm : mm;
  }
  return end;
}

/// Returns the end in the frame of the moves. Axes that no word moves keep their place to the last bit.
Vec3 Mover::end_in_moves(const Vec3& programmed_end, std::uint8_t given) const {
  if (frames_.frame().plain) return programmed_end;
  Vec3 end = frames_.frame().from_program(programmed_end);
  if (frames_.frame().shift_only)
    for (int axis = 0; axis < 3; ++axis)
      if ((given & (1U << axis)) == 0) end[axis] = position_mm_[axis];
  return end;
}

Move& Mover::add_move(MoveKind kind, const Vec3& end_mm, std::uint8_t absolute) {
  Move move;
  move.start_mm = position_mm_;
  move.end_mm = end_mm;
  move.block = at_.block;
  move.state = modes_.state_index();
  move.kind = kind;
  move.editable = at_.editable;
  modes_.give_feed_to(move);
  move.reference = kind != MoveKind::dwell && std::ranges::any_of(place_, [](Place p) { return p != Place::known; });
  move.reference |= kind == MoveKind::rapid && carried_over_ != 0;
  if (kind == MoveKind::linear || kind == MoveKind::arc) frames_.note_cut_plane();
  if (leaving_ && kind != MoveKind::dwell) {
    move.start_mm += beside_mm_;
    move.editable = leaving_ = false;
  }
  if (at_.has_rotary_axes() && kind != MoveKind::dwell) {
    std::uint8_t open = open_.axes;
    for (unsigned axis = 0; axis < 3; ++axis)
      if (place_[axis] != Place::known) open = static_cast<std::uint8_t>(open | 1U << axis);
    move.open_axes = open & ~absolute & 7U;
    move.start_open = open_.start;
    const auto& targets = at_.out.machine_targets;
    open_.start = move.open_axes != 0 || (!targets.empty() && targets.back().move == at_.out.moves.size());
    if (!at_.out.machine_origin_mm) at_.out.machine_origin_mm = frames_.offsets().machine_origin_mm(54);
  }
  position_mm_ = end_mm;
  at_.out.moves.push_back(move);
  return at_.out.moves.back();
}

/// Absolute words put axes in the frame.
void Mover::settle(std::uint8_t given) {
  for (unsigned axis = 0; axis < 3; ++axis)
    if ((given & (1U << axis)) != 0) place_[axis] = Place::known;
  open_.axes = static_cast<std::uint8_t>(open_.axes & ~given);
  carried_over_ = static_cast<std::uint8_t>(carried_over_ & ~given);
}

/// A cutting move needs a place to start from: axes that were never programmed are taken to stand at zero.
void Mover::prepare_cutting(const char* what, std::uint8_t given) {
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (place_[axis] == Place::known) continue;
    const char letter = "XYZ"[axis];
    const bool placed = (given & (1U << axis)) != 0;
    if (placed) {
      if (place_[axis] == Place::never)
        at_.warn(at_.statement->begin, "start-unknown",
                 fmt::format(
                     "{} to {} from a place that the program has not given; the move is ignored for material removal",
                     what, letter),
                 "from nowhere");
    } else if (place_[axis] == Place::never) {
      at_.warn(at_.statement->begin, "start-unknown",
               fmt::format("{} before {} was programmed; the tool is assumed to be at {}0", what, letter, letter));
      place_[axis] = Place::known;
    } else {
      at_.warn(at_.statement->begin, "at-reference",
               fmt::format("{} while {} is at a machine coordinate; the move is ignored for material removal", what,
                           letter));
    }
  }
}

void Mover::line_to(const Vec3& programmed_end, std::uint8_t given, const BlockValues& b) {
  const Vec3 end = end_in_moves(programmed_end, given);
  const auto absolute = static_cast<std::uint8_t>(given & ~b.step);
  if (b.feed.rapid) {
    add_move(MoveKind::rapid, end, absolute);
  } else {
    prepare_cutting("L", absolute);
    const double feed = modes_.cutting_feed("L");
    const Vec3 way = programmed_end - programmed();
    add_move(MoveKind::linear, end, absolute).feed_mm_per_s =
        modes_.limits_plunging() && way.norm() > 0 ? modes_.plunging_feed(feed, way, tools_.axis()) : feed;
    if (modes_.limits_plunging()) at_.out.moves.back().editable = false;
  }
  settle(absolute);
}

/// Along the end of the last move, in programmed coordinates, in the plane; zero where there is none.
Vec3 Mover::last_direction() const {
  for (std::size_t i = at_.out.moves.size(); i-- > 0;) {
    const Move& move = at_.out.moves[i];
    if (move.kind == MoveKind::dwell || (move.kind != MoveKind::arc && move.start_mm == move.end_mm)) continue;
    Vec3 direction = frames_.frame().inverse * direction_at(at_.out, move, 1.0);
    direction[tools_.axes().normal] = 0;
    return direction.norm() > 1e-12 ? Vec3(direction.normalized()) : Vec3(Vec3::Zero());
  }
  return Vec3::Zero();
}

/// `arc`: programmed.
void Mover::arc_to(const Vec3& programmed_end, const Arc& arc, const BlockValues& b, bool by_radius) {
  std::optional<Arc> in_moves = frames_.frame().plain ? std::optional(arc) : from_program(frames_.frame(), arc);
  if (!in_moves) {
    at_.error(
        at_.statement->begin, "scaling",
        "an arc under a scale that differs along its two axes would be an ellipse; one scale for both was expected");
    position_mm_ = end_in_moves(programmed_end, 7);
    return;
  }
  in_moves->by_radius = by_radius;
  const Vec3 end = end_in_moves(programmed_end, b.given_axes() | 7U);
  at_.out.arcs.push_back(*in_moves);
  const double feed = modes_.cutting_feed("an arc");
  if (b.feed.rapid && feed > 0)
    at_.warn(at_.statement->begin, "arc-at-rapid", "an arc with FMAX is read with the F before it", "FMAX");
  Move& move = add_move(MoveKind::arc, end);
  move.arc = static_cast<std::uint32_t>(at_.out.arcs.size() - 1);
  move.feed_mm_per_s = feed;
}

void Mover::make_arc_of(ArcWords words, const BlockValues& b) {
  const auto given = b.absolute_axes();
  prepare_cutting("an arc", given);
  const bool by_radius = words.r_mm.has_value();
  const ArcResult result = make_arc(words);
  if (result.is_point) {
    if (result.start_radius_mm == 0)
      at_.warn(at_.statement->begin, "arc-radius",
               "a circle from its own centre is no circle; a start beside CC was expected", "arc-point");
    line_to(words.end_mm, b.given_axes(), b);
    at_.out.moves.back().editable = false;
    return;
  }
  std::string message = result.error;
  if (message.empty() && result.radius_difference_mm >= kArcRadiusWarningMm) {
    message = fmt::format(
        "the radius of the arc is {:.4f} mm at its start and {:.4f} mm at its end; a difference below "
        "{} mm was expected",
        result.start_radius_mm, result.end_radius_mm,
        result.radius_difference_mm < kArcRadiusErrorMm ? kArcRadiusWarningMm : kArcRadiusErrorMm);
    if (result.radius_difference_mm < kArcRadiusErrorMm) {
      at_.warn(at_.statement->begin, "arc-radius", message, "arc-radius");
      message.clear();
    }
  }
  if (!message.empty()) {
    at_.error(at_.statement->begin, result.error.empty() ? "arc-radius" : "arc", message);
    position_mm_ = end_in_moves(words.end_mm, 7);
    settle(given);
    return;
  }
  arc_to(words.end_mm, result.arc, b, by_radius);
  settle(given);
}

// --- RL, RR, R0

void RadiusCompensation::set(int code, std::size_t offset) {
  last_ = code == 0 ? last_ : code;
  if (code == 0) return end();
  if (code > 2) {
    at_.warn(offset, "no-effect", "R+ and R- (compensation of one axis) are read without effect", "R+");
    return;
  }
  const bool left = code == 1;
  if (radius_.active) {
    if (radius_.left != left)
      at_.error(offset, "cutter-radius",
                fmt::format("{} while {} is active; R0 was expected before", left ? "RL" : "RR", left ? "RR" : "RL"));
    return;
  }
  const auto radius = tools_.radius_mm();
  if (!radius)
    at_.warn(offset, "radius-unknown",
             fmt::format("no radius is given for tool {}; {} takes 0, as in a program of the cutter centre",
                         modes_.state().tool, left ? "RL" : "RR"),
             fmt::format("radius {}", modes_.state().tool));
  radius_ = {true, left, radius.value_or(0), at_.out.moves.size(), offset, tools_.plane()};
  modes_.change().cutter_radius = radius.value_or(0) != 0;
  if (!modes_.state().cutter_radius || not_editable_told_) return;
  not_editable_told_ = true;
  at_.warn(offset, "not-editable",
           fmt::format(
               "the path under {} is computed here, cutter radius {:.4f} mm; compensation leaves these moves unchanged",
               left ? "RL" : "RR", std::abs(*radius)));
}

void RadiusCompensation::end() {
  if (!radius_.active) return;
  const Radius radius = std::exchange(radius_, {});
  modes_.change().cutter_radius = false;
  if (radius.radius_mm == 0 || radius.first_move >= at_.out.moves.size()) return;
  const PlaneAxes axes = axes_of(radius.plane);
  const Frame& frame = at_.out.frame_of(at_.out.moves[radius.first_move]);
  const Vec3 a = frame.linear.col(axes.first), b = frame.linear.col(axes.second);
  const double facing = a[axes.first] * b[axes.second] - a[axes.second] * b[axes.first];
  if (std::abs(a[axes.normal]) > 1e-12 || std::abs(b[axes.normal]) > 1e-12)
    return at_.error(
        radius.offset, "cutter-radius",
        fmt::format("{} in a tilted plane is not supported; the path of the cutter's centre (R0) was expected",
                    radius.left ? "RL" : "RR"));
  CutterRadius cutter;
  cutter.radius_mm = radius.radius_mm;
  cutter.left = radius.left == (facing > 0);
  cutter.plane = radius.plane;
  cutter.corner_lines = false;         // outside corners on arcs
  cutter.entry_square_to_next = true;  // the first point is reached square to the contour
  cutter.moves_without_plane_motion = 1000;
  cutter.name = radius.left ? "RL" : "RR";
  const CutterRadiusResult result = compensate_radius(at_.out, radius.first_move, cutter);
  for (const CutterRadiusProblem& problem : result.problems)
    at_.error(at_.file().blocks.size() > problem.block && &at_.file() == &at_.main
                  ? at_.main.blocks[problem.block].offset
                  : radius.offset,
              "cutter-radius", problem.message);
  mover_.leave_from(result.problems.empty() ? Vec3(result.end_mm - mover_.position_mm()) : Vec3(Vec3::Zero()));
}

}  // namespace camber::nc::heidenhain
