// Path blocks: lines, arcs, poles; machine coordinates.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/heidenhain/klartext.h"
#include "nc/rotary_words.h"
#include "nc/shared_states.h"

namespace camber::nc::heidenhain {
namespace {

constexpr char kAxisLetters[] = "XYZ";
constexpr double kFullTurn_rad = 2 * kPi;

std::uint8_t given_axes(const BlockValues& b) {
  return static_cast<std::uint8_t>((b.axis[0] ? 1 : 0) | (b.axis[1] ? 2 : 0) | (b.axis[2] ? 4 : 0));
}

}  // namespace

/// A point at an angle: multiples of 90 degrees exactly.
Vec2 direction_at_deg(double degrees) {
  const double turn = std::fmod(std::fmod(degrees, 360.0) + 360.0, 360.0);
  if (turn == 0) return {1, 0};
  if (turn == 90) return {0, 1};
  if (turn == 180) return {-1, 0};
  if (turn == 270) return {0, -1};
  return {std::cos(rad_from_deg(turn)), std::sin(rad_from_deg(turn))};
}

Plane plane_of_axis(int axis) { return axis == 2 ? Plane::xy : axis == 1 ? Plane::zx : Plane::yz; }

void Klartext::run_path(const Statement& s) {
  if (s.kind == Kind::functions) return run_functions(s);
  const BlockValues b = read_values(s);
  if (b.by_parameter) editable_ = false;
  if (s.kind == Kind::centre) return set_centre(b);
  if (s.kind == Kind::rounding || s.kind == Kind::chamfer) return set_corner(s, b);
  const std::optional<double> feed_before = feed_;
  set_feed_mode(b);
  set_feed(b);
  functions_before(b);
  if (s.kind == Kind::approach) {
    start_approach(s, b, feed_before);
    return functions_after(b);
  }
  const std::size_t first = out_.moves.size();
  if (s.kind == Kind::departure) {
    depart(s, b);
    return functions_after(b);
  }
  if (b.compensation) set_compensation(*b.compensation, s.begin);
  for (const auto& f : b.functions)
    if (f.code == 140) retract(f, b);
  switch (s.kind) {
    case Kind::line:
    case Kind::normal_line:
      if (b.has(91) || b.has(92))
        go_in_machine_frame(b);
      else if (b.has(130) && tilted())
        run_untilted(b);
      else
        run_line(b);
      break;
    case Kind::polar_line:
      line_to(polar_target(b), 7, b);
      if (out_.moves.size() > first) out_.moves.back().editable = false;
      break;
    case Kind::circle:
      run_circle(b);
      break;
    case Kind::radius_arc:
      run_radius_arc(b);
      break;
    case Kind::tangent_arc:
    case Kind::polar_tangent_arc:
      run_tangent_arc(b, s.kind == Kind::tangent_arc ? target(b) : polar_target(b));
      break;
    case Kind::polar_circle:
      run_polar_circle(b);
      break;
    default:
      break;
  }
  if (out_.moves.size() > first) after_contour_move(first);
  // M99 calls at the end of the block; M89 behind each block that positions, M99 then ends it.
  const bool positions = s.kind == Kind::line || s.kind == Kind::polar_line;
  if (b.has(99)) {
    call_cycle(s.begin);
    cycle_modal_ = false;
  } else if (cycle_modal_ && positions && (b.moves() || s.kind == Kind::polar_line) && !b.has(91) && !b.has(92)) {
    call_cycle(s.begin);
  }
  functions_after(b);
}

/// M, F and S alone.
void Klartext::run_functions(const Statement& s) {
  const BlockValues b = read_values(s);
  set_feed_mode(b);
  set_feed(b);
  functions_before(b);
  for (const auto& f : b.functions)
    if (f.code == 140) retract(f, b);
  if (b.has(99)) {
    call_cycle(s.begin);
    cycle_modal_ = false;
  }
  functions_after(b);
}

// --- targets

/// The end of the block in programmed coordinates.
Vec3 Klartext::target(const BlockValues& b) const {
  Vec3 end = programmed();
  for (int axis = 0; axis < 3; ++axis) {
    const auto& value = b.axis[static_cast<std::size_t>(axis)];
    if (!value) continue;
    const double mm = *value * unit_mm();
    end[axis] = (b.step & (1U << axis)) != 0 ? end[axis] + mm : mm;
  }
  return end;
}

/// Returns the end in the frame of the moves. Axes that no word moves keep their place to the last bit.
Vec3 Klartext::end_in_moves(const Vec3& programmed_end, std::uint8_t given) const {
  if (frame_.plain) return programmed_end;
  Vec3 end = frame_.from_program(programmed_end);
  if (frame_.shift_only)
    for (int axis = 0; axis < 3; ++axis)
      if ((given & (1U << axis)) == 0) end[axis] = position_mm_[axis];
  return end;
}

/// PR and PA about the pole; what is not given stays.
Vec3 Klartext::polar_target(const BlockValues& b) {
  if (!pole_given_)
    throw FormulaError(statement_->begin, "pole", "a polar coordinate without a pole; CC was expected before");
  const PlaneAxes axes = axes_of(pole_plane_);
  Vec3 end = target(b);
  const Vec3 now = programmed();
  const double x = now[axes.first] - pole_mm_[axes.first], y = now[axes.second] - pole_mm_[axes.second];
  double radius = std::hypot(x, y), angle = deg_from_rad(std::atan2(y, x));
  const bool from_here = !b.polar_radius || !b.polar_angle || b.polar_radius_step || b.polar_angle_step;
  if (from_here) relied_ends_.add(out_.moves);
  if (b.polar_radius) radius = b.polar_radius_step ? radius + *b.polar_radius * unit_mm() : *b.polar_radius * unit_mm();
  if (b.polar_angle) angle = b.polar_angle_step ? angle + *b.polar_angle : *b.polar_angle;
  const Vec2 direction = direction_at_deg(angle);
  end[axes.first] = pole_mm_[axes.first] + radius * direction.x();
  end[axes.second] = pole_mm_[axes.second] + radius * direction.y();
  return end;
}

/// CC: X and Y, or the axes of another plane; an axis that is not given stays; none at all: where the tool stands.
void Klartext::set_centre(const BlockValues& b) {
  const std::uint8_t given = given_axes(b);
  const Vec3 now = programmed();
  const auto main_plane = plane_of_axis(tool_axis_);
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
  if (pole_from_here_) relied_ends_.add(out_.moves);
  for (int axis = 0; axis < 3; ++axis) {
    const auto& value = b.axis[static_cast<std::size_t>(axis)];
    if (!value) continue;
    const double mm = *value * unit_mm();
    pole_mm_[axis] = (b.step & (1U << axis)) != 0 ? now[axis] + mm : mm;
  }
  pole_given_ = true;
}

int Klartext::sense_of(const BlockValues& b) {
  if (b.sense) return last_sense_ = *b.sense;
  if (last_sense_ == 0) {
    error(statement_->begin, "arc", "an arc without DR; DR+ or DR- was expected");
    last_sense_ = 1;
  }
  return last_sense_;
}

// --- moves

std::uint32_t Klartext::state_index() {
  if (!state_changed_) return state_index_;
  state_changed_ = false;
  return state_index_ = shared_state(out_.states, state_);
}

Move& Klartext::add_move(MoveKind kind, const Vec3& end_mm, std::uint8_t absolute) {
  Move move;
  move.start_mm = position_mm_;
  move.end_mm = end_mm;
  move.block = block_;
  move.state = state_index();
  move.kind = kind;
  move.editable = editable_;
  move.feed_given = feed_given_;
  move.feed_by_variable = feed_by_variable_;
  feed_given_ = false;
  move.reference = kind != MoveKind::dwell && std::ranges::any_of(place_, [](Place p) { return p != Place::known; });
  move.reference |= kind == MoveKind::rapid && carried_over_ != 0;
  if (kind == MoveKind::linear || kind == MoveKind::arc) note_cut_plane();
  if (leaving_ && kind != MoveKind::dwell) {
    move.start_mm += beside_mm_;
    move.editable = leaving_ = false;
  }
  if (!options_.rotary_axes.empty() && kind != MoveKind::dwell) {
    std::uint8_t open = open_axes_;
    for (unsigned axis = 0; axis < 3; ++axis)
      if (place_[axis] != Place::known) open = static_cast<std::uint8_t>(open | 1U << axis);
    move.open_axes = open & ~absolute & 7U;
    move.start_open = start_open_;
    const auto& targets = out_.machine_targets;
    start_open_ = move.open_axes != 0 || (!targets.empty() && targets.back().move == out_.moves.size());
    if (!out_.machine_origin_mm) out_.machine_origin_mm = offsets_.machine_origin_mm(54);
  }
  position_mm_ = end_mm;
  out_.moves.push_back(move);
  return out_.moves.back();
}

/// Absolute words put axes in the frame.
void Klartext::settle(std::uint8_t given) {
  for (unsigned axis = 0; axis < 3; ++axis)
    if ((given & (1U << axis)) != 0) place_[axis] = Place::known;
  open_axes_ = static_cast<std::uint8_t>(open_axes_ & ~given);
  carried_over_ = static_cast<std::uint8_t>(carried_over_ & ~given);
}

/// A cutting move needs a place to start from: axes that were never programmed are taken to stand at zero.
void Klartext::prepare_cutting(const char* what, std::uint8_t given) {
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (place_[axis] == Place::known) continue;
    const char letter = kAxisLetters[axis];
    const bool placed = (given & (1U << axis)) != 0;
    if (placed) {
      if (place_[axis] == Place::never)
        warn(statement_->begin, "start-unknown",
             fmt::format(
                 "{} to {} from a place that the program has not given; the move is ignored for material removal", what,
                 letter),
             "from nowhere");
    } else if (place_[axis] == Place::never) {
      warn(statement_->begin, "start-unknown",
           fmt::format("{} before {} was programmed; the tool is assumed to be at {}0", what, letter, letter));
      place_[axis] = Place::known;
    } else {
      warn(statement_->begin, "at-reference",
           fmt::format("{} while {} is at a machine coordinate; the move is ignored for material removal", what,
                       letter));
    }
  }
}

