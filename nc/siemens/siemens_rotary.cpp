// Moves from where the tool and the rotary axes stand: tool directions, TRAORI, CYCLE800.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/rotary_words.h"
#include "nc/siemens/siemens_motion.h"

namespace camber::nc::siemens {
namespace {

constexpr char kAxisLetters[] = "XYZ";

Eigen::Matrix3d about(int axis, double angle_deg) {
  return rotation_in(axis == 0 ? Plane::yz : axis == 1 ? Plane::zx : Plane::xy, rad_from_deg(angle_deg));
}

}  // namespace

void Mover::leave_from(const Vec3& beside_mm) {
  beside_mm_ = beside_mm;
  leaving_ = beside_mm != Vec3::Zero();
}

bool Mover::place_unknown() const {
  return std::ranges::any_of(place_, [](AxisPlace p) { return p != AxisPlace::known; });
}

Move& Mover::add_move(MoveKind kind, const Vec3& end_mm) {
  Move move;
  move.start_mm = position_mm_;
  move.end_mm = end_mm;
  move.block = at_.place.called_from;
  move.state = modes_.state_index();
  move.kind = kind;
  move.editable = at_.editable;
  move.exact_stop = at_.request.exact_stop;
  modes_.give_feed_to(move);
  move.reference = kind != MoveKind::dwell && place_unknown();
  if (leaving_) leave_contour(move);
  if (at_.has_rotary_axes() && kind != MoveKind::dwell) {
    move.open_axes = static_cast<std::uint8_t>(open_axes_of_move() & 7U);
    if (rotary_target_ && modes_.state().tip_control != TipControl::off && move.open_axes != 0 &&
        !open_cause_.empty()) {
      at_.error(at_.words.offset(), "position-open",
                fmt::format("rotary axes turn under TRAORI after {}, which leaves the tip open; X, Y and Z in G90 were "
                            "expected before or in this block",
                            open_cause_));
      open_axes_ = move.open_axes = 0;
    }
    move.start_open = start_open_;
    const auto& targets = at_.out.machine_targets;
    start_open_ = move.open_axes != 0 || (!targets.empty() && targets.back().move == at_.out.moves.size());
  }
  position_mm_ = end_mm;
  at_.out.moves.push_back(move);
  if (at_.has_rotary_axes() && kind != MoveKind::dwell) add_rotary_target(at_.out.moves.size() - 1);
  return at_.out.moves.back();
}

void Mover::settle_axes() {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Slot& slot = at_.words.of(kAxisLetters[axis]);
    if (slot.given && at_.is_absolute(slot)) place_[axis] = AxisPlace::known;
  }
  if (at_.words.has(Extra::ap) || at_.words.has(Extra::rp)) {
    const PlaneAxes axes = at_.axes();
    place_[static_cast<std::size_t>(axes.first)] = place_[static_cast<std::size_t>(axes.second)] = AxisPlace::known;
  }
}

void Mover::prepare_cutting(const char* what, bool arc) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const char letter = kAxisLetters[axis];
    if (place_[axis] == AxisPlace::known) continue;
    const Slot& slot = at_.words.of(letter);
    const bool placed = slot.given && at_.is_absolute(slot);
    if (placed && !(arc && place_[axis] == AxisPlace::never)) {
      if (place_[axis] == AxisPlace::never)
        at_.report.warning(
            at_.words.offset(), "start-unknown",
            fmt::format(
                "{} to {} from a place that the program has not given; the move is ignored for material removal", what,
                letter),
            "from nowhere");
      continue;
    }
    if (place_[axis] == AxisPlace::never) {
      at_.report.warning(
          at_.words.offset(), "start-unknown",
          fmt::format("{} before {} was programmed; the tool is assumed to be at {}0", what, letter, letter));
      place_[axis] = AxisPlace::known;
    } else {
      at_.report.warning(at_.words.offset(), "at-reference",
                         fmt::format("{} while {} is at a machine coordinate; the move is ignored for material removal",
                                     what, letter));
    }
  }
  if (first_cut_offset_ == 0) first_cut_offset_ = modes_.state().work_offset;
  if (modes_.state().work_offset != first_cut_offset_ &&
      !(frames_.offsets().known(modes_.state().work_offset) && frames_.offsets().known(first_cut_offset_)))
    at_.report.warning(
        at_.words.offset(), "work-offsets",
        "the program cuts in more than one work offset; their distance is not known, and all are treated as one frame");
}

