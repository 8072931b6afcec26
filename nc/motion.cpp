// Words that make moves: dwells, lines, arcs, the way to the reference point. Cycles: cycle_codes.cpp.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "nc/block_interpreter.h"
#include "nc/shared_states.h"

namespace camber::nc {
namespace {

constexpr char kAxisLetters[] = "XYZ";

}  // namespace

bool BlockInterpreter::place_unknown() const {
  return std::any_of(place_.begin(), place_.end(), [](AxisPlace p) { return p != AxisPlace::known; });
}

std::uint32_t BlockInterpreter::state_index() {
  if (!state_changed_) return state_index_;
  state_changed_ = false;
  return state_index_ = shared_state(out_.states, state_);
}

Move& BlockInterpreter::add_move(MoveKind kind, const Vec3& end_mm) {
  Move move;
  move.start_mm = position_mm_;
  move.end_mm = end_mm;
  move.block = block_;
  move.state = state_index();
  move.kind = kind;
  move.editable = editable_ && !frame_.polar;
  move.exact_stop = request_.exact_stop;
  move.feed_given = feed_given_;
  move.feed_by_variable = feed_by_variable_;
  feed_given_ = false;
  move.reference = kind != MoveKind::dwell && place_unknown();
  if (leaving_) leave_contour(move);
  if (!options_.rotary_axes.empty() && kind != MoveKind::dwell) {
    check_rotary_offset();
    move.open_axes = static_cast<std::uint8_t>(open_axes_of_move() & 7U);
    if (rotary_target_ && state_.tip_control != TipControl::off && move.open_axes != 0 && !open_cause_.empty()) {
      error(
          words_.offset(), "position-open",
          fmt::format("rotary axes turn under tool-centre-point control after {}, which leaves the tip open; X, Y and "
                      "Z in G90 were expected before or in this block",
                      open_cause_));
      open_axes_ = move.open_axes = 0;
    }
    move.start_open = start_open_;
    const auto& targets = out_.machine_targets;
    start_open_ = move.open_axes != 0 || (!targets.empty() && targets.back().move == out_.moves.size());
  }
  position_mm_ = end_mm;
  out_.moves.push_back(move);
  if (!options_.rotary_axes.empty() && kind != MoveKind::dwell) add_rotary_target(out_.moves.size() - 1);
  return out_.moves.back();
}

void BlockInterpreter::check_unit() {
  if (unit_given_) return;
  unit_given_ = true;
  report_.warning(words_.offset(), "unit-missing",
                  "the program has moves before G20 or G21 says which unit it is in; millimetres are assumed");
}

/// The axis words of the block, and an angle (,A), counted from `start`, a point in the same coordinates.
Vec3 BlockInterpreter::target_from(const Vec3& start) {
  Vec3 end = start;
  for (int axis = 0; axis < 3; ++axis) {
    if (!words_.has(kAxisLetters[axis])) continue;
    const double value = words_.value(kAxisLetters[axis]) * unit_mm();
    end[axis] = state_.incremental ? end[axis] + value : value;
  }
  return words_.corner_words().empty() ? end : target_at_angle(start, end);
}

Vec3 BlockInterpreter::programmed_target() {
  const Vec3 start = programmed();
  return frame_.polar ? polar_target(start) : target_from(start);
}

/// The end of the block's move in the frame of the moves. Axes that no word moves keep their place to the last bit.
Vec3 BlockInterpreter::target() {
  if (frame_.plain && !frame_.polar) return target_from(position_mm_);
  Vec3 end = frame_.from_program(programmed_target());
  if (!frame_.shift_only) return end;
  for (int axis = 0; axis < 3; ++axis)
    if (!words_.has(kAxisLetters[axis]) && !frame_.polar && words_.corner_words().empty())
      end[axis] = position_mm_[axis];
  return end;
}

/// An absolute word puts an axis in the work frame.
void BlockInterpreter::settle_axes() {
  if (state_.incremental) return;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (words_.has(kAxisLetters[axis])) place_[axis] = AxisPlace::known;
}

std::optional<double> BlockInterpreter::dwell_seconds(char letter) {
  if (!words_.has(letter)) return std::nullopt;
  const double value = words_.value(letter);
  const Word& word = words_.word(letter);
  if (value < 0) {
    error(word.offset, "dwell", fmt::format("a dwell of {} {} is negative; zero or more was expected", letter, value));
    return 0.0;
  }
  if (letter != 'P') return value;  // seconds, as scale_whole_numbers has read it
  if (written_with_point(word)) return value;
  if (options_.dwell_p_is_ms) return value / 1000.0;
  if (value >= 100)
    report_.warning(
        word.offset, "dwell-long",
        fmt::format("a dwell of {} s; where {} without a point counts milliseconds, the control must be named", value,
                    letter),
        "dwell-long");
  return value;
}

void BlockInterpreter::dwell() {
  std::optional<double> seconds;
  const bool p_alone = options_.dialect_or_default().dwell_takes_p_alone;
  for (const char letter : {'P', 'X', 'U'})
    if (!seconds && (letter == 'P' || !p_alone)) seconds = dwell_seconds(letter);
  if (!seconds) {
    error(words_.offset(), "dwell", "G4 has no time; P with the time was expected");
    return;
  }
  add_move(MoveKind::dwell, position_mm_).dwell_s = *seconds;
}

/// G4 takes P alone: the other words move as if it were not there.
void BlockInterpreter::move_after_dwell() {
  const bool arc = motion_ == Motion::clockwise || motion_ == Motion::counter_clockwise;
  const bool moves = words_.has_any("XYZ") || rotary_target_ || request_.cycle_given || (arc && words_.has_any("IJKR"));
  if (!moves || request_.trouble) return;
  if (arc && cycle_.g == 0)
    error(words_.offset(), "modal-group", "G4 with an arc (G2, G3), both of which use P; two blocks were expected");
  else
    move();
}

/// G28.1, G30.1: where the tool stands is the reference point from now on.
void BlockInterpreter::store_reference(const Code& code) {
  if (!options_.dialect_or_default().stores_reference_points) {
    error(code.word->offset, "unknown-g",
          fmt::format("{} is not a G code of a {} program that Camber knows", code_text(code),
                      options_.dialect_or_default().title));
    request_.skip_motion = true;
    return;
  }
  stored_reference_[code.tenths == 281 ? 0 : 1] = StoredReference{position_mm_, rotary_rad_};
}

void BlockInterpreter::go_to_reference() {
  check_unit();
  words_.use("P");
  std::array<bool, 3> goes{};
  for (std::size_t axis = 0; axis < 3; ++axis) goes[axis] = words_.has(kAxisLetters[axis]);
  const bool none = !goes[0] && !goes[1] && !goes[2] && !rotary_target_;
  const std::uint8_t turns = rotary_target_ ? rotary_target_->given : 0;
  const Vec3 via = target();
  const Vec3 old_via = reference_via_mm_.value_or(position_mm_);
  reference_via_mm_ = via;
  for (int axis = 0; axis < 3; ++axis)
    if (!goes[static_cast<std::size_t>(axis)]) (*reference_via_mm_)[axis] = old_via[axis];
  std::size_t point = 0;
  if (words_.has('P') && request_.reference_word->value == 30) {
    const double p = words_.value('P');
    if (p != 2 && p != 3 && p != 4) {
      error(words_.offset_of('P'), "reference",
            fmt::format("G30 P{} is not a reference point; P2, P3 or P4 was expected", p));
      return;
    }
    point = static_cast<std::size_t>(p) - 1;
  } else if (request_.reference_word->value == 30) {
    point = 1;
  }
  if (via != position_mm_ || (rotary_target_ && rotary_target_->end != rotary_rad_)) {
    add_move(MoveKind::rapid, via);
    settle_axes();
  }
  const auto stored = point < stored_reference_.size() ? stored_reference_[point] : std::nullopt;
  turn_home(none, turns, stored ? stored->rotary_rad : Vec3(Vec3::Zero()));
  Vec3 home = position_mm_, machine_mm = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  std::uint8_t given = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!none && !goes[axis]) continue;
    if (stored) {
      home[static_cast<Eigen::Index>(axis)] = stored->place_mm[static_cast<Eigen::Index>(axis)];
      continue;
    }
    home[static_cast<Eigen::Index>(axis)] = 0;
    place_[axis] = AxisPlace::reference;
    given = static_cast<std::uint8_t>(given | 1U << axis);
    if (const auto& at = options_.reference_points_mm[point]) {
      machine_mm[static_cast<Eigen::Index>(axis)] = (*at)[static_cast<Eigen::Index>(axis)];
      settle_machine_axis(axis, (*at)[static_cast<Eigen::Index>(axis)], home);
    }
  }
  add_machine_target(machine_mm, given);
  Move& move = add_move(MoveKind::rapid, home);
  if (stored) return;
  move.reference_point = static_cast<std::uint8_t>(point & 3U);
  for (unsigned axis = 0; axis < 3; ++axis)
    if (none || goes[axis]) move.reference_axes = static_cast<std::uint8_t>((move.reference_axes | 1U << axis) & 7U);
}

