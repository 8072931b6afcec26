// Frames that follow the part: tilted frames (G68.2, G53.1, G69) and the dynamic work offset (G254, G255).
#include <cmath>

#include <fmt/format.h>

#include <Eigen/LU>

#include "base/units.h"
#include "nc/rotary_codes.h"

namespace camber::nc {
namespace {

constexpr char kAngleLetters[] = "IJK";

}  // namespace

bool RotaryCodes::rotary_axes_turned() const { return angles_unknown_ != 0 || rotary_rad_ != Vec3::Zero(); }

/// Words in G90 close the axes. Motion other than lines needs all of them.
void RotaryCodes::settle_axes_for(const char* what, bool line) {
  if (open_axes_ == 0) return;
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (!at_.words.has(kAxisLetters[axis])) continue;
    if ((open_axes_ & (1U << axis)) != 0 && modal_.state().incremental) {
      at_.error(at_.words.offset_of(kAxisLetters[axis]), "position-open",
                fmt::format("{0} in G91 after {1}, which leaves {0} open; G90 was expected", kAxisLetters[axis],
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

/// False, with an error, where another frame, a cycle or a rotary work offset is in the way of `code`.
bool RotaryCodes::may_set_frame(const Code& code) {
  const std::string name = at_.code_text(code);
  const auto refuse = [&](const char* check, std::string message) {
    at_.error(code.word->offset, check, std::move(message));
    return false;
  };
  if (at_.options.rotary_axes.empty())
    return refuse("not-read", needs_kinematics(code, code.tenths >= 2540 ? "dynamic work offset" : "tilted frame"));
  if (modal_.cycle_g() != 0)
    return refuse("tilted-frame", fmt::format("{} in the cycle G{}; G80 was expected before", name, modal_.cycle_g()));
  if (modal_.state().tip_control != TipControl::off)
    return refuse("tilted-frame",
                  fmt::format("{} under tool-centre-point control; {} was expected before", name,
                              at_.dialect().tip_control_off_m != 0 ? fmt::format("M{}", at_.dialect().tip_control_off_m)
                                                                   : "G49"));
  return true;
}

void RotaryCodes::set_tilted_frame() {
  const Code& code = at_.request.frame_code;
  at_.words.use("PQR");
  if (!may_set_frame(code)) return;
  if (modal_.state().work_frame != WorkFrame::machine) {
    const bool tilted = modal_.state().work_frame == WorkFrame::tilted;
    return at_.error(
        code.word->offset, "tilted-frame",
        fmt::format("G68.2 while {} is active; {} was expected before",
                    tilted ? "a tilted frame" : "the dynamic work offset (G254)", tilted ? "G69" : "G255"));
  }
  for (const char letter : {'P', 'R'})
    if (at_.words.has(letter) && at_.words.value(letter) != 0)
      return at_.error(
          at_.words.offset_of(letter), "not-read",
          fmt::format("G68.2 with {} is not supported; Euler angles I, J and K were expected",
                      at_.program->source.text().substr(at_.words.word(letter).offset, at_.words.word(letter).length)));
  Tilt tilt;
  Vec3 angles = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    if (at_.words.has(kAxisLetters[axis]))
      tilt.origin_mm[axis] = at_.words.value(kAxisLetters[axis]) * modal_.unit_mm();
    if (at_.words.has(kAngleLetters[axis])) angles[axis] = rad_from_deg(at_.words.value(kAngleLetters[axis]));
  }
  tilt.rotation = euler_zxz(angles);
  frames_.set_tilt(tilt);
  aligned_ = false;
  switch_work_frame(WorkFrame::tilted, "G68.2");
}

/// G53.1: the rotary axes put the tool along Z of the tilted frame; the linear axes stay.
bool RotaryCodes::align_tool() {
  const Code& code = at_.request.frame_code;
  at_.words.use("PXYZ");
  const auto refuse = [&](std::size_t offset, const char* check, std::string message) {
    at_.error(offset, check, std::move(message));
    return false;
  };
  if (!may_set_frame(code)) return false;
  if (modal_.state().work_frame != WorkFrame::tilted)
    return refuse(code.word->offset, "tilted-frame", "G53.1 without a tilted frame; G68.2 was expected before");
  if (at_.words.has('P') && at_.words.value('P') != 0)
    return refuse(at_.words.offset_of('P'), "not-read",
                  fmt::format("G53.1 P{} is not supported; G53.1 without P (the nearest angles) was expected",
                              at_.words.value('P')));
  for (const char letter : std::string_view("XYZ"))
    if (at_.words.has(letter))
      return refuse(at_.words.offset_of(letter), "tilted-frame",
                    fmt::format("{} in a block with G53.1; a block of its own was expected", letter));
  RotaryTarget target;
  target.is_direction = true;
  direction_code_ = "G53.1";
  target.end = frames_.tilted_normal();
  rotary_target_ = target;
  aligned_ = true;
  open_axes("G53.1");
  return true;
}

/// G69, for G68.2 and G68 alike.
void RotaryCodes::cancel_tilted_frame() {
  if (frames_.cancel_rotation()) switch_work_frame(WorkFrame::machine, "G69");
}

void RotaryCodes::set_dynamic_offset(const Code& code) {
  const bool on = code.tenths == 2540;
  if (!on && modal_.state().work_frame != WorkFrame::dynamic) return;  // off already, whatever else is active
  if (!may_set_frame(code)) {
    at_.request.skip_motion = on;
    return;
  }
  if (modal_.state().work_frame == WorkFrame::tilted)
    return at_.error(code.word->offset, "tilted-frame",
                     fmt::format("{} while a tilted frame is active; G69 was expected before", at_.code_text(code)));
  if (on)
    for (const RotaryOption& axis : at_.options.rotary_axes)
      if (!axis.on_table)
        return at_.error(code.word->offset, "tilted-frame",
                         fmt::format("G254 on a machine whose head turns about {} is not supported; rotary axes of the "
                                     "table were expected",
                                     axis.letter));
  const WorkFrame frame = on ? WorkFrame::dynamic : WorkFrame::machine;
  if (frame != modal_.state().work_frame) switch_work_frame(frame, on ? "G254" : "G255");
}

void RotaryCodes::switch_work_frame(WorkFrame frame, const char* code) {
  modal_.change().work_frame = frame;
  if (!at_.out.moves.empty() && rotary_axes_turned()) open_axes(code);
}

/// Frames of the part have no meaning yet for rotary words that are shifted by the work offset.
void RotaryCodes::check_rotary_offset() {
  const bool follows = modal_.state().work_frame != WorkFrame::machine || modal_.state().tip_control != TipControl::off;
  if (!follows || frames_.rotary_offset_rad() == Vec3::Zero()) return;
  at_.error(at_.words.offset(), "rotary-offset",
            fmt::format("{} with a work offset of a rotary axis is not supported; offsets A0 B0 C0 were expected",
                        modal_.state().work_frame == WorkFrame::tilted    ? "a tilted frame (G68.2)"
                        : modal_.state().work_frame == WorkFrame::dynamic ? "G254"
                                                                          : "tool-centre-point control"),
            "rotary-offset");
}

/// The linear axes that the next move takes to machine coordinates: bit i of `given`.
void RotaryCodes::add_machine_target(const Vec3& end_mm, std::uint8_t given) {
  if (at_.options.rotary_axes.empty() || given == 0) return;
  at_.out.machine_targets.push_back({end_mm, static_cast<std::uint32_t>(at_.out.moves.size()), given});
  const bool follows = modal_.state().work_frame != WorkFrame::machine || modal_.state().tip_control != TipControl::off;
  if (follows && rotary_axes_turned()) open_axes("machine coordinates");
}

/// Move::open_axes of the block's move.
std::uint8_t RotaryCodes::open_axes_of_move() const {
  auto open = static_cast<std::uint8_t>(open_axes_);
  // Words that say where the move ends in the frame of the program.
  const bool words_count = !modal_.state().incremental && modal_.cycle_g() == 0 && !at_.request.frame_code.word &&
                           !at_.request.machine_frame && !at_.request.reference;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const bool given = words_count && at_.words.has(kAxisLetters[axis]);
    if (place_.axis[axis] != AxisPlace::known && !given) open = static_cast<std::uint8_t>(open | (1U << axis));
  }
  return open;
}

/// Marks that from here on the programmed coordinates of the tool do not follow from the program until words give them.
void RotaryCodes::open_axes(std::string cause) {
  open_axes_ = 7;
  start_open_ = true;
  open_cause_ = std::move(cause);
}

}  // namespace camber::nc