/// The direction in which the last move ended, in program coordinates.
std::optional<Vec3> Mover::last_direction() const {
  for (std::size_t m = at_.out.moves.size(); m-- > 0;) {
    const Move& move = at_.out.moves[m];
    if (move.kind == MoveKind::dwell) continue;
    const Vec3 direction = direction_at(at_.out, move, 1);
    if (direction.norm() < 0.5) continue;
    return Vec3((frames_.frame().inverse * direction).normalized());
  }
  return std::nullopt;
}

const RotaryOption* Mover::rotary_axis(char letter) const { return rotary_axis_of(at_.options.rotary_axes, letter); }

void Mover::check_rotary_letter(char letter) {
  const Slot& slot = at_.words.of(letter);
  if (!at_.has_rotary_axes()) {
    if (slot.value != 0)
      at_.error(slot.offset, "rotary-axis",
                fmt::format(
                    "rotary axis {} is read on a machine with [kinematics] (preset:five-axis-trunnion has A and C), by "
                    "camber {}; X, Y and Z were expected",
                    letter, kReadersOfRotaryAxes),
                std::string(1, letter));
    else
      at_.report.warning(slot.offset, "rotary-axis",
                         fmt::format("rotary axis {} is not supported; it is assumed to stay at 0", letter),
                         "rotary-zero");
    return;
  }
  std::string axes;
  for (const char known : std::string_view("ABC"))
    if (rotary_axis(known)) axes += fmt::format("{}{}", axes.empty() ? "" : " and ", known);
  at_.error(slot.offset, "rotary-axis",
            fmt::format("{} is not an axis of the machine's chain; {} were expected", letter, axes),
            std::string(1, letter));
}

void Mover::set_tip_control(TipControl control, const char* code, std::uint32_t offset) {
  if (!at_.has_rotary_axes()) {
    // Without rotary axes the tool stands upright, and the transformation changes nothing.
    return;
  }
  if (control != TipControl::off) {
    if (modes_.state().work_frame != WorkFrame::machine)
      at_.error(offset, "tilted-frame",
                fmt::format("{} in a plane that CYCLE800 has swivelled; CYCLE800() was expected before", code));
    at_.refuse_under_radius(offset, code);
  }
  const bool switched = (control == TipControl::off) != (modes_.state().tip_control == TipControl::off);
  if (switched && !at_.out.moves.empty() && turned()) open_all(code);
  modes_.change().tip_control = control;
}

void Mover::read_rotary_words() {
  rotary_target_.reset();
  const bool directed = at_.words.has(Extra::a3) || at_.words.has(Extra::b3) || at_.words.has(Extra::c3);
  if (!at_.has_rotary_axes()) {
    if (!directed) return;
    const Vec3 direction(at_.words.of(Extra::a3).value, at_.words.of(Extra::b3).value, at_.words.of(Extra::c3).value);
    if (direction.x() != 0 || direction.y() != 0 || direction.z() <= 0)
      at_.error(
          at_.words.offset(), "rotary-axis",
          fmt::format("A3 B3 C3 (tool direction) are read on a machine with [kinematics] (preset:five-axis-trunnion is "
                      "one), by camber {}; a tool along Z was expected",
                      kReadersOfRotaryAxes),
          "A3");
    return;
  }
  if (at_.request.frame || at_.request.dwell || at_.request.limits) return;
  RotaryTarget target;
  target.end = rotary_rad_;
  for (const RotaryOption& axis : at_.options.rotary_axes)
    if (at_.words.has(axis.letter)) read_rotary_word(axis, target);
  if (target.given != 0) rotary_target_ = target;
  if (directed) read_tool_direction();
}