/// G60: a rapid beyond or short of the place, a stop, and the last way always in the same direction.
void BlockInterpreter::position_in_one_direction() {
  check_unit();
  if (motion_ != Motion::rapid && motion_ != Motion::none && motion_ != Motion::linear) {
    error(words_.offset(), "single-direction", "G60 goes with G0 or G1; an arc or a cycle is active");
    return;
  }
  settle_axes_for("G60", false);
  const Vec3 end = target();
  Vec3 before = end;
  for (int axis = 0; axis < 3; ++axis)
    if (words_.has(kAxisLetters[axis])) before[axis] -= options_.single_direction_mm[axis];
  if (before != end) {
    Move& first = add_move(MoveKind::rapid, before);
    first.exact_stop = true;
    first.editable = false;
  }
  Move& last = add_move(MoveKind::rapid, end);
  last.creeps = before != end;
  if (last.creeps) last.editable = false;
  settle_axes();
}

void BlockInterpreter::go_in_machine_frame() {
  if (!words_.has_any("XYZ") && !rotary_target_) return;
  check_unit();
  if (motion_ == Motion::clockwise || motion_ == Motion::counter_clockwise || cycle_.g != 0) {
    error(words_.offset(), "machine-frame", "G53 goes with G0 or G1; another motion is active");
    return;
  }
  Vec3 end = position_mm_, machine_mm = Vec3::Zero();
  std::uint8_t given = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!words_.has(kAxisLetters[axis])) continue;
    machine_mm[static_cast<Eigen::Index>(axis)] = words_.value(kAxisLetters[axis]) * unit_mm();
    given = static_cast<std::uint8_t>(given | 1U << axis);
    settle_machine_axis(axis, machine_mm[static_cast<Eigen::Index>(axis)], end);
  }
  add_machine_target(machine_mm, given);
  std::optional<double> feed;
  if (motion_ == Motion::linear) feed = cutting_feed((end - position_mm_).norm(), "G1");
  Move& move = add_move(motion_ == Motion::linear ? MoveKind::linear : MoveKind::rapid, end);
  move.feed_mm_per_s = feed.value_or(0);
}