void Klartext::line_to(const Vec3& programmed_end, std::uint8_t given, const BlockValues& b) {
  const Vec3 end = end_in_moves(programmed_end, given);
  std::uint8_t absolute = given;
  absolute = static_cast<std::uint8_t>(absolute & ~b.step);
  if (b.rapid) {
    add_move(MoveKind::rapid, end, absolute);
  } else {
    prepare_cutting("L", absolute);
    const double feed = cutting_feed("L");
    const Vec3 way = programmed_end - programmed();
    add_move(MoveKind::linear, end, absolute).feed_mm_per_s =
        plunge_factor_ && way.norm() > 0 ? plunging_feed(feed, way) : feed;
    if (plunge_factor_) out_.moves.back().editable = false;
  }
  settle(absolute);
}

void Klartext::run_line(const BlockValues& b) {
  const bool directed = b.tool[0] || b.tool[1] || b.tool[2];
  if (!b.moves()) {
    if (b.turns() || directed) turn_only(b);
    return;
  }
  line_to(target(b), given_axes(b), b);
  const std::size_t move = out_.moves.size() - 1;
  if (directed) {
    const Vec3 direction(b.tool[0].value_or(0), b.tool[1].value_or(0), b.tool[2].value_or(0));
    if (direction.norm() < 1e-6)
      error(statement_->begin, "tool-direction", "TX TY TZ are all zero; a direction was expected");
    else
      direction_target(direction.normalized(), move);
  } else if (b.turns()) {
    add_rotary(b, move);
  }
}

