// Words and codes of rotary axes: A B C, tool-centre-point control, clamps.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/block_interpreter.h"
#include "nc/rotary_words.h"

namespace camber::nc {
namespace {

constexpr char kLetters[] = "ABC";
}  // namespace

const RotaryOption* BlockInterpreter::rotary_axis(char letter) const {
  return rotary_axis_of(options_.rotary_axes, letter);
}

// --- clamps

/// True for an M code that clamps or releases an axis of the machine.
bool BlockInterpreter::read_clamp(const Code& code) {
  bool found = false;
  for (const RotaryOption& axis : options_.rotary_axes) {
    if (axis.clamp_m == 0 || (code.tenths != 10 * axis.clamp_m && code.tenths != 10 * axis.unclamp_m)) continue;
    if (code.tenths == 10 * axis.clamp_m)
      clamped_ = static_cast<std::uint8_t>(clamped_ | bit_of_axis(axis.letter));
    else
      clamped_ = static_cast<std::uint8_t>(clamped_ & ~bit_of_axis(axis.letter));
    found = true;
  }
  if (found) add_event(EventKind::m_code, code.word->value);
  return found;
}

// --- tool-centre-point control

/// M428, M429; false for every other code.
bool BlockInterpreter::read_tip_control_m(const Code& code) {
  const Dialect dialect = options_.dialect_or_default();
  if (options_.rotary_axes.empty() || dialect.tip_control_on_m == 0) return false;
  if (code.tenths == 10 * dialect.tip_control_on_m)
    set_tip_control(TipControl::angles, code);
  else if (code.tenths == 10 * dialect.tip_control_off_m)
    set_tip_control(TipControl::off, code);
  else
    return false;
  add_event(EventKind::m_code, code.word->value);
  return true;
}

void BlockInterpreter::set_tip_control(TipControl control, const Code& code) {
  if (control != TipControl::off) {
    if (state_.work_frame != WorkFrame::machine)
      error(code.word->offset, "tilted-frame",
            fmt::format("{} while {} is active; {} was expected before", code_text(code),
                        state_.work_frame == WorkFrame::tilted ? "a tilted frame" : "the dynamic work offset (G254)",
                        state_.work_frame == WorkFrame::tilted ? "G69" : "G255"));
    // On a control that switches by M codes the tool length is none (0) without G43.
    if (!tool_length_active_ && code.word->letter == 'M')
      report_.warning(code.word->offset, "tool-length",
                      fmt::format("{} without G43: tool-centre-point control with a tool length of 0", code_text(code)),
                      "M without G43");
    else if (!tool_length_active_)
      error(
          code.word->offset, "tool-length",
          fmt::format("{} switches tool-centre-point control on without a tool length; H with its number was expected",
                      code_text(code)));
    if (radius_.active)
      error(code.word->offset, "cutter-radius",
            fmt::format("{} under G{}; G40 was expected before", code_text(code), radius_.g_tenths / 10));
  }
  const bool switched = (control == TipControl::off) != (state_.tip_control == TipControl::off);
  // X Y Z of where the tool is change their meaning.
  if (switched && !out_.moves.empty() && rotary_axes_turned()) open_axes(code_text(code));
  state_.tip_control = control;
  state_changed_ = true;
}

/// G43.4, G43.5, G234, and what G43, G44, G49 are to them.
void BlockInterpreter::set_tip_control_g(const Code& code) {
  if (options_.rotary_axes.empty()) {
    const bool g = code.tenths == 434 || code.tenths == 435 || code.tenths == 2340;
    if (g) error(code.word->offset, "not-read", needs_kinematics(code, "tool-centre-point control"), code_text(code));
    return;
  }
  if (code.tenths == 490) {
    tool_length_active_ = false;
    state_.tool_length_mm = 0;
    set_tip_control(TipControl::off, code);
    return;
  }
  if (words_.has('H') || options_.dialect_or_default().tip_control_on_m != 0) read_tool_length(code);
  if (code.tenths == 434 || code.tenths == 2340)
    set_tip_control(TipControl::angles, code);
  else if (code.tenths == 435)
    set_tip_control(TipControl::directions, code);
  else if (options_.dialect_or_default().tip_control_on_m == 0)  // there, G43 leaves the kinematics as it is
    set_tip_control(TipControl::off, code);
}

/// The length of H, or of the tool in the spindle.
void BlockInterpreter::read_tool_length(const Code& code) {
  const double number = words_.has('H') ? words_.value('H') : state_.tool;
  tool_length_active_ = true;
  state_.tool_length_mm.reset();
  if (number != std::floor(number) || number < 0 || number > 1e6) {
    error(words_.offset_of('H'), "tool-length",
          fmt::format("H{} is not an offset number; a whole number of zero or more was expected", number));
    return;
  }
  const auto found = tool_offsets_.find(static_cast<int>(number));
  if (number == 0 && found == tool_offsets_.end()) {  // no offset, on every control
    state_.tool_length_mm = 0;
    return;
  }
  if (found == tool_offsets_.end() || !found->second.length_mm) return;
  const double length = *found->second.length_mm + found->second.length_wear_mm.value_or(0);
  state_.tool_length_mm = code.tenths == 440 ? -length : length;
}

// --- words

/// Returns what keeps rotary words from being read in this block; empty: nothing.
std::string BlockInterpreter::refuses_rotary() const {
  if (request_.dwell && !options_.dialect_or_default().dwell_takes_p_alone) return "G4";
  if (request_.frame_code.word) return code_text(request_.frame_code);
  if (request_.return_from_reference) return "G29";
  if (request_.reference || request_.machine_frame) return {};
  if (request_.single_direction) return "G60";
  if (radius_.active) return fmt::format("G{} active", radius_.g_tenths / 10);  // its path gets other moves
  if (state_.work_frame == WorkFrame::tilted && aligned_) return "a tilted frame (G68.2) after G53.1";
  if (state_.work_frame == WorkFrame::tilted && words_.has_any("XYZ")) return "X, Y or Z in a tilted frame (G68.2)";
  if (state_.work_frame == WorkFrame::dynamic && words_.has_any("XYZ")) return "X, Y or Z under G254";
  if (cycle_.g != 0 && state_.tip_control != TipControl::off)
    return fmt::format("the drilling cycle G{} under tool-centre-point control", cycle_.g);
  return {};
}

void BlockInterpreter::read_rotary_words() {
  rotary_target_.reset();
  if (options_.rotary_axes.empty() || request_.skip_motion) return;
  RotaryTarget target;
  target.end = rotary_rad_;
  for (const RotaryOption& axis : options_.rotary_axes)
    if (words_.has(axis.letter)) read_rotary_word(axis, target);
  if (target.given != 0) rotary_target_ = target;
  const bool line = motion_ == Motion::rapid || motion_ == Motion::linear;
  if (state_.tip_control == TipControl::directions && line && words_.has_any("IJK")) read_tool_direction();
}

void BlockInterpreter::read_rotary_word(const RotaryOption& axis, RotaryTarget& target) {
  const char letter = axis.letter;
  const double value_rad = rad_from_deg(words_.value(letter));
  const std::size_t offset = words_.offset_of(letter);
  const std::string with = refuses_rotary();
  if (!with.empty()) {
    if (!sets_rotary_offset())
      error(offset, "rotary-axis",
            fmt::format("{} in a block with {} is not supported; rotary words were expected with G0 to G3, G28, G30, "
                        "G53 or a drilling cycle",
                        letter, with),
            with);
    return;
  }
  if (state_.tip_control == TipControl::directions) {
    error(offset, "rotary-axis",
          fmt::format("{} under G43.5; I, J and K of the tool's direction were expected", letter), "G43.5");
    return;
  }
  double& end = target.end[letter - 'A'];
  const double shift_rad = request_.machine_frame ? 0 : frames_.offsets.rotary_rad(state_.work_offset)[letter - 'A'];
  const bool unknown = (angles_unknown_ & bit_of_axis(letter)) != 0;
  if (state_.incremental && unknown && !(request_.reference && value_rad == 0))
    error(offset, "rotary-axis",
          fmt::format("{} in G91 after {}, which leaves its position open; G90 was expected", letter, direction_code_),
          "G91");
  if (state_.incremental)
    end += value_rad;
  else
    end = axis.shortest_way && !unknown ? shortest_way(value_rad + shift_rad, end) : value_rad + shift_rad;
  if (axis.shortest_way && unknown && !state_.incremental)
    target.shortest = static_cast<std::uint8_t>(target.shortest | bit_of_axis(letter));
  target.given = static_cast<std::uint8_t>(target.given | bit_of_axis(letter));
  if ((clamped_ & bit_of_axis(letter)) != 0 && end != rotary_rad_[letter - 'A'])
    error(
        offset, "clamped",
        fmt::format("{} turns while M{} has it clamped; M{} was expected before", letter, axis.clamp_m, axis.unclamp_m),
        "clamped");
}

/// I J K under G43.5.
void BlockInterpreter::read_tool_direction() {
  RotaryTarget target;
  target.is_direction = true;
  for (int i = 0; i < 3; ++i) {
    const char letter = "IJK"[i];
    if (words_.has(letter)) target.end[i] = words_.value(letter);
  }
  const double length = target.end.norm();
  if (length < 1e-6) {
    error(words_.offset_of(words_.has('I')   ? 'I'
                           : words_.has('J') ? 'J'
                                             : 'K'),
          "tool-direction", "I J K of the tool's direction are all zero; a direction was expected");
    return;
  }
  target.end /= length;
  direction_code_ = "G43.5";
  rotary_target_ = target;
}

/// Returns the message for a code that turns rotary axes on a machine without them.
std::string BlockInterpreter::needs_kinematics(const Code& code, const char* name) const {
  return fmt::format("{} ({}) is read on a machine with [kinematics], by camber {}", code_text(code), name,
                     kReadersOfRotaryAxes);
}

/// G10 L2 A B C.
bool BlockInterpreter::sets_rotary_offset() const {
  return request_.frame_code.word && request_.frame_code.tenths == 100 && words_.has('L') &&
         words_.word('L').value == 2;
}

/// G28, G30: the rotary axes of the block, or all, go to the reference point.
void BlockInterpreter::turn_home(bool all, std::uint8_t letters, const Vec3& home_rad) {
  RotaryTarget target;
  target.end = rotary_rad_;
  for (const RotaryOption& axis : options_.rotary_axes)
    if (all || (letters & bit_of_axis(axis.letter)) != 0) {
      target.end[axis.letter - 'A'] = home_rad[axis.letter - 'A'];
      target.given = static_cast<std::uint8_t>(target.given | bit_of_axis(axis.letter));
    }
  if (target.given != 0 && ((angles_unknown_ & target.given) != 0 || target.end != rotary_rad_))
    rotary_target_ = target;
}

/// The rotary words of the block belong to its last move.
void BlockInterpreter::add_rotary_target(std::size_t move) {
  if (!out_.machine_origin_mm) out_.machine_origin_mm = frames_.offsets.machine_origin_mm(state_.work_offset);
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
  if (!turns || state_.work_frame == WorkFrame::machine || request_.frame_code.word) return;
  // The linear axes stay while the frame turns under the tool.
  open_axes("rotary axes that turn in this frame");
  out_.moves[move].open_axes = 7;
}

void BlockInterpreter::check_rotary_letter(char letter) {
  if (options_.rotary_axes.empty()) {
    if (words_.value(letter) != 0)
      error(words_.offset_of(letter), "rotary-axis",
            fmt::format("rotary axis {} is read on a machine with [kinematics], by camber {}; X, Y and Z were expected",
                        letter, kReadersOfRotaryAxes),
            std::string(1, letter));
    else
      report_.warning(words_.offset_of(letter), "rotary-axis",
                      fmt::format("rotary axis {} is not supported; it is assumed to stay at 0", letter),
                      "rotary-zero");
    return;
  }
  std::string axes;
  for (const char known : std::string_view(kLetters))
    if (rotary_axis(known)) axes += fmt::format("{}{}", axes.empty() ? "" : " and ", known);
  words_.value(letter);
  error(words_.offset_of(letter), "rotary-axis",
        fmt::format("{} is not an axis of the machine's chain; {} were expected", letter, axes),
        std::string(1, letter));
}

}  // namespace camber::nc