void BlockInterpreter::move() {
  const bool axes = words_.has_any("XYZ") || rotary_target_;
  if (request_.single_direction && axes && cycle_.g == 0) {
    position_in_one_direction();
    return;
  }
  if (cycle_.g != 0) {
    run_cycle();
    return;
  }
  const bool arc = motion_ == Motion::clockwise || motion_ == Motion::counter_clockwise;
  if (arc && (axes || words_.has_any("IJKR"))) {
    move_on_arc();
  } else if (axes && motion_ == Motion::none) {
    const std::string_view letters = "XYZABCIJK";
    const char letter = *std::ranges::find_if(letters, [&](char c) { return words_.has(c); });
    error(words_.offset_of(letter), "motion-missing",
          fmt::format("{} without a kind of motion; G0, G1, G2 or G3 was expected before", letter), "motion");
  } else if (axes) {
    move_on_line();
  }
}

void BlockInterpreter::move_on_line() {
  check_unit();
  settle_axes_for("cutter radius compensation", !radius_.active);
  const Vec3 end = target();
  if (motion_ == Motion::rapid) {
    add_move(MoveKind::rapid, end);
  } else {
    prepare_cutting("G1");
    const auto feed = cutting_feed((end - position_mm_).norm(), "G1");
    add_move(MoveKind::linear, end).feed_mm_per_s = feed.value_or(0);
  }
  settle_axes();
}

/// A cutting move needs a place to start from: axes that were never programmed are taken to stand at zero. `arc`: its
/// centre counts from the start, so that axes that the block itself places need one too.
void BlockInterpreter::prepare_cutting(const char* what, bool arc) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool placed = words_.has(kAxisLetters[axis]) && !state_.incremental;
    if (place_[axis] == AxisPlace::known) continue;
    const char letter = kAxisLetters[axis];
    if (placed && !(arc && place_[axis] == AxisPlace::never)) {
      if (place_[axis] == AxisPlace::never)
        report_.warning(words_.offset(), "start-unknown",
                        fmt::format("{} to {} from a place that the program has not given; the move is ignored for "
                                    "material removal",
                                    what, letter),
                        "from nowhere");
      continue;
    }
    if (place_[axis] == AxisPlace::never) {
      report_.warning(
          words_.offset(), "start-unknown",
          fmt::format("{} before {} was programmed; the tool is assumed to be at {}0", what, letter, letter));
      place_[axis] = AxisPlace::known;
    } else {
      report_.warning(
          words_.offset(), "at-reference",
          fmt::format("{} while {} is at the reference point; the move is ignored for material removal", what, letter));
    }
  }
  if (first_cut_offset_ == 0) first_cut_offset_ = state_.work_offset;
  if (state_.work_offset != first_cut_offset_ &&
      !(frames_.offsets.known(state_.work_offset) && frames_.offsets.known(first_cut_offset_)))
    report_.warning(
        words_.offset(), "work-offsets",
        "the program cuts in more than one work offset; their distance is not known, and all are treated as one frame");
}