/// M91, M92: machine coordinates.
void Klartext::go_in_machine_frame(const BlockValues& b) {
  if (!b.moves()) {
    if (b.turns()) turn_only(b);
    return;
  }
  Vec3 end = position_mm_, machine_mm = Vec3::Zero();
  std::uint8_t given = 0;
  const auto origin = offsets_.machine_origin_mm(54);
  const bool known = origin && b.has(91) && frame_.shift_only;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& value = b.axis[static_cast<std::size_t>(axis)];
    if (!value) continue;
    machine_mm[axis] = *value * unit_mm();
    given = static_cast<std::uint8_t>(given | 1U << axis);
    const bool here = known && axis != tool_axis_;  // the height needs the tool's length
    place_[static_cast<std::size_t>(axis)] = here ? Place::known : Place::machine;
    end[axis] = here ? (*origin)[axis] + machine_mm[axis] : 0;
  }
  if (!options_.rotary_axes.empty()) {
    if (b.has(92)) machine_mm = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    out_.machine_targets.push_back({machine_mm, static_cast<std::uint32_t>(out_.moves.size()), given});
  }
  const double feed = b.rapid ? 0 : cutting_feed("L");
  Move& move = add_move(b.rapid ? MoveKind::rapid : MoveKind::linear, end);
  move.feed_mm_per_s = feed;
  move.editable = false;
  if (b.turns()) add_rotary(b, out_.moves.size() - 1);
}

