#include "nc/rotary_codes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/rotary_words.h"

namespace camber::nc {
namespace {

constexpr char kRotaryLetters[] = "ABC";

}  // namespace

const RotaryOption* RotaryCodes::rotary_axis(char letter) const {
  return rotary_axis_of(at_.options.rotary_axes, letter);
}

void RotaryCodes::check_letters() {
  for (const char letter : {'A', 'B', 'C'}) {
    if (!at_.words.has(letter)) continue;
    if (letter == 'B' && at_.options.index_table)
      modal_.add_event(EventKind::index, at_.words.value(letter));
    else if (!rotary_axis(letter))
      check_rotary_letter(letter);
  }
  for (const char letter : {'V', 'W', 'U'}) {
    if (!at_.words.has(letter) || (letter == 'U' && at_.request.dwell)) continue;
    at_.error(at_.words.offset_of(letter), "unknown-letter",
              fmt::format("axis {} is not supported; X, Y and Z were expected", letter), std::string(1, letter));
    at_.words.use("UVW");
  }
}

void RotaryCodes::check_rotary_letter(char letter) {
  if (at_.options.rotary_axes.empty()) {
    if (at_.words.value(letter) != 0)
      at_.error(
          at_.words.offset_of(letter), "rotary-axis",
          fmt::format("rotary axis {} is read on a machine with [kinematics], by camber {}; X, Y and Z were expected",
                      letter, kReadersOfRotaryAxes),
          std::string(1, letter));
    else
      at_.report.warning(at_.words.offset_of(letter), "rotary-axis",
                         fmt::format("rotary axis {} is not supported; it is assumed to stay at 0", letter),
                         "rotary-zero");
    return;
  }
  std::string axes;
  for (const char known : std::string_view(kRotaryLetters))
    if (rotary_axis(known)) axes += fmt::format("{}{}", axes.empty() ? "" : " and ", known);
  at_.words.value(letter);
  at_.error(at_.words.offset_of(letter), "rotary-axis",
            fmt::format("{} is not an axis of the machine's chain; {} were expected", letter, axes),
            std::string(1, letter));
}

/// True for an M code that clamps or releases an axis of the machine.
bool RotaryCodes::read_clamp(const Code& code) {
  bool found = false;
  for (const RotaryOption& axis : at_.options.rotary_axes) {
    if (axis.clamp_m == 0 || (code.tenths != 10 * axis.clamp_m && code.tenths != 10 * axis.unclamp_m)) continue;
    if (code.tenths == 10 * axis.clamp_m)
      clamped_ = static_cast<std::uint8_t>(clamped_ | bit_of_axis(axis.letter));
    else
      clamped_ = static_cast<std::uint8_t>(clamped_ & ~bit_of_axis(axis.letter));
    found = true;
  }
  if (found) modal_.add_event(EventKind::m_code, code.word->value);
  return found;
}

/// M428, M429; false for every other code.
bool RotaryCodes::read_tip_control_m(const Code& code) {
  const Dialect dialect = at_.dialect();
  if (at_.options.rotary_axes.empty() || dialect.tip_control_on_m == 0) return false;
  if (code.tenths == 10 * dialect.tip_control_on_m)
    set_tip_control(TipControl::angles, code);
  else if (code.tenths == 10 * dialect.tip_control_off_m)
    set_tip_control(TipControl::off, code);
  else
    return false;
  modal_.add_event(EventKind::m_code, code.word->value);
  return true;
}

void RotaryCodes::set_tip_control(TipControl control, const Code& code) {
  if (control != TipControl::off) {
    if (modal_.state().work_frame != WorkFrame::machine)
      at_.error(code.word->offset, "tilted-frame",
                fmt::format("{} while {} is active; {} was expected before", at_.code_text(code),
                            modal_.state().work_frame == WorkFrame::tilted ? "a tilted frame"
                                                                           : "the dynamic work offset (G254)",
                            modal_.state().work_frame == WorkFrame::tilted ? "G69" : "G255"));
    // On a control that switches by M codes the tool length is none (0) without G43.
    if (!tool_length_active_ && code.word->letter == 'M')
      at_.report.warning(
          code.word->offset, "tool-length",
          fmt::format("{} without G43: tool-centre-point control with a tool length of 0", at_.code_text(code)),
          "M without G43");
    else if (!tool_length_active_)
      at_.error(
          code.word->offset, "tool-length",
          fmt::format("{} switches tool-centre-point control on without a tool length; H with its number was expected",
                      at_.code_text(code)));
    if (modal_.radius_g() != 0)
      at_.error(code.word->offset, "cutter-radius",
                fmt::format("{} under G{}; G40 was expected before", at_.code_text(code), modal_.radius_g()));
  }
  const bool switched = (control == TipControl::off) != (modal_.state().tip_control == TipControl::off);
  // X Y Z of where the tool is change their meaning.
  if (switched && !at_.out.moves.empty() && rotary_axes_turned()) open_axes(at_.code_text(code));
  modal_.change().tip_control = control;
}

void RotaryCodes::set_tool_length(const Code& code) {
  at_.words.use("H");
  if (code.tenths == 431) at_.words.use("IJK");
  set_tip_control_g(code);
}

/// G43.4, G43.5, G234, and what G43, G44, G49 are to them.
void RotaryCodes::set_tip_control_g(const Code& code) {
  if (at_.options.rotary_axes.empty()) {
    const bool g = code.tenths == 434 || code.tenths == 435 || code.tenths == 2340;
    if (g)
      at_.error(code.word->offset, "not-read", needs_kinematics(code, "tool-centre-point control"),
                at_.code_text(code));
    return;
  }
  if (code.tenths == 490) {
    tool_length_active_ = false;
    modal_.change().tool_length_mm = 0;
    set_tip_control(TipControl::off, code);
    return;
  }
  if (at_.words.has('H') || at_.dialect().tip_control_on_m != 0) read_tool_length(code);
  if (code.tenths == 434 || code.tenths == 2340)
    set_tip_control(TipControl::angles, code);
  else if (code.tenths == 435)
    set_tip_control(TipControl::directions, code);
  else if (at_.dialect().tip_control_on_m == 0)  // there, G43 leaves the kinematics as it is
    set_tip_control(TipControl::off, code);
}

/// The length of H, or of the tool in the spindle.
void RotaryCodes::read_tool_length(const Code& code) {
  const double number = at_.words.has('H') ? at_.words.value('H') : modal_.state().tool;
  tool_length_active_ = true;
  modal_.change().tool_length_mm.reset();
  if (number != std::floor(number) || number < 0 || number > 1e6) {
    at_.error(at_.words.offset_of('H'), "tool-length",
              fmt::format("H{} is not an offset number; a whole number of zero or more was expected", number));
    return;
  }
  const ToolOffset* found = frames_.tool_offset(static_cast<int>(number));
  if (number == 0 && !found) {  // no offset, on every control
    modal_.change().tool_length_mm = 0;
    return;
  }
  if (!found || !found->length_mm) return;
  const double length = *found->length_mm + found->length_wear_mm.value_or(0);
  modal_.change().tool_length_mm = code.tenths == 440 ? -length : length;
}

/// Returns what keeps rotary words from being read in this block; empty: nothing.
std::string RotaryCodes::refuses_rotary() const {
  if (at_.request.dwell && !at_.dialect().dwell_takes_p_alone) return "G4";
  if (at_.request.frame_code.word) return at_.code_text(at_.request.frame_code);
  if (at_.request.return_from_reference) return "G29";
  if (at_.request.reference || at_.request.machine_frame) return {};
  if (at_.request.single_direction) return "G60";
  if (modal_.radius_g() != 0) return fmt::format("G{} active", modal_.radius_g());  // its path gets other moves
  if (modal_.state().work_frame == WorkFrame::tilted && aligned_) return "a tilted frame (G68.2) after G53.1";
  if (modal_.state().work_frame == WorkFrame::tilted && at_.words.has_any("XYZ"))
    return "X, Y or Z in a tilted frame (G68.2)";
  if (modal_.state().work_frame == WorkFrame::dynamic && at_.words.has_any("XYZ")) return "X, Y or Z under G254";
  if (modal_.cycle_g() != 0 && modal_.state().tip_control != TipControl::off)
    return fmt::format("the drilling cycle G{} under tool-centre-point control", modal_.cycle_g());
  return {};
}

void RotaryCodes::read_rotary_words() {
  rotary_target_.reset();
  if (at_.options.rotary_axes.empty() || at_.request.skip_motion) return;
  RotaryTarget target;
  target.end = rotary_rad_;
  for (const RotaryOption& axis : at_.options.rotary_axes)
    if (at_.words.has(axis.letter)) read_rotary_word(axis, target);
  if (target.given != 0) rotary_target_ = target;
  const bool line = modal_.motion() == MotionCode::rapid || modal_.motion() == MotionCode::linear;
  if (modal_.state().tip_control == TipControl::directions && line && at_.words.has_any("IJK")) read_tool_direction();
}

void RotaryCodes::read_rotary_word(const RotaryOption& axis, RotaryTarget& target) {
  const char letter = axis.letter;
  const double value_rad = rad_from_deg(at_.words.value(letter));
  const std::size_t offset = at_.words.offset_of(letter);
  const std::string with = refuses_rotary();
  if (!with.empty()) {
    if (!sets_rotary_offset())
      at_.error(
          offset, "rotary-axis",
          fmt::format("{} in a block with {} is not supported; rotary words were expected with G0 to G3, G28, G30, "
                      "G53 or a drilling cycle",
                      letter, with),
          with);
    return;
  }
  if (modal_.state().tip_control == TipControl::directions) {
    at_.error(offset, "rotary-axis",
              fmt::format("{} under G43.5; I, J and K of the tool's direction were expected", letter), "G43.5");
    return;
  }
  double& end = target.end[letter - 'A'];
  const double shift_rad = at_.request.machine_frame ? 0 : frames_.rotary_offset_rad()[letter - 'A'];
  const bool unknown = (angles_unknown_ & bit_of_axis(letter)) != 0;
  if (modal_.state().incremental && unknown && !(at_.request.reference && value_rad == 0))
    at_.error(
        offset, "rotary-axis",
        fmt::format("{} in G91 after {}, which leaves its position open; G90 was expected", letter, direction_code_),
        "G91");
  if (modal_.state().incremental)
    end += value_rad;
  else
    end = axis.shortest_way && !unknown ? shortest_way(value_rad + shift_rad, end) : value_rad + shift_rad;
  if (axis.shortest_way && unknown && !modal_.state().incremental)
    target.shortest = static_cast<std::uint8_t>(target.shortest | bit_of_axis(letter));
  target.given = static_cast<std::uint8_t>(target.given | bit_of_axis(letter));
  if ((clamped_ & bit_of_axis(letter)) != 0 && end != rotary_rad_[letter - 'A'])
    at_.error(
        offset, "clamped",
        fmt::format("{} turns while M{} has it clamped; M{} was expected before", letter, axis.clamp_m, axis.unclamp_m),
        "clamped");
}

/// I J K under G43.5.
void RotaryCodes::read_tool_direction() {
  RotaryTarget target;
  target.is_direction = true;
  for (int i = 0; i < 3; ++i) {
    const char letter = "IJK"[i];
    if (at_.words.has(letter)) target.end[i] = at_.words.value(letter);
  }
  const double length = target.end.norm();
  if (length < 1e-6) {
    at_.error(at_.words.offset_of(at_.words.has('I')   ? 'I'
                                  : at_.words.has('J') ? 'J'
                                                       : 'K'),
              "tool-direction", "I J K of the tool's direction are all zero; a direction was expected");
    return;
  }
  target.end /= length;
  direction_code_ = "G43.5";
  rotary_target_ = target;
}

/// Returns the message for a code that turns rotary axes on a machine without them.
std::string RotaryCodes::needs_kinematics(const Code& code, const char* name) const {
  return fmt::format("{} ({}) is read on a machine with [kinematics], by camber {}", at_.code_text(code), name,
                     kReadersOfRotaryAxes);
}

/// G10 L2 A B C.
bool RotaryCodes::sets_rotary_offset() const {
  return at_.request.frame_code.word && at_.request.frame_code.tenths == 100 && at_.words.has('L') &&
         at_.words.word('L').value == 2;
}

/// G28, G30: the rotary axes of the block, or all, go to the reference point.
void RotaryCodes::turn_home(bool all, std::uint8_t letters, const Vec3& home_rad) {
  RotaryTarget target;
  target.end = rotary_rad_;
  for (const RotaryOption& axis : at_.options.rotary_axes)
    if (all || (letters & bit_of_axis(axis.letter)) != 0) {
      target.end[axis.letter - 'A'] = home_rad[axis.letter - 'A'];
      target.given = static_cast<std::uint8_t>(target.given | bit_of_axis(axis.letter));
    }
  if (target.given != 0 && ((angles_unknown_ & target.given) != 0 || target.end != rotary_rad_))
    rotary_target_ = target;
}

/// The rotary words of the block belong to its last move.
void RotaryCodes::add_rotary_target(std::size_t move) {
  if (!at_.out.machine_origin_mm) at_.out.machine_origin_mm = frames_.machine_origin_mm();
  if (!rotary_target_) return;
  const bool turns = rotary_target_->is_direction || (angles_unknown_ & rotary_target_->given) != 0 ||
                     rotary_target_->end != rotary_rad_;
  rotary_target_->move = static_cast<std::uint32_t>(move);
  if (modal_.state().feed_mode == FeedMode::inverse_time && modal_.feed() && *modal_.feed() > 0 &&
      at_.out.moves[move].kind == MoveKind::linear)
    rotary_target_->time_s = 1 / *modal_.feed();
  at_.out.rotary.push_back(*rotary_target_);
  if (rotary_target_->is_direction) {
    angles_unknown_ = 7;
  } else {
    rotary_rad_ = rotary_target_->end;
    angles_unknown_ = static_cast<std::uint8_t>(angles_unknown_ & ~rotary_target_->given);
  }
  rotary_target_.reset();
  if (!turns || modal_.state().work_frame == WorkFrame::machine || at_.request.frame_code.word) return;
  // The linear axes stay while the frame turns under the tool.
  open_axes("rotary axes that turn in this frame");
  at_.out.moves[move].open_axes = 7;
}

void RotaryCodes::begin_move(Move& move) {
  check_rotary_offset();
  move.open_axes = static_cast<std::uint8_t>(open_axes_of_move() & 7U);
  if (rotary_target_ && modal_.state().tip_control != TipControl::off && move.open_axes != 0 && !open_cause_.empty()) {
    at_.error(
        at_.words.offset(), "position-open",
        fmt::format("rotary axes turn under tool-centre-point control after {}, which leaves the tip open; X, Y and "
                    "Z in G90 were expected before or in this block",
                    open_cause_));
    open_axes_ = move.open_axes = 0;
  }
  move.start_open = start_open_;
  const auto& targets = at_.out.machine_targets;
  start_open_ = move.open_axes != 0 || (!targets.empty() && targets.back().move == at_.out.moves.size());
}

void RotaryCodes::close_axis(int axis) {
  open_axes_ = static_cast<std::uint8_t>(open_axes_ & ~(1U << static_cast<unsigned>(axis)));
}

}  // namespace camber::nc
