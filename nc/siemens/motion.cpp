// Words that make moves: lines, arcs, dwells, machine coordinates. Cycles: cycles.cpp.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "base/units.h"
#include "nc/frames.h"
#include "nc/shared_states.h"
#include "nc/siemens/block_runner.h"
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

bool BlockRunner::place_unknown() const {
  return std::ranges::any_of(place_, [](AxisPlace p) { return p != AxisPlace::known; });
}

std::uint32_t BlockRunner::state_index() {
  if (!state_changed_) return state_index_;
  state_changed_ = false;
  return state_index_ = shared_state(out_.states, state_);
}

Move& BlockRunner::add_move(MoveKind kind, const Vec3& end_mm) {
  Move move;
  move.start_mm = position_mm_;
  move.end_mm = end_mm;
  move.block = place_of_block_.called_from;
  move.state = state_index();
  move.kind = kind;
  move.editable = editable_;
  move.exact_stop = request_.exact_stop;
  move.feed_given = feed_given_;
  move.feed_by_variable = feed_by_variable_;
  feed_given_ = false;
  move.reference = kind != MoveKind::dwell && place_unknown();
  if (leaving_) leave_contour(move);
  if (!options_.rotary_axes.empty() && kind != MoveKind::dwell) {
    move.open_axes = static_cast<std::uint8_t>(open_axes_of_move() & 7U);
    if (rotary_target_ && state_.tip_control != TipControl::off && move.open_axes != 0 && !open_cause_.empty()) {
      error(words_.offset(), "position-open",
            fmt::format("rotary axes turn under TRAORI after {}, which leaves the tip open; X, Y and Z in G90 were "
                        "expected before or in this block",
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

void BlockRunner::check_unit() {
  if (unit_given_) return;
  unit_given_ = true;
  report_.warning(
      words_.offset(), "unit-missing",
      "the program has moves before G70, G71, G700 or G710 says which unit it is in; millimetres are assumed");
}

/// A coordinate in program millimetres.
double BlockRunner::axis_value(const Slot& slot, double start, double unit) const {
  const double value = slot.value * unit;
  const bool incremental =
      slot.dimension == Dimension::incremental || (slot.dimension == Dimension::as_modal && !absolute_);
  return incremental ? start + value : value;
}

/// State that edits go by: the modal dimension. Words of their own (X=IC(5)) say so in the text.
void BlockRunner::note_dimensions() {
  if (state_.incremental == !absolute_) return;
  state_.incremental = !absolute_;
  change_state();
}

Vec3 BlockRunner::target_in_program() {
  const Vec3 start = programmed();
  if (words_.uses_extras() && (words_.has(Extra::ap) || words_.has(Extra::rp))) return polar_target(start);
  Vec3 end = start;
  for (int axis = 0; axis < 3; ++axis)
    if (words_.has(kAxisLetters[axis])) end[axis] = axis_value(words_.of(kAxisLetters[axis]), start[axis], unit_mm());
  if (words_.has(Extra::ang)) {
    editable_ = false;
    relied_ends_.add(out_.moves);
    const PlaneAxes axes = axes_of(plane_);
    const bool first = words_.has(kAxisLetters[axes.first]), second = words_.has(kAxisLetters[axes.second]);
    const double angle = rad_from_deg(words_.of(Extra::ang).value);
    const double across = first ? std::cos(angle) : std::sin(angle), along = first ? std::sin(angle) : std::cos(angle);
    const int given = first ? axes.first : axes.second, open = first ? axes.second : axes.first;
    if (first == second)
      error(words_.of(Extra::ang).offset, "line-angle",
            fmt::format("ANG in a block with {} of {} and {} is not supported; one of them was expected",
                        first ? "both" : "none", kAxisLetters[axes.first], kAxisLetters[axes.second]));
    else if (std::abs(across) < 1e-6)
      error(words_.of(Extra::ang).offset, "line-angle",
            fmt::format("a line at {:g} degrees does not lead to another {}", words_.of(Extra::ang).value,
                        kAxisLetters[given]));
    else
      end[open] = start[open] + (end[given] - start[given]) * along / across;
  }
  return end;
}

/// AP=, RP= about the pole.
Vec3 BlockRunner::polar_target(Vec3 end) {
  editable_ = false;
  relied_ends_.add(out_.moves);
  const PlaneAxes axes = axes_of(plane_);
  const char normal = kAxisLetters[axes.normal];
  if (words_.has(normal)) end[axes.normal] = axis_value(words_.of(normal), end[axes.normal], unit_mm());
  for (const int axis : {axes.first, axes.second})
    if (words_.has(kAxisLetters[axis]))
      error(words_.of(kAxisLetters[axis]).offset, "polar",
            fmt::format("{} beside AP or RP; a polar end point or a cartesian one was expected", kAxisLetters[axis]));
  const double dx = end[axes.first] - pole_mm_[axes.first], dy = end[axes.second] - pole_mm_[axes.second];
  double angle = deg_from_rad(std::atan2(dy, dx)), radius = std::hypot(dx, dy);
  const Slot &ap = words_.of(Extra::ap), &rp = words_.of(Extra::rp);
  const auto adds = [&](const Slot& slot) {
    return slot.dimension == Dimension::incremental || (slot.dimension == Dimension::as_modal && !absolute_);
  };
  if (ap.given) angle = adds(ap) ? angle + ap.value : ap.value;
  if (rp.given) radius = rp.dimension == Dimension::incremental ? radius + rp.value * unit_mm() : rp.value * unit_mm();
  if (radius < 0) error(rp.offset, "polar", fmt::format("RP={:g} is negative; zero or more was expected", rp.value));
  // Quarter turns exactly.
  const Eigen::Matrix3d turn = rotation_in(plane_, rad_from_deg(angle));
  Vec3 out = Vec3::Zero();
  out[axes.first] = radius;
  out = turn * out;
  end[axes.first] = pole_mm_[axes.first] + out[axes.first];
  end[axes.second] = pole_mm_[axes.second] + out[axes.second];
  return end;
}

/// G110: from where the tool is; G111: from the zero point; G112: from the last pole.
void BlockRunner::set_pole() {
  if (request_.pole == 110) relied_ends_.add(out_.moves);
  const Vec3 from = request_.pole == 110 ? programmed() : request_.pole == 112 ? pole_mm_ : Vec3(Vec3::Zero());
  Vec3 pole = from;
  const PlaneAxes axes = axes_of(plane_);
  if (words_.has(Extra::ap) || words_.has(Extra::rp)) {
    const double angle = rad_from_deg(words_.of(Extra::ap).value), radius = words_.of(Extra::rp).value * unit_mm();
    pole[axes.first] = from[axes.first] + radius * std::cos(angle);
    pole[axes.second] = from[axes.second] + radius * std::sin(angle);
  }
  for (int axis = 0; axis < 3; ++axis)
    if (const Slot& slot = words_.of(kAxisLetters[axis]); slot.given)
      pole[axis] = slot.dimension == Dimension::absolute ? slot.value * unit_mm() : from[axis] + slot.value * unit_mm();
  pole_mm_ = pole;
}

/// The end of the block's move in the frame of the moves. Axes that no word moves keep their place to the last bit.
Vec3 BlockRunner::target() {
  const Vec3 in_program = target_in_program();
  if (frame_.plain) return in_program;
  Vec3 end = frame_.from_program(in_program);
  if (!frame_.shift_only || words_.uses_extras()) return end;
  for (int axis = 0; axis < 3; ++axis)
    if (!words_.has(kAxisLetters[axis])) end[axis] = position_mm_[axis];
  return end;
}

void BlockRunner::settle_axes() {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Slot& slot = words_.of(kAxisLetters[axis]);
    if (slot.given && (slot.dimension == Dimension::absolute || (slot.dimension == Dimension::as_modal && absolute_)))
      place_[axis] = AxisPlace::known;
  }
  if (words_.has(Extra::ap) || words_.has(Extra::rp)) {
    const PlaneAxes axes = axes_of(plane_);
    place_[static_cast<std::size_t>(axes.first)] = place_[static_cast<std::size_t>(axes.second)] = AxisPlace::known;
  }
}

/// G4 F (seconds) or S (turns of the spindle).
void BlockRunner::dwell() {
  const Slot &f = words_.of('F'), &s = words_.of('S');
  double seconds = 0;
  if (f.given) {
    seconds = f.value;
  } else if (s.given && state_.spindle_speed_rpm > 0) {
    seconds = s.value * 60 / state_.spindle_speed_rpm;
  } else if (s.given) {
    return error(s.offset, "dwell", "G4 S counts turns of the spindle, which has no speed; S was expected before");
  } else {
    return error(words_.offset(), "dwell", "G4 has no time; F in seconds or S in turns was expected");
  }
  if (words_.has_any("XYZ"))
    error(words_.offset(), "dwell", "G4 with X, Y or Z, which it does not move; a block of its own was expected");
  if (!(seconds >= 0))
    return error(words_.offset(), "dwell",
                 fmt::format("a dwell of {:g} s is negative; zero or more was expected", seconds));
  add_move(MoveKind::dwell, position_mm_).dwell_s = seconds;
}

void BlockRunner::position_axis(char letter, const Slot& slot) {
  words_.set(letter) = slot;
  request_.positioned |= 1U << static_cast<unsigned>(letter - 'A');
  editable_ = false;
}

void BlockRunner::move() {
  if (const std::uint32_t positioned = std::exchange(request_.positioned, 0); positioned != 0) {
    // Alone in the block it is a rapid; beside the path two movements would overlap.
    for (const char letter : std::string_view("XYZABC"))
      if (words_.has(letter) && (positioned & 1U << static_cast<unsigned>(letter - 'A')) == 0)
        return error(
            words_.of(letter).offset, "not-supported",
            fmt::format("{} beside POS or POSA, which moves another axis at the same time, is not supported; a "
                        "block of its own was expected",
                        letter));
    const Motion modal = std::exchange(motion_, Motion::rapid);
    move();
    motion_ = modal;
    return;
  }
  const bool axes = words_.has_any("XYZ") || words_.has(Extra::ap) || words_.has(Extra::rp);
  const bool arc = motion_ == Motion::clockwise || motion_ == Motion::counter_clockwise;
  const bool of_arc =
      words_.has_any("IJK") || words_.has(Extra::cr) || words_.has(Extra::ar) || words_.has(Extra::turn);
  if (arc && (axes || of_arc)) return move_on_arc();
  if (arc && rotary_target_) {
    error(words_.offset(), "arc", "a rotary axis alone under G2 or G3; G0 or G1 was expected");
    return;
  }
  if (motion_ == Motion::through_point &&
      (axes || words_.has(Extra::i1) || words_.has(Extra::j1) || words_.has(Extra::k1)))
    return move_through_point();
  if (motion_ == Motion::tangential && axes) return move_tangentially();
  if (axes || rotary_target_) {
    if (of_arc && motion_ <= Motion::linear && !words_.has(Extra::turn))
      report_.warning(words_.offset(), "unused-word", "I, J, K or CR in a block that is no arc is not used",
                      "unused centre");
    move_on_line();
  }
}

void BlockRunner::move_on_line() {
  check_unit();
  settle_axes_for("cutter radius compensation", !(radius_.active && radius_.radius_mm != 0));
  const Vec3 end = target();
  if (motion_ == Motion::rapid) {
    add_move(MoveKind::rapid, end);
  } else if (motion_ == Motion::tapping_in || motion_ == Motion::tapping_out) {
    prepare_cutting("G331");
    const char letter = kCentreLetters[axes_of(plane_).normal];
    const double pitch = std::abs(words_.of(letter).value) * unit_mm();
    editable_ = false;
    if (!(pitch > 0 && state_.spindle_speed_rpm > 0)) {
      error(words_.offset(), "feed-per-turn",
            fmt::format("G331 and G332 need a pitch ({}) and a spindle speed (S)", letter));
      return settle_axes();
    }
    Move& move = add_move(MoveKind::linear, end);
    move.feed_mm_per_s = pitch * state_.spindle_speed_rpm / 60;
    move.canned = true;
    move.cycle = 84;
  } else {
    prepare_cutting("G1");
    const auto feed = cutting_feed((end - position_mm_).norm(), "G1");
    add_move(MoveKind::linear, end).feed_mm_per_s = feed.value_or(0);
  }
  settle_axes();
}

void BlockRunner::go_in_machine_frame() {
  if (!words_.has_any("XYZ") && !rotary_target_) return;
  check_unit();
  if (radius_.active && radius_.radius_mm != 0)
    return error(words_.offset(), "cutter-radius",
                 fmt::format("machine coordinates under G{}; G40 was expected before", radius_.g));
  if (motion_ != Motion::rapid && motion_ != Motion::linear)
    return error(words_.offset(), "machine-frame",
                 "machine coordinates (SUPA, G53, G153) go with G0 or G1; another motion is active");
  Vec3 end = position_mm_, machine_mm = Vec3::Zero();
  std::uint8_t given = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Slot& slot = words_.of(kAxisLetters[axis]);
    if (!slot.given) continue;
    if (slot.dimension == Dimension::incremental) {
      error(slot.offset, "machine-frame",
            "an increment in machine coordinates is not supported; an absolute one was expected");
      continue;
    }
    machine_mm[static_cast<Eigen::Index>(axis)] = slot.value * unit_mm();
    given = static_cast<std::uint8_t>(given | 1U << axis);
    settle_machine_axis(axis, machine_mm[static_cast<Eigen::Index>(axis)], end);
  }
  add_machine_target(machine_mm, given);
  std::optional<double> feed;
  editable_ = false;
  if (motion_ == Motion::linear) feed = cutting_feed((end - position_mm_).norm(), "G1");
  Move& move = add_move(motion_ == Motion::linear ? MoveKind::linear : MoveKind::rapid, end);
  move.feed_mm_per_s = feed.value_or(0);
}

/// G74 or G75 stands in the block, before the word that asks.
bool BlockRunner::goes_to_fixed_point() const {
  return std::ranges::any_of(words_.g, [](const CodeWord& c) { return c.number == 74 || c.number == 75; });
}

/// G74: reference point; G75: a fixed point of the machine. Where they are is not known here.
void BlockRunner::go_to_fixed_point() {
  Vec3 end = position_mm_, machine_mm = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  std::uint8_t given = 0;
  const bool g74 = std::ranges::any_of(words_.g, [](const CodeWord& c) { return c.number == 74; });
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!words_.has(kAxisLetters[axis])) continue;
    const auto i = static_cast<Eigen::Index>(axis);
    end[i] = 0;
    place_[axis] = AxisPlace::reference;
    given = static_cast<std::uint8_t>(given | 1U << axis);
    if (const auto& at = options_.reference_points_mm[0]; at && g74) {
      machine_mm[i] = (*at)[i];
      settle_machine_axis(axis, (*at)[i], end);
    }
  }
  if (given == 0) return;
  add_machine_target(machine_mm, given);
  editable_ = false;
  Move& move = add_move(MoveKind::rapid, end);
  if (g74) move.reference_axes = static_cast<std::uint8_t>(given & 7U);
}

/// Machine coordinates by a variable of the machine's maker (_Z_HOME), which the program does not declare.
void BlockRunner::leave_for_machine_place(char axis, const std::string& name, std::uint32_t offset) {
  report_.warning(offset, "machine-place",
                  fmt::format("{} goes to {}, a variable that the program does not declare; where it is afterwards is "
                              "not known",
                              axis, name),
                  name);
  place_[static_cast<std::size_t>(axis - 'X')] = AxisPlace::reference;
}

/// A place of the machine's own that the program does not give.
void BlockRunner::go_home(const WordRow& row, std::uint32_t offset, const BlockPlace&) {
  report_.warning(
      offset, "machine-place",
      fmt::format(
          "{} ({}) moves the axes to a place that the program does not give; where the tool is afterwards is not known",
          row.name, row.what),
      row.name);
  place_.fill(AxisPlace::reference);
}

void BlockRunner::prepare_cutting(const char* what, bool arc) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const char letter = kAxisLetters[axis];
    if (place_[axis] == AxisPlace::known) continue;
    const Slot& slot = words_.of(letter);
    const bool placed =
        slot.given && (slot.dimension == Dimension::absolute || (slot.dimension == Dimension::as_modal && absolute_));
    if (placed && !(arc && place_[axis] == AxisPlace::never)) {
      if (place_[axis] == AxisPlace::never)
        report_.warning(
            words_.offset(), "start-unknown",
            fmt::format(
                "{} to {} from a place that the program has not given; the move is ignored for material removal", what,
                letter),
            "from nowhere");
      continue;
    }
    if (place_[axis] == AxisPlace::never) {
      report_.warning(
          words_.offset(), "start-unknown",
          fmt::format("{} before {} was programmed; the tool is assumed to be at {}0", what, letter, letter));
      place_[axis] = AxisPlace::known;
    } else {
      report_.warning(words_.offset(), "at-reference",
                      fmt::format("{} while {} is at a machine coordinate; the move is ignored for material removal",
                                  what, letter));
    }
  }
  if (first_cut_offset_ == 0) first_cut_offset_ = state_.work_offset;
  if (state_.work_offset != first_cut_offset_ &&
      !(offsets_.known(state_.work_offset) && offsets_.known(first_cut_offset_)))
    report_.warning(
        words_.offset(), "work-offsets",
        "the program cuts in more than one work offset; their distance is not known, and all are treated as one frame");
}