std::optional<double> BlockInterpreter::cutting_feed(double length_mm, const char* g) {
  if (state_.feed_mode == FeedMode::inverse_time && !words_.has('F')) {
    error(words_.offset(), "feed-missing",
          fmt::format("{} in inverse time (G93) without F; every cutting block needs its own F", g), "G93");
    return std::nullopt;
  }
  const std::size_t at = request_.motion_given ? request_.motion_word->offset : words_.offset();
  if (!feed_) {
    if (!words_.has('F'))
      error(at, "feed-missing",
            fmt::format("{} without a feed; F greater than zero was expected before or in this block", g), "feed");
    return std::nullopt;
  }
  if (*feed_ == 0) {
    error(words_.offset_of('F'), "feed-zero",
          fmt::format("F0 on a cutting move ({}); the feed must be greater than zero", g), "feed");
    return std::nullopt;
  }
  switch (state_.feed_mode) {
    case FeedMode::inverse_time:
      return *feed_ * length_mm;
    case FeedMode::per_revolution:
      return per_revolution_feed();
    case FeedMode::per_minute:
      break;
  }
  return feed_;
}

std::optional<double> BlockInterpreter::per_revolution_feed() {
  if (state_.spindle_speed_rpm > 0) return *feed_ * state_.spindle_speed_rpm / 60.0;
  error(words_.offset(), "feed-per-turn", "a feed per revolution (G95) without a spindle speed; S was expected before",
        "feed-per-turn");
  return std::nullopt;
}

bool BlockInterpreter::other_centre_fits(const ArcWords& arc) const {
  ArcWords other = arc;
  other.absolute_centre = !arc.absolute_centre;
  const ArcResult fitting = make_arc(other);
  return fitting.error.empty() && fitting.radius_difference_mm < kArcRadiusWarningMm;
}

bool BlockInterpreter::arc_error(const ArcResult& result, const ArcWords& arc) {
  const std::size_t at = request_.motion_given ? request_.motion_word->offset : words_.offset();
  if (!result.error.empty()) {
    arcs_fit_absolute_ += other_centre_fits(arc);
    error(at, "arc", result.error);
    return true;
  }
  if (result.radius_difference_mm < kArcRadiusWarningMm || arc.spiral) return false;
  std::string message = fmt::format("the radius of the arc is {:.4f} mm at its start and {:.4f} mm at its end",
                                    result.start_radius_mm, result.end_radius_mm);
  if (result.radius_difference_mm < kArcRadiusErrorMm) {
    report_.warning(at, "arc-radius",
                    message + fmt::format("; a difference below {:.3f} mm was expected", kArcRadiusWarningMm),
                    "arc-radius");
    return false;
  }
  message += fmt::format("; a difference below {:.2f} mm was expected", kArcRadiusErrorMm);
  if (other_centre_fits(arc)) {
    ++arcs_fit_absolute_;
    message += arc.absolute_centre ? " (with a centre from the start, G91.1, it would fit)"
                                   : " (with an absolute centre, G90.1, it would fit)";
  }
  error(at, "arc-radius", std::move(message));
  return true;
}

