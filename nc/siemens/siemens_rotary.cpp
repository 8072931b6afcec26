// Rotary axes, tool directions, TRAORI.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/rotary_words.h"
#include "nc/siemens/block_runner.h"

namespace camber::nc::siemens {

constexpr char kAxisLetters[] = "XYZ";

const RotaryOption* BlockRunner::rotary_axis(char letter) const { return rotary_axis_of(options_.rotary_axes, letter); }

void BlockRunner::check_rotary_letter(char letter) {
  const Slot& slot = words_.of(letter);
  if (options_.rotary_axes.empty()) {
    if (slot.value != 0)
      error(slot.offset, "rotary-axis",
            fmt::format(
                "rotary axis {} is read on a machine with [kinematics] (preset:five-axis-trunnion has A and C), by "
                "camber {}; X, Y and Z were expected",
                letter, kReadersOfRotaryAxes),
            std::string(1, letter));
    else
      report_.warning(slot.offset, "rotary-axis",
                      fmt::format("rotary axis {} is not supported; it is assumed to stay at 0", letter),
                      "rotary-zero");
    return;
  }
  std::string axes;
  for (const char known : std::string_view("ABC"))
    if (rotary_axis(known)) axes += fmt::format("{}{}", axes.empty() ? "" : " and ", known);
  error(slot.offset, "rotary-axis",
        fmt::format("{} is not an axis of the machine's chain; {} were expected", letter, axes),
        std::string(1, letter));
}

void BlockRunner::set_tip_control(TipControl control, const char* code, std::uint32_t offset) {
  if (options_.rotary_axes.empty()) {
    // Without rotary axes the tool stands upright, and the transformation changes nothing.
    return;
  }
  if (control != TipControl::off) {
    if (state_.work_frame != WorkFrame::machine)
      error(offset, "tilted-frame",
            fmt::format("{} in a plane that CYCLE800 has swivelled; CYCLE800() was expected before", code));
    if (radius_.active && radius_.radius_mm != 0)
      error(offset, "cutter-radius", fmt::format("{} under G{}; G40 was expected before", code, radius_.g));
  }
  const bool switched = (control == TipControl::off) != (state_.tip_control == TipControl::off);
  if (switched && !out_.moves.empty() && rotary_axes_turned()) open_axes(code);
  state_.tip_control = control;
  change_state();
}

void BlockRunner::read_rotary_words() {
  rotary_target_.reset();
  const bool directed = words_.has(Extra::a3) || words_.has(Extra::b3) || words_.has(Extra::c3);
  if (options_.rotary_axes.empty()) {
    if (!directed) return;
    const Vec3 direction(words_.of(Extra::a3).value, words_.of(Extra::b3).value, words_.of(Extra::c3).value);
    if (direction.x() != 0 || direction.y() != 0 || direction.z() <= 0)
      error(
          words_.offset(), "rotary-axis",
          fmt::format("A3 B3 C3 (tool direction) are read on a machine with [kinematics] (preset:five-axis-trunnion is "
                      "one), by camber {}; a tool along Z was expected",
                      kReadersOfRotaryAxes),
          "A3");
    return;
  }
  if (request_.frame || request_.dwell || request_.limits) return;
  RotaryTarget target;
  target.end = rotary_rad_;
  for (const RotaryOption& axis : options_.rotary_axes)
    if (words_.has(axis.letter)) read_rotary_word(axis, target);
  if (target.given != 0) rotary_target_ = target;
  if (directed) read_tool_direction();
}

void BlockRunner::read_rotary_word(const RotaryOption& axis, RotaryTarget& target) {
  const char letter = axis.letter;
  const Slot& slot = words_.of(letter);
  const auto refuse = [&](std::string_view with) {
    error(slot.offset, "rotary-axis",
          fmt::format("{} {} is not supported; rotary words were expected with G0 to G3 or SUPA", letter, with), with);
  };
  if (radius_.active && radius_.radius_mm != 0) return refuse(fmt::format("under G{}", radius_.g));
  if (state_.work_frame == WorkFrame::tilted && aligned_ && !request_.machine_frame)
    return refuse("in a plane that CYCLE800 has swivelled");
  double& end = target.end[letter - 'A'];
  const double value = rad_from_deg(slot.value);
  const double shift = request_.machine_frame ? 0 : offsets_.rotary_rad(state_.work_offset)[letter - 'A'];
  const bool unknown = (angles_unknown_ & bit_of_axis(letter)) != 0;
  const bool incremental =
      slot.dimension == Dimension::incremental || (slot.dimension == Dimension::as_modal && !absolute_);
  if (incremental) {
    if (unknown)
      error(slot.offset, "rotary-axis",
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
void BlockRunner::read_tool_direction() {
  RotaryTarget target;
  target.is_direction = true;
  target.end = Vec3(words_.of(Extra::a3).value, words_.of(Extra::b3).value, words_.of(Extra::c3).value);
  const double length = target.end.norm();
  if (length < 1e-6)
    return error(words_.offset(), "tool-direction",
                 "A3 B3 C3 of the tool's direction are all zero; a direction was expected");
  if (state_.tip_control == TipControl::off)
    return error(words_.offset(), "tool-direction", "A3 B3 C3 without TRAORI; TRAORI was expected before", "A3");
  if (rotary_target_)
    return error(words_.offset(), "tool-direction", "A3 B3 C3 and rotary axes in one block; one of them was expected",
                 "A3 A");
  target.end = (total_frame().linear * (target.end / length)).normalized();
  direction_code_ = "A3 B3 C3";
  rotary_target_ = target;
}

void BlockRunner::open_axes(std::string cause) {
  open_axes_ = 7;
  start_open_ = true;
  open_cause_ = std::move(cause);
}

void BlockRunner::settle_axes_for(const char* what, bool line) {
  if (open_axes_ == 0) return;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const Slot& slot = words_.of(kAxisLetters[axis]);
    if (!slot.given) continue;
    const bool incremental =
        slot.dimension == Dimension::incremental || (slot.dimension == Dimension::as_modal && !absolute_);
    if ((open_axes_ & (1U << axis)) != 0 && incremental) {
      error(slot.offset, "position-open",
            fmt::format("{0} by increments after {1}, which leaves {0} open; G90 was expected", kAxisLetters[axis],
                        open_cause_));
      open_axes_ = 0;
      return;
    }
    if (line) open_axes_ = static_cast<std::uint8_t>(open_axes_ & ~(1U << axis));
  }
  if (line || open_axes_ == 0) return;
  error(
      words_.offset(), "position-open",
      fmt::format("{} after {} before X, Y and Z were programmed; G0 or G1 with them was expected", what, open_cause_));
  open_axes_ = 0;
}

void BlockRunner::add_rotary_target(std::size_t move) {
  if (!out_.machine_origin_mm) out_.machine_origin_mm = offsets_.machine_origin_mm(state_.work_offset);
  if (!rotary_target_) return;
  const bool turns = rotary_target_->is_direction || (angles_unknown_ & rotary_target_->given) != 0 ||
                     rotary_target_->end != rotary_rad_;
  rotary_target_->move = static_cast<std::uint32_t>(move);
  if (state_.feed_mode == FeedMode::inverse_time && feed_ && *feed_ > 0 && out_.moves[move].kind == MoveKind::linear)
    rotary_target_->time_s = 1 / *feed_;
  out_.rotary.push_back(*rotary_target_);
  if (rotary_target_->is_direction) {
    angles_unknown_ = 7;
  } else {
    rotary_rad_ = rotary_target_->end;
    angles_unknown_ = static_cast<std::uint8_t>(angles_unknown_ & ~rotary_target_->given);
  }
  rotary_target_.reset();
  if (!turns || state_.work_frame == WorkFrame::machine) return;
  if (!open_cause_.starts_with("CYCLE800")) open_axes("rotary axes that turn in this frame");
  out_.moves[move].open_axes = 7;
}

void BlockRunner::add_machine_target(const Vec3& end_mm, std::uint8_t given) {
  if (options_.rotary_axes.empty() || given == 0) return;
  out_.machine_targets.push_back({end_mm, static_cast<std::uint32_t>(out_.moves.size()), given});
  const bool follows = state_.work_frame != WorkFrame::machine || state_.tip_control != TipControl::off;
  if (follows && rotary_axes_turned()) open_axes("machine coordinates");
}

std::uint8_t BlockRunner::open_axes_of_move() const {
  auto open = open_axes_;
  const bool words_count = !request_.frame && !request_.machine_frame && !request_.fixed_point;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const Slot& slot = words_.of(kAxisLetters[axis]);
    const bool absolute = slot.dimension == Dimension::absolute || (slot.dimension == Dimension::as_modal && absolute_);
    const bool given = words_count && slot.given && absolute;
    if (place_[axis] != AxisPlace::known && !given) open = static_cast<std::uint8_t>(open | (1U << axis));
  }
  return open;
}

}  // namespace camber::nc::siemens
