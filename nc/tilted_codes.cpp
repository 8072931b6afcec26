// Frames that follow the part: tilted frames (G68.2, G53.1, G69) and the dynamic work offset (G254, G255).
#include <cmath>

#include <fmt/format.h>

#include <Eigen/LU>

#include "base/units.h"
#include "nc/block_interpreter.h"

namespace camber::nc {
namespace {

constexpr char kAxisLetters[] = "XYZ";
constexpr char kAngleLetters[] = "IJK";

}  // namespace

bool BlockInterpreter::rotary_axes_turned() const { return angles_unknown_ != 0 || rotary_rad_ != Vec3::Zero(); }

/// Marks that from here on the programmed coordinates of the tool do not follow from the program until words give them.
void BlockInterpreter::open_axes(std::string cause) {
  open_axes_ = 7;
  start_open_ = true;
  open_cause_ = std::move(cause);
}

/// Words in G90 close the axes. Motion other than lines needs all of them.
void BlockInterpreter::settle_axes_for(const char* what, bool line) {
  if (open_axes_ == 0) return;
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (!words_.has(kAxisLetters[axis])) continue;
    if ((open_axes_ & (1U << axis)) != 0 && state_.incremental) {
      error(words_.offset_of(kAxisLetters[axis]), "position-open",
            fmt::format("{0} in G91 after {1}, which leaves {0} open; G90 was expected", kAxisLetters[axis],
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

/// False, with an error, where another frame, a cycle or a rotary work offset is in the way of `code`.
bool BlockInterpreter::may_set_frame(const Code& code) {
  const std::string name = code_text(code);
  const auto refuse = [&](const char* check, std::string message) {
    error(code.word->offset, check, std::move(message));
    return false;
  };
  if (options_.rotary_axes.empty())
    return refuse("not-read", needs_kinematics(code, code.tenths >= 2540 ? "dynamic work offset" : "tilted frame"));
  if (cycle_.g != 0)
    return refuse("tilted-frame", fmt::format("{} in the cycle G{}; G80 was expected before", name, cycle_.g));
  if (state_.tip_control != TipControl::off)
    return refuse("tilted-frame", fmt::format("{} under tool-centre-point control; {} was expected before", name,
                                              options_.dialect_or_default().tip_control_off_m != 0
                                                  ? fmt::format("M{}", options_.dialect_or_default().tip_control_off_m)
                                                  : "G49"));
  return true;
}

// --- G68.2, G53.1, G69

void BlockInterpreter::set_tilted_frame() {
  const Code& code = request_.frame_code;
  words_.use("PQR");
  if (!may_set_frame(code)) return;
  if (state_.work_frame != WorkFrame::machine) {
    const bool tilted = state_.work_frame == WorkFrame::tilted;
    return error(code.word->offset, "tilted-frame",
                 fmt::format("G68.2 while {} is active; {} was expected before",
                             tilted ? "a tilted frame" : "the dynamic work offset (G254)", tilted ? "G69" : "G255"));
  }
  for (const char letter : {'P', 'R'})
    if (words_.has(letter) && words_.value(letter) != 0)
      return error(words_.offset_of(letter), "not-read",
                   fmt::format("G68.2 with {} is not supported; Euler angles I, J and K were expected",
                               program_->source.text().substr(words_.word(letter).offset, words_.word(letter).length)));
  Tilt tilt;
  Vec3 angles = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    if (words_.has(kAxisLetters[axis])) tilt.origin_mm[axis] = words_.value(kAxisLetters[axis]) * unit_mm();
    if (words_.has(kAngleLetters[axis])) angles[axis] = rad_from_deg(words_.value(kAngleLetters[axis]));
  }
  tilt.rotation = euler_zxz(angles);
  frames_.tilt = tilt;
  aligned_ = false;
  switch_work_frame(WorkFrame::tilted, "G68.2");
}

/// G53.1: the rotary axes put the tool along Z of the tilted frame; the linear axes stay.
void BlockInterpreter::align_tool() {
  const Code& code = request_.frame_code;
  words_.use("PXYZ");
  if (!may_set_frame(code)) return;
  if (state_.work_frame != WorkFrame::tilted)
    return error(code.word->offset, "tilted-frame", "G53.1 without a tilted frame; G68.2 was expected before");
  if (words_.has('P') && words_.value('P') != 0)
    return error(words_.offset_of('P'), "not-read",
                 fmt::format("G53.1 P{} is not supported; G53.1 without P (the nearest angles) was expected",
                             words_.value('P')));
  for (const char letter : std::string_view("XYZ"))
    if (words_.has(letter))
      return error(words_.offset_of(letter), "tilted-frame",
                   fmt::format("{} in a block with G53.1; a block of its own was expected", letter));
  RotaryTarget target;
  target.is_direction = true;
  direction_code_ = "G53.1";
  target.end = (frames_.offset_rotation(state_.work_offset) * frames_.tilt->rotation).col(2).normalized();
  rotary_target_ = target;
  aligned_ = true;
  open_axes("G53.1");
  check_unit();
  Move& move = add_move(MoveKind::rapid, position_mm_);
  move.editable = false;
}

/// G69, for G68.2 and G68 alike.
void BlockInterpreter::cancel_tilted_frame() {
  frames_.rotated = false;
  frames_.rotation_rad = 0;
  if (!frames_.tilt) return;
  frames_.tilt.reset();
  switch_work_frame(WorkFrame::machine, "G69");
}

// --- G254, G255

void BlockInterpreter::set_dynamic_offset(const Code& code) {
  const bool on = code.tenths == 2540;
  if (!on && state_.work_frame != WorkFrame::dynamic) return;  // off already, whatever else is active
  if (!may_set_frame(code)) {
    request_.skip_motion = on;
    return;
  }
  if (state_.work_frame == WorkFrame::tilted)
    return error(code.word->offset, "tilted-frame",
                 fmt::format("{} while a tilted frame is active; G69 was expected before", code_text(code)));
  if (on)
    for (const RotaryOption& axis : options_.rotary_axes)
      if (!axis.on_table)
        return error(code.word->offset, "tilted-frame",
                     fmt::format("G254 on a machine whose head turns about {} is not supported; rotary axes of the "
                                 "table were expected",
                                 axis.letter));
  const WorkFrame frame = on ? WorkFrame::dynamic : WorkFrame::machine;
  if (frame != state_.work_frame) switch_work_frame(frame, on ? "G254" : "G255");
}

void BlockInterpreter::switch_work_frame(WorkFrame frame, const char* code) {
  state_.work_frame = frame;
  state_changed_ = true;
  if (!out_.moves.empty() && rotary_axes_turned()) open_axes(code);
}

/// Frames of the part have no meaning yet for rotary words that are shifted by the work offset.
void BlockInterpreter::check_rotary_offset() {
  const bool follows = state_.work_frame != WorkFrame::machine || state_.tip_control != TipControl::off;
  if (!follows || frames_.offsets.rotary_rad(state_.work_offset) == Vec3::Zero()) return;
  error(words_.offset(), "rotary-offset",
        fmt::format("{} with a work offset of a rotary axis is not supported; offsets A0 B0 C0 were expected",
                    state_.work_frame == WorkFrame::tilted    ? "a tilted frame (G68.2)"
                    : state_.work_frame == WorkFrame::dynamic ? "G254"
                                                              : "tool-centre-point control"),
        "rotary-offset");
}

// --- machine coordinates

/// The linear axes that the next move takes to machine coordinates: bit i of `given`.
void BlockInterpreter::add_machine_target(const Vec3& end_mm, std::uint8_t given) {
  if (options_.rotary_axes.empty() || given == 0) return;
  out_.machine_targets.push_back({end_mm, static_cast<std::uint32_t>(out_.moves.size()), given});
  const bool follows = state_.work_frame != WorkFrame::machine || state_.tip_control != TipControl::off;
  if (follows && rotary_axes_turned()) open_axes("machine coordinates");
}

/// Move::open_axes of the block's move.
std::uint8_t BlockInterpreter::open_axes_of_move() const {
  auto open = static_cast<std::uint8_t>(open_axes_);
  // Words that say where the move ends in the frame of the program.
  const bool words_count = !state_.incremental && cycle_.g == 0 && !request_.frame_code.word &&
                           !request_.machine_frame && !request_.reference;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const bool given = words_count && words_.has(kAxisLetters[axis]);
    if (place_[axis] != AxisPlace::known && !given) open = static_cast<std::uint8_t>(open | (1U << axis));
  }
  return open;
}

}  // namespace camber::nc