/// M130: coordinates of the untilted system, for this block.
void Klartext::run_untilted(const BlockValues& b) {
  if (options_.rotary_axes.empty()) return go_in_machine_frame(b);
  const auto tilt = std::exchange(tilt_, std::nullopt);
  const Transform in_plane = std::exchange(in_plane_, {});
  const WorkFrame work_frame = std::exchange(state_.work_frame, WorkFrame::machine);
  state_changed_ = true;
  update_frame();
  run_line(b);
  tilt_ = tilt;
  in_plane_ = in_plane;
  state_.work_frame = work_frame;
  state_changed_ = start_open_ = true;
  open_axes_ = 7;
  update_frame();
}

/// M140 MB: off along the tool axis by so much, or to the end of the travel (MAX); at the F of its block, else rapid.
void Klartext::retract(const BlockValues::Function& f, const BlockValues& b) {
  if (!f.argument) {
    error(f.offset, "retract", "M140 without MB; MB MAX or MB with a length was expected");
    return;
  }
  Vec3 end = position_mm_;
  const bool as_far_as_possible = std::isinf(*f.argument);
  if (as_far_as_possible) {
    place_[static_cast<std::size_t>(tool_axis_)] = Place::machine;
    end[tool_axis_] = 0;
    if (!options_.rotary_axes.empty()) {
      const auto bit = static_cast<std::uint8_t>(1U << tool_axis_);
      out_.machine_targets.push_back({Vec3::Constant(std::numeric_limits<double>::quiet_NaN()),
                                      static_cast<std::uint32_t>(out_.moves.size()), bit});
    }
  } else {
    Vec3 up = Vec3::Zero();
    up[tool_axis_] = *f.argument * unit_mm();
    up = frame_.linear * up;
    if (state_.tip_control != TipControl::off && (direction_unknown_ || rotary_rad_ != Vec3::Zero())) {
      // Along the tool, where a vector gives it; by angles only the machine knows where that is.
      const bool by_vector = direction_unknown_ && out_.rotary.back().is_direction;
      up = by_vector ? Vec3(up.norm() * out_.rotary.back().end) : Vec3(Vec3::Zero());
      if (!by_vector) open_axes_ = 7;
    }
    end = position_mm_ + up;
  }
  const double feed = b.feed && !b.rapid ? cutting_feed("M140") : 0;
  Move& move = add_move(feed > 0 ? MoveKind::linear : MoveKind::rapid, end);
  move.feed_mm_per_s = feed;
  move.editable = false;
}

// --- rotary axes