void BlockInterpreter::move_on_arc() {
  check_unit();
  ArcWords arc;
  arc.plane = plane_;
  arc.clockwise = motion_ == Motion::clockwise;
  arc.absolute_centre = state_.absolute_arc_centre;
  const char* g = spiral_ ? (arc.clockwise ? "G2.1" : "G3.1") : arc.clockwise ? "G2" : "G3";
  settle_axes_for("an arc", false);
  prepare_cutting(g, true);
  if (leaving_) {
    error(words_.offset(), "cutter-radius",
          fmt::format("the move off the contour after G40 is an arc ({}); a straight move (G0, G1) was expected", g));
    leaving_ = false;
  }
  const Vec3 end_mm = target();
  arc.start_mm = programmed();
  arc.end_mm = frame_.plain ? end_mm : frame_.to_program(end_mm);
  arc.i_mm = words_.scaled('I', unit_mm());
  arc.j_mm = words_.scaled('J', unit_mm());
  arc.k_mm = words_.scaled('K', unit_mm());
  arc.r_mm = words_.scaled('R', unit_mm());
  if (spiral_) {
    read_spiral_turns(arc);
  } else if (words_.has('P')) {
    const double turns = words_.value('P');
    arc.turns = turns == std::floor(turns) && turns >= 1 && turns < 1e6 ? static_cast<int>(turns) : 0;
    if (arc.turns == 0)
      error(words_.offset_of('P'), "arc-turns",
            fmt::format("{} turns (P) on an arc; a whole number of one or more was expected", turns));
    arc.turns = std::max(arc.turns, 1);
  }
  if (!spiral_) read_spiral_words(arc);
  ArcResult result = make_arc(arc);
  if (spiral_ && arc.r_mm) result.error = "a spiral with R leaves its centre open; I J K were expected";
  if (result.is_point) {
    motion_point(end_mm, g);
    return;
  }
  const auto in_moves = frame_.plain || !result.error.empty() ? result.arc : from_program(frame_, result.arc);
  if (!in_moves)
    error(words_.offset(), "scaling",
          "an arc under a scale that differs along its two axes would be an ellipse; one scale "
          "for both was expected");
  if (arc_error(result, arc) || !in_moves) {
    position_mm_ = end_mm;
    settle_axes();
    return;
  }
  if (!arc.r_mm) ++arcs_fit_relative_;
  out_.arcs.push_back(*in_moves);
  Move& move = add_move(MoveKind::arc, end_mm);
  move.arc = static_cast<std::uint32_t>(out_.arcs.size() - 1);
  if (spiral_) move.editable = false;  // an arc in its place would need other words
  settle_axes();
  move.feed_mm_per_s = cutting_feed(length_mm(out_, move), g).value_or(0);
}

/// An arc so small that its centre coincides with an end to the last decimal: a line of that length.
void BlockInterpreter::motion_point(const Vec3& end_mm, const char* g) {
  const auto feed = cutting_feed((end_mm - position_mm_).norm(), g);
  Move& move = add_move(MoveKind::linear, end_mm);
  move.feed_mm_per_s = feed.value_or(0);
  move.editable = false;
  settle_axes();
}

/// G2.1, G3.1: the radius runs evenly from that of the start to that of the end; P full turns before the rest of one.
void BlockInterpreter::read_spiral_turns(ArcWords& arc) {
  arc.spiral = true;
  const double turns = words_.has('P') ? words_.value('P') : 0;
  if (turns != std::floor(turns) || turns < 0 || turns > 1e6) {
    error(words_.offset_of('P'), "arc-turns",
          fmt::format("{} full turns (P) on a spiral; a whole number of zero or more was expected", turns));
    return;
  }
  arc.turns = static_cast<int>(turns) + 1;
}

/// L, and Q with it: an Archimedean spiral (in G17 with Z a conical one); or radii that differ where the control
/// takes that as a spiral.
void BlockInterpreter::read_spiral_words(ArcWords& arc) {
  if (arc.r_mm) return;
  if (!words_.has('L')) {
    const Dialect dialect = options_.dialect_or_default();
    if (dialect.spiral_radius_difference_mm <= 0 && dialect.spiral_radius_fraction <= 0) return;
    const ArcResult plain = make_arc(arc);
    const double larger = std::max(plain.start_radius_mm, plain.end_radius_mm);
    const double relative_mm = std::min(dialect.spiral_radius_fraction * larger, dialect.spiral_max_mm);
    arc.spiral = plain.error.empty() && plain.radius_difference_mm > kArcRadiusWarningMm &&
                 plain.radius_difference_mm <= std::max(dialect.spiral_radius_difference_mm, relative_mm);
    return;
  }
  const double turns = words_.value('L');
  if (!(turns > 0 && turns < 1e6)) {
    error(words_.offset_of('L'), "arc-turns",
          fmt::format("{} turns (L) on an arc; a number greater than zero was expected", turns));
    return;
  }
  arc.spiral = true;
  arc.turns = static_cast<int>(std::ceil(turns));
  const ArcResult result = make_arc(arc);
  if (!words_.has('Q') || !result.error.empty()) return;
  const double end_mm =
      result.start_radius_mm + words_.value('Q') * unit_mm() * std::abs(result.arc.sweep_rad) / (2 * kPi);
  if (std::abs(end_mm - result.end_radius_mm) >= kArcRadiusErrorMm)
    error(words_.offset_of('Q'), "arc-radius",
          fmt::format("the spiral ends at a radius of {:.4f} mm, with Q at {:.4f} mm; a difference below {:.2f} mm was "
                      "expected",
                      result.end_radius_mm, end_mm, kArcRadiusErrorMm));
}

}  // namespace camber::nc