void Mover::read_rotary_word(const RotaryOption& axis, RotaryTarget& target) {
  const char letter = axis.letter;
  const Slot& slot = at_.words.of(letter);
  const auto refuse = [&](std::string_view with) {
    at_.error(slot.offset, "rotary-axis",
              fmt::format("{} {} is not supported; rotary words were expected with G0 to G3 or SUPA", letter, with),
              with);
  };
  if (at_.radius.moves_path()) return refuse(fmt::format("under G{}", at_.radius.g));
  if (modes_.state().work_frame == WorkFrame::tilted && aligned_ && !at_.request.machine_frame)
    return refuse("in a plane that CYCLE800 has swivelled");
  double& end = target.end[letter - 'A'];
  const double value = rad_from_deg(slot.value);
  const double shift =
      at_.request.machine_frame ? 0 : frames_.offsets().rotary_rad(modes_.state().work_offset)[letter - 'A'];
  const bool unknown = (angles_unknown_ & bit_of_axis(letter)) != 0;
  const bool incremental = at_.is_incremental(slot);
  if (incremental) {
    if (unknown)
      at_.error(slot.offset, "rotary-axis",
                fmt::format("{} by increments after {}, which leaves its position open; G90 was expected", letter,
                            direction_code_),
                "G91");
    end += value;
  } else {
    const double wanted = value + shift;
    constexpr double kTurn = 2 * kPi, kRounding = 1e-9;
    switch (slot.dimension) {
      case Dimension::nearest:
        end = unknown ? wanted : shortest_way(wanted, end);
        if (unknown) target.shortest = static_cast<std::uint8_t>(target.shortest | bit_of_axis(letter));
        break;
      case Dimension::positive:
        end = wanted + kTurn * std::ceil((end - wanted) / kTurn - kRounding);
        break;
      case Dimension::negative:
        end = wanted + kTurn * std::floor((end - wanted) / kTurn + kRounding);
        break;
      default:
        end = axis.shortest_way && !unknown ? shortest_way(wanted, end) : wanted;
        if (axis.shortest_way && unknown)
          target.shortest = static_cast<std::uint8_t>(target.shortest | bit_of_axis(letter));
    }
  }
  target.given = static_cast<std::uint8_t>(target.given | bit_of_axis(letter));
}

/// A3= B3= C3=: the tool's direction in the part's frame.
void Mover::read_tool_direction() {
  RotaryTarget target;
  target.is_direction = true;
  target.end = Vec3(at_.words.of(Extra::a3).value, at_.words.of(Extra::b3).value, at_.words.of(Extra::c3).value);
  const double length = target.end.norm();
  if (length < 1e-6)
    return at_.error(at_.words.offset(), "tool-direction",
                     "A3 B3 C3 of the tool's direction are all zero; a direction was expected");
  if (modes_.state().tip_control == TipControl::off)
    return at_.error(at_.words.offset(), "tool-direction", "A3 B3 C3 without TRAORI; TRAORI was expected before", "A3");
  if (rotary_target_)
    return at_.error(at_.words.offset(), "tool-direction",
                     "A3 B3 C3 and rotary axes in one block; one of them was expected", "A3 A");
  target.end = (frames_.total().linear * (target.end / length)).normalized();
  direction_code_ = "A3 B3 C3";
  rotary_target_ = target;
}

void Mover::open_all(std::string cause) {
  open_axes_ = 7;
  start_open_ = true;
  open_cause_ = std::move(cause);
}

void Mover::settle_axes_for(const char* what, bool line) {
  if (open_axes_ == 0) return;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const Slot& slot = at_.words.of(kAxisLetters[axis]);
    if (!slot.given) continue;
    const bool incremental = at_.is_incremental(slot);
    if ((open_axes_ & (1U << axis)) != 0 && incremental) {
      at_.error(slot.offset, "position-open",
                fmt::format("{0} by increments after {1}, which leaves {0} open; G90 was expected", kAxisLetters[axis],
                            open_cause_));
      open_axes_ = 0;
      return;
    }
    if (line) open_axes_ = static_cast<std::uint8_t>(open_axes_ & ~(1U << axis));
  }
  if (line || open_axes_ == 0) return;
  at_.error(
      at_.words.offset(), "position-open",
      fmt::format("{} after {} before X, Y and Z were programmed; G0 or G1 with them was expected", what, open_cause_));
  open_axes_ = 0;
}