/// The rotary words of a block that moves.
void Klartext::add_rotary(const BlockValues& b, std::size_t move) {
  if (options_.rotary_axes.empty()) {
    const bool at_zero =
        std::ranges::all_of(b.rotary, [](const auto& v) { return !v || *v == 0; }) && (b.to_plane == 0 || !tilted());
    if (!at_zero)
      warn(
          statement_->begin, "rotary-axis",
          "rotary axes turn here; without a machine file with [kinematics] X, Y and Z are read as they are programmed, "
          "and the tool stays upright",
          "rotary");
    return;
  }
  if (b.to_plane != 0 && tilt_) return direction_target(tilt_->col(2), move);
  RotaryTarget target;
  target.end = rotary_rad_;
  target.move = static_cast<std::uint32_t>(move);
  for (unsigned i = 0; i < 3; ++i) {
    if (!b.rotary[i]) continue;
    const char letter = static_cast<char>('A' + i);
    const RotaryOption* axis = rotary_axis_of(options_.rotary_axes, letter);
    if (!axis) {
      error(statement_->begin, "rotary-axis", fmt::format("{} is not an axis of the machine's chain", letter),
            std::string(1, letter));
      continue;
    }
    const double value = rad_from_deg(*b.rotary[i]);
    double& end = target.end[static_cast<Eigen::Index>(i)];
    if ((b.rotary_step & (1U << i)) != 0) {
      end += value;
    } else {
      if ((shortest_way_ || axis->shortest_way) && !direction_unknown_)
        end = shortest_way(value, end);
      else
        end = value;
      if (direction_unknown_ && (shortest_way_ || axis->shortest_way))
        target.shortest = static_cast<std::uint8_t>(target.shortest | 1U << i);
    }
    target.given = static_cast<std::uint8_t>(target.given | 1U << i);
  }
  if (target.given == 0) return;
  const bool turns = target.end != rotary_rad_ || direction_unknown_;
  rotary_rad_ = target.end;
  direction_unknown_ = false;
  out_.rotary.push_back(target);
  if (turns && state_.work_frame != WorkFrame::machine) {
    open_axes_ = 7;
    start_open_ = true;
    out_.moves[move].open_axes = 7;
  }
}

/// A block of rotary words alone, or a statement that turns the axes: a move where the machine has such axes.
void Klartext::turn_only(const BlockValues& b) {
  if (options_.rotary_axes.empty()) return add_rotary(b, 0);
  const double feed = b.rapid ? 0 : cutting_feed("L");
  Move& move = add_move(b.rapid ? MoveKind::rapid : MoveKind::linear, position_mm_);
  move.feed_mm_per_s = feed;
  if (!has_words(statement_->kind) || b.by_parameter) move.editable = false;
  add_rotary(b, out_.moves.size() - 1);
}

/// The rotary axes put the tool along a direction in the frame of the moves.
void Klartext::direction_target(const Vec3& direction, std::size_t move) {
  if (options_.rotary_axes.empty()) {
    constexpr double kUpright = 1 - 1e-9;
    if (!tilted() && direction.z() > kUpright) return;
    warn(
        statement_->begin, "rotary-axis",
        "the tool is tilted here; without a machine file with [kinematics] X, Y and Z are read as they are programmed, "
        "and the tool stays upright",
        "rotary");
    return;
  }
  RotaryTarget target;
  target.is_direction = true;
  target.end = direction.normalized();
  target.move = static_cast<std::uint32_t>(move);
  out_.rotary.push_back(target);
  direction_unknown_ = true;
}

// --- arcs

/// Along the end of the last move, in programmed coordinates, in the plane; zero where there is none.
Vec3 Klartext::last_direction() const {
  for (std::size_t i = out_.moves.size(); i-- > 0;) {
    const Move& move = out_.moves[i];
    if (move.kind == MoveKind::dwell || (move.kind != MoveKind::arc && move.start_mm == move.end_mm)) continue;
    Vec3 direction = frame_.inverse * direction_at(out_, move, 1.0);
    direction[axes_of(plane_of_axis(tool_axis_)).normal] = 0;
    return direction.norm() > 1e-12 ? Vec3(direction.normalized()) : Vec3(Vec3::Zero());
  }
  return Vec3::Zero();
}

/// `arc`: programmed.
void Klartext::arc_to(const Vec3& programmed_end, const Arc& arc, const BlockValues& b, bool by_radius) {
  std::optional<Arc> in_moves = frame_.plain ? std::optional(arc) : from_program(frame_, arc);
  if (!in_moves) {
    error(statement_->begin, "scaling",
          "an arc under a scale that differs along its two axes would be an ellipse; one scale for both was expected");
    position_mm_ = end_in_moves(programmed_end, 7);
    return;
  }
  in_moves->by_radius = by_radius;
  const Vec3 end = end_in_moves(programmed_end, given_axes(b) | 7U);
  out_.arcs.push_back(*in_moves);
  const double feed = cutting_feed("an arc");
  if (b.rapid && feed > 0)
    warn(statement_->begin, "arc-at-rapid", "an arc with FMAX is read with the F before it", "FMAX");
  Move& move = add_move(MoveKind::arc, end);
  move.arc = static_cast<std::uint32_t>(out_.arcs.size() - 1);
  move.feed_mm_per_s = feed;
}