std::optional<double> BlockRunner::cutting_feed(double length_mm, const char* g) {
  const std::size_t at = request_.motion_given ? request_.motion_offset : words_.offset();
  if (state_.feed_mode == FeedMode::inverse_time && !words_.has('F')) {
    error(at, "feed-missing", fmt::format("{} in inverse time (G93) without F; every cutting block needs its own F", g),
          "G93");
    return std::nullopt;
  }
  if (!feed_) {
    if (!words_.has('F'))
      error(at, "feed-missing",
            fmt::format("{} without a feed; F greater than zero was expected before or in this block", g), "feed");
    return std::nullopt;
  }
  if (*feed_ == 0) {
    error(words_.has('F') ? words_.of('F').offset : at, "feed-zero",
          fmt::format("F0 on a cutting move ({}); the feed must be greater than zero", g), "feed");
    return std::nullopt;
  }
  switch (state_.feed_mode) {
    case FeedMode::inverse_time:
      return *feed_ * length_mm;
    case FeedMode::per_revolution:
      if (state_.spindle_speed_rpm > 0) return *feed_ * state_.spindle_speed_rpm / 60.0;
      error(words_.offset(), "feed-per-turn",
            "a feed per revolution (G95) without a spindle speed; S was expected before", "feed-per-turn");
      return std::nullopt;
    case FeedMode::per_minute:
      break;
  }
  return feed_;
}