void Mover::add_rotary_target(std::size_t move) {
  if (!at_.out.machine_origin_mm)
    at_.out.machine_origin_mm = frames_.offsets().machine_origin_mm(modes_.state().work_offset);
  if (!rotary_target_) return;
  const bool turns = rotary_target_->is_direction || (angles_unknown_ & rotary_target_->given) != 0 ||
                     rotary_target_->end != rotary_rad_;
  rotary_target_->move = static_cast<std::uint32_t>(move);
  if (modes_.state().feed_mode == FeedMode::inverse_time && modes_.feed() && *modes_.feed() > 0 &&
      at_.out.moves[move].kind == MoveKind::linear)
    rotary_target_->time_s = 1 / *modes_.feed();
  at_.out.rotary.push_back(*rotary_target_);
  if (rotary_target_->is_direction) {
    angles_unknown_ = 7;
  } else {
    rotary_rad_ = rotary_target_->end;
    angles_unknown_ = static_cast<std::uint8_t>(angles_unknown_ & ~rotary_target_->given);
  }
  rotary_target_.reset();
  if (!turns || modes_.state().work_frame == WorkFrame::machine) return;
  if (!open_cause_.starts_with("CYCLE800")) open_all("rotary axes that turn in this frame");
  at_.out.moves[move].open_axes = 7;
}

void Mover::add_machine_target(const Vec3& end_mm, std::uint8_t given) {
  if (!at_.has_rotary_axes() || given == 0) return;
  at_.out.machine_targets.push_back({end_mm, static_cast<std::uint32_t>(at_.out.moves.size()), given});
  const bool follows = modes_.state().work_frame != WorkFrame::machine || modes_.state().tip_control != TipControl::off;
  if (follows && turned()) open_all("machine coordinates");
}

std::uint8_t Mover::open_axes_of_move() const {
  auto open = open_axes_;
  const bool words_count = !at_.request.frame && !at_.request.machine_frame && !at_.request.fixed_point;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const Slot& slot = at_.words.of(kAxisLetters[axis]);
    const bool absolute = at_.is_absolute(slot);
    const bool given = words_count && slot.given && absolute;
    if (place_[axis] != AxisPlace::known && !given) open = static_cast<std::uint8_t>(open | (1U << axis));
  }
  return open;
}