bool Klartext::make_arc_of(ArcWords words, const BlockValues& b) {
  const auto given = static_cast<std::uint8_t>(given_axes(b) & ~b.step);
  prepare_cutting("an arc", given);
  const bool by_radius = words.r_mm.has_value();
  const ArcResult result = make_arc(words);
  if (result.is_point) {
    if (result.start_radius_mm == 0)
      warn(statement_->begin, "arc-radius", "a circle from its own centre is no circle; a start beside CC was expected",
           "arc-point");
    line_to(words.end_mm, given_axes(b), b);
    out_.moves.back().editable = false;
    return false;
  }
  std::string message = result.error;
  if (message.empty() && result.radius_difference_mm >= kArcRadiusWarningMm) {
    message = fmt::format(
        "the radius of the arc is {:.4f} mm at its start and {:.4f} mm at its end; a difference below "
        "{} mm was expected",
        result.start_radius_mm, result.end_radius_mm,
        result.radius_difference_mm < kArcRadiusErrorMm ? kArcRadiusWarningMm : kArcRadiusErrorMm);
    if (result.radius_difference_mm < kArcRadiusErrorMm) {
      warn(statement_->begin, "arc-radius", message, "arc-radius");
      message.clear();
    }
  }
  if (!message.empty()) {
    error(statement_->begin, result.error.empty() ? "arc-radius" : "arc", message);
    position_mm_ = end_in_moves(words.end_mm, 7);
    settle(given);
    return false;
  }
  arc_to(words.end_mm, result.arc, b, by_radius);
  settle(given);
  return true;
}

void Klartext::run_circle(const BlockValues& b) {
  if (!pole_given_) throw FormulaError(statement_->begin, "pole", "C without a circle centre; CC was expected before");
  if (pole_from_here_) editable_ = false;
  ArcWords words;
  words.start_mm = programmed();
  words.end_mm = target(b);
  words.plane = pole_plane_;
  words.clockwise = sense_of(b) < 0;
  words.absolute_centre = true;
  const PlaneAxes axes = axes_of(pole_plane_);
  for (const int axis : {axes.first, axes.second})
    (axis == 0 ? words.i_mm : axis == 1 ? words.j_mm : words.k_mm) = pole_mm_[axis];
  make_arc_of(words, b);
}

void Klartext::run_radius_arc(const BlockValues& b) {
  if (!b.radius || *b.radius == 0) {
    error(statement_->begin, "arc", "CR without a radius; R was expected");
    return;
  }
  ArcWords words;
  words.start_mm = programmed();
  words.end_mm = target(b);
  const Vec3 way = words.end_mm - words.start_mm;
  words.plane = plane_of_axis(tool_axis_);
  // A circle in another plane: its end is given in the axes of that plane.
  const std::uint8_t given = given_axes(b);
  if (tool_axis_ == 2 && (given & 4U) != 0 && (given & 3U) != 3U && way.z() != 0)
    words.plane = (given & 1U) != 0 ? Plane::zx : (given & 2U) != 0 ? Plane::yz : words.plane;
  words.clockwise = sense_of(b) < 0;
  words.r_mm = *b.radius * unit_mm();
  make_arc_of(words, b);
}

/// An arc that goes on along the last move.
void Klartext::run_tangent_arc(const BlockValues& b, const Vec3& end) {
  const PlaneAxes axes = axes_of(plane_of_axis(tool_axis_));
  const Vec3 start = programmed(), along = last_direction();
  if (along == Vec3::Zero()) {
    error(statement_->begin, "arc", "CT without a move before it that gives its direction");
    return;
  }
  const Vec2 d(along[axes.first], along[axes.second]);
  const Vec2 chord(end[axes.first] - start[axes.first], end[axes.second] - start[axes.second]);
  const double across = d.x() * chord.y() - d.y() * chord.x();
  editable_ = false;
  relied_ends_.add_direction(out_.moves);
  if (std::abs(across) < 1e-9 * std::max(1.0, chord.norm())) {
    if (chord.dot(d) < 0 || chord.norm() == 0)
      return error(statement_->begin, "arc",
                   "CT ends behind its start on the line that it is tangent to; no arc leads there");
    return line_to(end, 7, b);
  }
  const double radius = chord.squaredNorm() / (2 * across);  // positive: the centre is on the left
  Arc arc;
  arc.normal = normal_of(plane_of_axis(tool_axis_));
  arc.center_mm = start;
  arc.center_mm[axes.first] += -d.y() * radius;
  arc.center_mm[axes.second] += d.x() * radius;
  const double turn = 2 * std::atan2(std::abs(across), chord.dot(d));
  arc.sweep_rad = radius > 0 ? turn : -turn;
  const auto given = static_cast<std::uint8_t>(given_axes(b) & ~b.step);
  prepare_cutting("CT", given);
  arc_to(end, arc, b, false);
  settle(given);
}