// --- arcs

bool BlockRunner::arc_error(const ArcResult& result, const ArcWords& arc) {
  const std::size_t at = request_.motion_given ? request_.motion_offset : words_.offset();
  if (!result.error.empty()) {
    error(at, "arc", in_own_words(result.error));
    return true;
  }
  if (result.radius_difference_mm < kArcRadiusWarningMm) return false;
  // CIRCLE_ERROR_FACTOR: the control accepts a thousandth of the radius.
  const double most = std::max(kArcRadiusErrorMm, 1e-3 * result.start_radius_mm);
  std::string message = fmt::format("the radius of the arc is {:.4f} mm at its start and {:.4f} mm at its end",
                                    result.start_radius_mm, result.end_radius_mm);
  if (result.radius_difference_mm < most) {
    report_.warning(at, "arc-radius",
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
  error(at, "arc-radius", std::move(message));
  return true;
}

void BlockRunner::move_on_arc() {
  check_unit();
  ArcWords arc;
  arc.plane = plane_;
  arc.clockwise = motion_ == Motion::clockwise;
  arc.absolute_centre = true;
  const char* g = arc.clockwise ? "G2" : "G3";
  settle_axes_for("an arc", false);
  prepare_cutting(g, true);
  if (leaving_) {
    error(words_.offset(), "cutter-radius",
          fmt::format("the move off the contour after G40 is an arc ({}); a straight move (G0, G1) was expected", g));
    leaving_ = false;
  }
  const PlaneAxes axes = axes_of(plane_);
  arc.start_mm = programmed();
  const bool polar = words_.has(Extra::ap) || words_.has(Extra::rp);
  Vec3 end = target_in_program();
  // The centre: of I J K, each from the start or absolute; those of the plane that are missing are that of the start.
  const bool centre = words_.has_any("IJK") || (polar && !words_.has(Extra::cr) && !words_.has(Extra::ar));
  std::optional<double>* const of_arc[3] = {&arc.i_mm, &arc.j_mm, &arc.k_mm};
  int absolute_words = 0, relative_words = 0;
  if (centre) {
    for (const int axis : {axes.first, axes.second}) {
      const Slot& slot = words_.of(kCentreLetters[axis]);
      const double start = arc.start_mm[axis];
      if (polar && !words_.has_any("IJK")) {
        *of_arc[axis] = pole_mm_[axis];
        continue;
      }
      *of_arc[axis] = slot.dimension == Dimension::absolute ? slot.value * unit_mm() : start + slot.value * unit_mm();
      if (slot.given) ++(slot.dimension == Dimension::absolute ? absolute_words : relative_words);
    }
    const Slot& across = words_.of(kCentreLetters[axes.normal]);
    if (across.given && across.value != 0)
      error(across.offset, "arc",
            fmt::format("{} does not belong to an arc in this plane; {} and {} were expected",
                        kCentreLetters[axes.normal], kCentreLetters[std::min(axes.first, axes.second)],
                        kCentreLetters[std::max(axes.first, axes.second)]));
    if (absolute_words == 1) editable_ = false;
  }
  if (words_.has(Extra::cr)) arc.r_mm = words_.of(Extra::cr).value * unit_mm();
  if (centre && arc.r_mm) {
    error(words_.of(Extra::cr).offset, "arc", "the arc has both CR and a centre (I, J, K); one of them was expected");
    arc.r_mm.reset();
  }
  if (words_.has(Extra::ar)) {  // the opening angle, with the centre or with the end point
    editable_ = false;
    relied_ends_.add(out_.moves);
    const Slot& ar = words_.of(Extra::ar);
    const double angle = ar.value;
    if (!(angle > 0 && angle < 360)) {
      error(ar.offset, "arc",
            fmt::format("an opening angle AR={:g}; more than 0 and less than 360 degrees was expected", angle));
      return settle_axes();
    }
    const bool has_end = words_.has(kAxisLetters[axes.first]) || words_.has(kAxisLetters[axes.second]) || polar;
    if (centre && !has_end) {
      const Eigen::Matrix3d turn = rotation_in(plane_, rad_from_deg(arc.clockwise ? -angle : angle));
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
  if (words_.has(Extra::turn)) {
    const Slot& turn = words_.of(Extra::turn);
    const double turns = std::trunc(turn.value);
    if (turns != turn.value)
      report_.warning(turn.offset, "arc-turns",
                      fmt::format("TURN={:g} is no whole number; {:g} full turns are taken", turn.value, turns));
    if (!(turns >= 0 && turns <= 999))
      error(turn.offset, "arc-turns", fmt::format("TURN={:g} turns; 0 to 999 was expected", turn.value));
    else
      arc.turns = static_cast<int>(turns) + 1;
  }
  arc.end_mm = end;
  make_arc_move(arc, frame_.from_program(end), g);
}

/// `arc` in program coordinates.
void BlockRunner::make_arc_move(const ArcWords& words, const Vec3& end_in_frame, const char* g) {
  ArcWords arc = words;
  Vec3 end_mm = frame_.plain ? arc.end_mm : end_in_frame;
  if (frame_.shift_only && !words_.uses_extras())
    for (int axis = 0; axis < 3; ++axis)
      if (!words_.has(kAxisLetters[axis])) end_mm[axis] = position_mm_[axis];
  const ArcResult result = make_arc(arc);
  if (result.is_point) {
    const auto feed = cutting_feed((end_mm - position_mm_).norm(), g);
    Move& move = add_move(MoveKind::linear, end_mm);
    move.feed_mm_per_s = feed.value_or(0);
    move.editable = false;
    return settle_axes();
  }
  const auto in_moves = frame_.plain || !result.error.empty() ? result.arc : from_program(frame_, result.arc);
  if (!in_moves)
    error(words_.offset(), "scaling",
          "an arc under a scale that differs along its two axes would be an ellipse; one scale for both was expected");
  if (arc_error(result, arc) || !in_moves) {
    position_mm_ = end_mm;
    return settle_axes();
  }
  out_.arcs.push_back(*in_moves);
  Move& move = add_move(MoveKind::arc, end_mm);
  move.arc = static_cast<std::uint32_t>(out_.arcs.size() - 1);
  if (!words_.has(Extra::cr)) out_.arcs.back().by_radius = false;
  settle_axes();
  move.feed_mm_per_s = cutting_feed(length_mm(out_, move), g).value_or(0);
}

/// CIP: through I1 J1 K1 to the end; anywhere in space.
void BlockRunner::move_through_point() {
  check_unit();
  settle_axes_for("an arc", false);
  prepare_cutting("CIP", true);
  editable_ = false;
  const Vec3 start = programmed(), end = target_in_program();
  Vec3 via = start;
  const Extra extras[3] = {Extra::i1, Extra::j1, Extra::k1};
  for (int axis = 0; axis < 3; ++axis)
    if (const Slot& slot = words_.of(extras[axis]); slot.given) via[axis] = axis_value(slot, start[axis], unit_mm());
  const Vec3 end_mm = frame_.from_program(end);
  const auto fail = [&](std::string message) {
    error(request_.motion_given ? request_.motion_offset : words_.offset(), "arc", std::move(message));
    position_mm_ = end_mm;
    settle_axes();
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
  const auto in_moves = frame_.plain ? arc : from_program(frame_, arc);
  if (!in_moves)
    return fail(
        "an arc under a scale that differs along its two axes would be an ellipse; one scale for both was expected");
  out_.arcs.push_back(*in_moves);
  Move& move = add_move(MoveKind::arc, end_mm);
  move.arc = static_cast<std::uint32_t>(out_.arcs.size() - 1);
  settle_axes();
  move.feed_mm_per_s = cutting_feed(length_mm(out_, move), "CIP").value_or(0);
}

/// The direction in which the last move ended, in program coordinates.
std::optional<Vec3> BlockRunner::last_direction() const {
  for (std::size_t m = out_.moves.size(); m-- > 0;) {
    const Move& move = out_.moves[m];
    if (move.kind == MoveKind::dwell) continue;
    const Vec3 direction = direction_at(out_, move, 1);
    if (direction.norm() < 0.5) continue;
    return Vec3((frame_.inverse * direction).normalized());
  }
  return std::nullopt;
}

/// CT: an arc in the plane that leaves in the direction in which the last move ended.
void BlockRunner::move_tangentially() {
  check_unit();
  settle_axes_for("an arc", false);
  prepare_cutting("CT", true);
  editable_ = false;
  relied_ends_.add_direction(out_.moves);
  const PlaneAxes axes = axes_of(plane_);
  const Vec3 start = programmed(), end = target_in_program(), end_mm = frame_.from_program(end);
  const auto direction = last_direction();
  Vec3 along = direction.value_or(Vec3(Vec3::Zero()));
  along[axes.normal] = 0;
  if (along.norm() < 1e-9) {
    error(words_.offset(), "arc",
          "CT continues the last move, which has no direction in the plane; a move in it was expected before");
    position_mm_ = end_mm;
    return settle_axes();
  }
  along.normalize();
  Vec3 chord = end - start;
  chord[axes.normal] = 0;
  const Vec3 left = normal_of(plane_).cross(along);
  const double across = chord.dot(left), length = chord.norm();
  if (std::abs(across) < 1e-9 * std::max(length, 1.0)) {  // straight on
    if (chord.dot(along) <= 0) {
      error(words_.offset(), "arc",
            "CT would have to turn back on itself; an end beside the direction of the last move was expected");
      position_mm_ = end_mm;
      return settle_axes();
    }
    const auto feed = cutting_feed((end_mm - position_mm_).norm(), "CT");
    add_move(MoveKind::linear, end_mm).feed_mm_per_s = feed.value_or(0);
    return settle_axes();
  }
  const double radius = length * length / (2 * across);  // positive: the centre is on the left
  ArcWords arc;
  arc.plane = plane_;
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