/// CYCLE800(_FR, _TC, _ST, _MODE, _X0, _Y0, _Z0, _A, _B, _C, _X1, _Y1, _Z1, _DIR, _FR_I, _DMODE): a plane is swivelled.
/// Without parameters, or with the data set "0": back. _MODE: bits 6 and 7 say how the angles count (0: axis by axis,
/// 1: solid angle, 2: projection angle, 3: the rotary axes directly); the pairs of bits below, which axis is turned
/// first, second and third (1: X, 2: Y, 3: Z). _ST: digit 1 (ones): a new plane (0) or one that adds (1).
void Mover::swivel(const CycleCall& call) {
  const std::size_t at = call.offset;
  if (at_.refuse_under_radius(at, "CYCLE800")) return;
  if (modes_.state().tip_control != TipControl::off)
    return at_.error(at, "tilted-frame", "CYCLE800 under TRAORI; TRAFOOF was expected before");
  const bool back =
      call.text(1) == "0" || std::ranges::none_of(call.values, [](const auto& v) { return v.has_value(); });
  const int st = static_cast<int>(call.number(2)), mode = static_cast<int>(call.number(3));
  const bool additive = st % 10 == 1 && frames_.swivelled();
  const Vec3 before_mm(call.number(4), call.number(5), call.number(6)),
      angle(call.number(7), call.number(8), call.number(9)),
      behind_mm(call.number(10), call.number(11), call.number(12));
  Affine own;
  own.shift_mm = before_mm * modes_.unit_mm();
  const int kind = mode >> 6 & 3;
  if (!back) {
    if (kind == 0) {
      for (int i = 0; i < 3; ++i) {
        const int axis = (mode >> (2 * i) & 3) - 1;
        if (axis >= 0) own.linear = own.linear * about(axis, angle[i]);
      }
    } else if (angle != Vec3::Zero()) {
      return at_.error(
          at, "not-supported",
          fmt::format(
              "CYCLE800 with {} (mode {}) is not supported; angles axis by axis (mode 57, 27, 39 ...) were expected",
              kind == 1   ? "solid angles"
              : kind == 2 ? "projection angles"
                          : "rotary axes given directly",
              mode));
    }
    own.shift_mm += own.linear * behind_mm * modes_.unit_mm();
  }
  const std::optional<Affine> plane =
      back ? std::nullopt : std::optional(additive ? frames_.swivelled()->then_inside(own) : own);
  const bool tilted = plane && plane->linear != Eigen::Matrix3d::Identity();
  const bool refused = tilted && !at_.has_rotary_axes();
  if (refused)
    at_.error(
        at, "not-read",
        fmt::format("CYCLE800 (plane swivelled by {:g}, {:g}, {:g} degrees) is read on a machine with [kinematics], by "
                    "camber check, time, feed, fit-feed, predict, compensate and post",
                    angle.x(), angle.y(), angle.z()),
        "CYCLE800");
  frames_.set_swivelled(refused ? std::nullopt : plane);
  if (!at_.has_rotary_axes()) return;
  const WorkFrame frame = tilted ? WorkFrame::tilted : WorkFrame::machine;
  const bool turns = tilted || aligned_ || modes_.state().work_frame != WorkFrame::machine || turned();
  modes_.change().work_frame = frame;
  const int direction = static_cast<int>(call.number(13));
  if (!turns || (!back && direction == 0)) {  // 0: the frame alone, no motion
    if (!at_.out.moves.empty() && turned()) open_all("CYCLE800");
    return;
  }
  RotaryTarget target;
  target.is_direction = true;
  direction_code_ = "CYCLE800";
  target.end = frames_.frame().linear.col(2).normalized();
  if (!tilted) {  // back: the rotary axes go to zero
    target.is_direction = false;
    target.end = Vec3::Zero();
    for (const RotaryOption& axis : at_.options.rotary_axes)
      target.given = static_cast<std::uint8_t>(target.given | 1U << (axis.letter - 'A'));
  }
  rotary_target_ = target;
  aligned_ = tilted;
  open_all("CYCLE800");
  modes_.check_unit();
  Move& move = add_move(MoveKind::rapid, position_mm_);
  move.editable = false;
}

void Mover::settle_machine_axis(std::size_t axis, double machine_mm, Vec3& place_mm) {
  const auto index = static_cast<Eigen::Index>(axis);
  place_mm[index] = machine_mm;
  place_[axis] = AxisPlace::reference;
  if (axis == 2) return;  // the height needs the tool's length
  if (const auto origin = frames_.offsets().machine_origin_mm(modes_.state().work_offset)) {
    place_mm[index] = machine_mm + (*origin)[index];
    place_[axis] = AxisPlace::known;
  }
}

/// The first move in the plane after G40 starts beside the contour and ends on it.
void Mover::leave_contour(Move& move) {
  move.start_mm += beside_mm_;
  move.editable = false;
  const PlaneAxes axes = at_.axes();
  constexpr char kLetters[] = "XYZ";
  const bool in_plane = at_.words.has(kLetters[axes.first]) || at_.words.has(kLetters[axes.second]);
  if (move.kind == MoveKind::dwell || !in_plane)
    move.end_mm += beside_mm_;
  else
    leaving_ = false;
}

std::optional<double> Mover::rotary_rad(char letter) const {
  return rotary_axis(letter) && angles_unknown_ == 0 ? std::optional(rotary_rad_[letter - 'A']) : std::nullopt;
}

}  // namespace camber::nc::siemens