/// CP: about the pole, at the radius of where the tool stands; IPA may be more than a turn, Z makes it a helix.
void Klartext::run_polar_circle(const BlockValues& b) {
  if (!pole_given_) throw FormulaError(statement_->begin, "pole", "CP without a pole; CC was expected before");
  const PlaneAxes axes = axes_of(pole_plane_);
  const Vec3 start = programmed();
  Vec3 end = target(b);
  const double x = start[axes.first] - pole_mm_[axes.first], y = start[axes.second] - pole_mm_[axes.second];
  const double radius = std::hypot(x, y);
  if (radius < 1e-9) {
    error(statement_->begin, "arc", "CP from its pole; a start beside CC was expected");
    return;
  }
  const int sense = b.sense || !b.polar_angle_step ? sense_of(b) : (*b.polar_angle < 0 ? -1 : 1);
  if (b.polar_angle_step && sense * *b.polar_angle < 0 && std::fmod(*b.polar_angle, 360.0) != 0)
    warn(statement_->begin, "arc-sense",
         "IPA and DR have different signs; the arc is read with the size of IPA in the sense of DR; the same sign was "
         "expected",
         "IPA");
  double sweep = 0;
  editable_ = false;
  relied_ends_.add(out_.moves);  // it gives the radius
  if (b.polar_angle && b.polar_angle_step) {
    sweep = sense * rad_from_deg(std::abs(*b.polar_angle));
    const double degrees = std::fmod(std::abs(*b.polar_angle), 360.0);
    const double c = direction_at_deg(sense * degrees).x(), s = direction_at_deg(sense * degrees).y();
    end[axes.first] = pole_mm_[axes.first] + c * x - s * y;
    end[axes.second] = pole_mm_[axes.second] + s * x + c * y;
    if (degrees == 0)
      for (const int axis : {axes.first, axes.second}) end[axis] = start[axis];
  } else if (b.polar_angle) {
    const Vec2 direction = direction_at_deg(*b.polar_angle);
    end[axes.first] = pole_mm_[axes.first] + radius * direction.x();
    end[axes.second] = pole_mm_[axes.second] + radius * direction.y();
    double turn = rad_from_deg(*b.polar_angle) - std::atan2(y, x);
    constexpr double kSameAngle = 1e-9;
    while (sense * turn <= kSameAngle) turn += sense * kFullTurn_rad;
    while (sense * turn > kFullTurn_rad + kSameAngle) turn -= sense * kFullTurn_rad;
    sweep = turn;
  } else {
    sweep = sense * kFullTurn_rad;
    for (const int axis : {axes.first, axes.second}) end[axis] = start[axis];
  }
  if (sweep == 0) return line_to(end, given_axes(b), b);
  if (std::abs(sweep) > kFullTurn_rad * 1e5) {
    error(statement_->begin, "arc-turns", "more than 100000 turns in one block");
    return;
  }
  Arc arc;
  arc.normal = normal_of(pole_plane_);
  arc.center_mm = pole_mm_;
  arc.center_mm[axes.normal] = start[axes.normal];
  arc.sweep_rad = sweep;
  const auto given = static_cast<std::uint8_t>(given_axes(b) & ~b.step);
  prepare_cutting("CP", given);
  arc_to(end, arc, b, false);
  settle(static_cast<std::uint8_t>(given | 1U << axes.first | 1U << axes.second));
}

}  // namespace camber::nc::heidenhain
