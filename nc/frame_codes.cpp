// Codes that say where programmed coordinates lie: G10, G15 G16, G29, G50 G51, G50.1 G51.1, G52, G68, G92. Frames that
// follow the part: tilted_codes.cpp.
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <Eigen/LU>

#include "base/units.h"
#include "nc/block_interpreter.h"

namespace camber::nc {
namespace {

constexpr char kAxisLetters[] = "XYZ";
constexpr char kOffsetLetters[] = "IJK";

bool is_whole(double value) { return value == std::floor(value) && value >= 0 && value < 1e6; }

}  // namespace

void BlockInterpreter::update_frame() {
  const Frame frame = frames_.frame(state_.work_offset, out_.moves.empty());
  if (frame == frame_) return;
  frame_ = frame;
  state_changed_ = true;
  for (std::size_t i = 0; i < out_.frames.size(); ++i)
    if (out_.frames[i] == frame) {
      state_.frame = static_cast<std::uint32_t>(i);
      return;
    }
  state_.frame = static_cast<std::uint32_t>(out_.frames.size());
  out_.frames.push_back(frame);
}

void BlockInterpreter::read_frame_code(const Code& code) {
  const int t = code.tenths;
  if (radius_.active && radius_.radius_mm != 0) {
    error(code.word->offset, "cutter-radius",
          fmt::format("{} under G{}; G40 was expected before", code_text(code), radius_.g_tenths / 10));
    request_.skip_motion = true;
    return;
  }
  if (t == 150 || t == 160) {
    frames_.polar = t == 160;
    if (t == 160) {
      const Vec3 p = programmed();
      const PlaneAxes axes = axes_of(plane_);
      polar_angle_deg_ = std::atan2(p[axes.second], p[axes.first]) * 180 / kPi;
      if (!not_editable_told_)
        report_.warning(code.word->offset, "not-editable",
                        "moves in polar coordinates (G16) are read, but compensation leaves them unchanged");
      not_editable_told_ = true;
    }
  } else if (t == 690) {
    cancel_tilted_frame();
  } else if (t == 2540 || t == 2550) {
    set_dynamic_offset(code);
  } else if (t == 500) {
    frames_.scale = Vec3::Ones();
  } else if (t == 921 || t == 922 || t == 923) {
    restore_shift(t);
  } else {
    if (request_.frame_code.word)
      error(code.word->offset, "modal-group",
            fmt::format("{} and {} in one block exclude each other; one of them was expected",
                        code_text(request_.frame_code), code_text(code)));
    request_.frame_code = code;
    return;
  }
  frames_used_ = true;
  update_frame();
}

void BlockInterpreter::run_frame_code() {
  frames_used_ = true;
  const int t = request_.frame_code.tenths;
  const bool moves_origin = t == 100 || t == 520 || t == 920;
  if (state_.work_frame != WorkFrame::machine && moves_origin) {
    error(request_.frame_code.word->offset, "tilted-frame",
          fmt::format("{} while {} is active; {} was expected before", code_text(request_.frame_code),
                      state_.work_frame == WorkFrame::tilted ? "a tilted frame" : "the dynamic work offset (G254)",
                      state_.work_frame == WorkFrame::tilted ? "G69" : "G255"));
    words_.use("XYZIJKLPQRABC");
    return;
  }
  // These take the place of the tool.
  if (t == 920 || ((t == 680 || t == 510) && !words_.has_any("XYZ")))
    settle_axes_for(t == 920 ? "G92" : t == 680 ? "G68" : "G51", false);
  switch (t) {
    case 100:
      set_data();
      break;
    case 501:
    case 511:
      set_mirror();
      break;
    case 510:
      set_scaling();
      break;
    case 520:
      set_local_shift();
      break;
    case 531:
      align_tool();
      break;
    case 680:
      set_rotation();
      break;
    case 682:
      set_tilted_frame();
      break;
    default:
      set_position();
      break;
  }
  update_frame();
}

// --- G52, G92
// -----------------------------------------------------------------------------------------------------------

void BlockInterpreter::set_local_shift() {
  if (!words_.has_any("XYZ"))
    error(request_.frame_code.word->offset, "frame", "G52 has no axis; X, Y or Z was expected");
  Vec3& shift = options_.dialect_or_default().g52_is_g92 ? frames_.g92_mm : frames_.g52_mm;
  for (int axis = 0; axis < 3; ++axis)
    if (words_.has(kAxisLetters[axis])) shift[axis] = words_.value(kAxisLetters[axis]) * unit_mm();
  frames_.g92_kept_mm = frames_.g92_mm;
}

/// G92: where the tool stands has the given coordinates from now on.
void BlockInterpreter::set_position() {
  if (!words_.has_any("XYZ")) {
    error(request_.frame_code.word->offset, "frame", "G92 has no axis; X, Y or Z was expected");
    return;
  }
  for (int axis = 0; axis < 3; ++axis)
    if (words_.has(kAxisLetters[axis]) && place_[static_cast<std::size_t>(axis)] != AxisPlace::known)
      place_at_program_point(axis, words_.value(kAxisLetters[axis]) * unit_mm());
  Vec3 p = programmed();
  for (int axis = 0; axis < 3; ++axis)
    if (words_.has(kAxisLetters[axis])) p[axis] = words_.value(kAxisLetters[axis]) * unit_mm();
  if (!options_.dialect_or_default().g52_is_g92)
    for (int axis = 0; axis < 3; ++axis)
      if (words_.has(kAxisLetters[axis])) {
        frames_.g92_mm[axis] += frames_.g52_mm[axis];
        frames_.g52_mm[axis] = 0;
      }
  frames_.g92_mm += frames_.offset_rotation(state_.work_offset).transpose() * (position_mm_ - frame_.from_program(p));
  frames_.g92_kept_mm = frames_.g92_mm;
}

/// The axis stood where nobody knew; now it is known. The moves that led there end there.
void BlockInterpreter::place_at_program_point(int axis, double programmed_mm) {
  Vec3 p = programmed();
  p[axis] = programmed_mm;
  const double by = frame_.from_program(p)[axis] - position_mm_[axis];
  position_mm_[axis] += by;
  place_[static_cast<std::size_t>(axis)] = AxisPlace::known;
  for (std::size_t m = out_.moves.size(); m-- > 0 && out_.moves[m].reference;) {
    out_.moves[m].end_mm[axis] += by;
    if (m > 0 && !out_.moves[m - 1].reference) break;
    out_.moves[m].start_mm[axis] += by;
  }
}

void BlockInterpreter::restore_shift(int tenths) {
  if (tenths == 923) {
    frames_.g92_mm = frames_.g92_kept_mm;
    return;
  }
  words_.use("P");
  if (tenths == 921) frames_.g92_kept_mm = Vec3::Zero();
  frames_.g92_mm = Vec3::Zero();
}

// --- G68, G51, G51.1, G16
// ---------------------------------------------------------------------------------------------

void BlockInterpreter::set_rotation() {
  if (!words_.has('R')) {
    error(request_.frame_code.word->offset, "frame", "G68 has no angle; R in degrees was expected");
    words_.use("XYZ");
    return;
  }
  Vec3 centre = frames_.in_work_mm(programmed());
  for (int axis = 0; axis < 3; ++axis)
    if (words_.has(kAxisLetters[axis])) centre[axis] = words_.value(kAxisLetters[axis]) * unit_mm();
  const double angle = words_.value('R') * kPi / 180;
  const bool adds = frames_.rotated && state_.incremental && options_.dialect_or_default().rotation_r_adds_in_g91;
  frames_.rotation_rad = adds ? frames_.rotation_rad + angle : angle;
  frames_.rotation_centre_mm = centre;
  frames_.rotation_plane = plane_;
  frames_.rotated = true;
}

double BlockInterpreter::scale_value(char letter) {
  const double value = words_.value(letter);
  return written_with_point(words_.word(letter)) ? value : value * options_.dialect_or_default().scale_unit;
}

void BlockInterpreter::set_scaling() {
  Vec3 centre = frames_.in_work_mm(programmed()), scale = Vec3::Ones();
  for (int axis = 0; axis < 3; ++axis)
    if (words_.has(kAxisLetters[axis])) centre[axis] = words_.value(kAxisLetters[axis]) * unit_mm();
  if (words_.has('P')) {
    scale = Vec3::Constant(scale_value('P'));
  } else if (words_.has_any("IJK")) {
    for (int axis = 0; axis < 3; ++axis)
      if (words_.has(kOffsetLetters[axis])) scale[axis] = scale_value(kOffsetLetters[axis]);
  } else {
    error(request_.frame_code.word->offset, "frame", "G51 has no scale; P, or I J K, was expected");
    return;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double s = std::abs(scale[axis]);
    if (s >= 0.01 && s <= 100) continue;
    error(request_.frame_code.word->offset, "scaling",
          fmt::format("G51 scales {} by {}; 0.01 to 100 was expected (1 without a decimal point is {})",
                      kAxisLetters[axis], scale[axis], options_.dialect_or_default().scale_unit));
    return;
  }
  frames_.scale = scale;
  frames_.scale_centre_mm = centre;
}

void BlockInterpreter::set_mirror() {
  const bool on = request_.frame_code.tenths == 511;
  const bool any = words_.has_any("XYZ");
  if (on && !any) error(request_.frame_code.word->offset, "frame", "G51.1 has no axis; X, Y or Z was expected");
  for (int axis = 0; axis < 3; ++axis) {
    auto& mirror = frames_.mirror_at_mm[static_cast<std::size_t>(axis)];
    const bool given = words_.has(kAxisLetters[axis]);
    const double at = given ? words_.value(kAxisLetters[axis]) * unit_mm() : 0;
    if (on && given) mirror = at;
    if (!on && (given || !any)) mirror.reset();
  }
}

/// G16: the first axis of the plane is a radius, the second an angle in degrees; about the programmed zero (G90) or
/// from where the tool stands, the angle added to the last one (G91).
Vec3 BlockInterpreter::polar_target(Vec3 end) {
  const PlaneAxes axes = axes_of(plane_);
  const char radius_letter = kAxisLetters[axes.first], angle_letter = kAxisLetters[axes.second];
  const char height_letter = kAxisLetters[axes.normal];
  if (words_.has(height_letter)) {
    const double value = words_.value(height_letter) * unit_mm();
    end[axes.normal] = state_.incremental ? end[axes.normal] + value : value;
  }
  if (!words_.has(radius_letter) && !words_.has(angle_letter)) return end;
  double radius = state_.incremental ? 0 : std::hypot(end[axes.first], end[axes.second]);
  if (words_.has(radius_letter)) radius = words_.value(radius_letter) * unit_mm();
  if (words_.has(angle_letter))
    polar_angle_deg_ = words_.value(angle_letter) + (state_.incremental ? polar_angle_deg_ : 0);
  const double angle = polar_angle_deg_ * kPi / 180;
  const double x = radius * std::cos(angle), y = radius * std::sin(angle);
  end[axes.first] = x + (state_.incremental ? end[axes.first] : 0);
  end[axes.second] = y + (state_.incremental ? end[axes.second] : 0);
  return end;
}

// --- G10
// ----------------------------------------------------------------------------------------------------------------

void BlockInterpreter::set_data() {
  const std::size_t at = request_.frame_code.word->offset;
  const double written = words_.has('L') ? words_.value('L') : -1;
  const int kind = !words_.has('L') ? -1 : is_whole(written) ? static_cast<int>(written) : -2;
  switch (kind) {
    case 2:
      set_work_offset_data(false);
      break;
    case 20:
      set_work_offset_data(true);
      break;
    case -1:
    case 1:
    case 10:
    case 11:
    case 12:
    case 13:
      set_tool_data(kind);
      break;
    default:
      error(at, "not-read",
            fmt::format("G10 L{} is not read; L2, L20 (work offsets) or L1, L10 to L13 (tool offsets) was "
                        "expected",
                        written),
            "G10");
      words_.use("XYZIJKPQR");
      break;
  }
}

void BlockInterpreter::set_work_offset_data(bool touch_off) {
  const std::size_t at = request_.frame_code.word->offset;
  const char* const name = touch_off ? "G10 L20" : "G10 L2";
  if (!words_.has('P') || !is_whole(words_.value('P'))) {
    error(at, "work-offset", fmt::format("{} needs a P with the number of the offset", name));
    words_.use("XYZR");
    return;
  }
  const int p = static_cast<int>(words_.value('P'));
  const bool extended = touch_off && options_.dialect_or_default().g10_l20_is_g54_1;
  if (!extended && p > 9) {
    error(at, "work-offset", fmt::format("{} P{} is not a work offset; P0 to P9 was expected", name, p));
    words_.use("XYZR");
    return;
  }
  const bool external = !extended && p == 0 && options_.dialect_or_default().g10_p0_is_external;
  const int number = extended ? 540000 + p : p == 0 ? state_.work_offset : p <= 6 ? 53 + p : 590 + p - 6;
  WorkOffset& offset = frames_.offsets.at(number);
  Vec3& value = external ? frames_.offsets.external_mm : offset.value_mm;
  const bool adds = state_.incremental && options_.dialect_or_default().g10_adds_in_g91;
  if (touch_off && !extended) {
    // The tool's place gets the given coordinates in the offset.
    Frames wished = frames_;
    Frame frame = wished.frame(number, out_.moves.empty());
    Vec3 p_mm = frame.to_program(position_mm_);
    for (int axis = 0; axis < 3; ++axis)
      if (words_.has(kAxisLetters[axis])) p_mm[axis] = words_.value(kAxisLetters[axis]) * unit_mm();
    value += position_mm_ - frame.from_program(p_mm);
    return;
  }
  if (!external && !offset.known && !adds) warn_of_moved_offset(number, at, name);
  for (int axis = 0; axis < 3; ++axis) {
    if (!words_.has(kAxisLetters[axis])) continue;
    const double given = words_.value(kAxisLetters[axis]) * unit_mm();
    value[axis] = adds ? value[axis] + given : given;
  }
  for (const RotaryOption& axis : options_.rotary_axes) {
    if (external || !words_.has(axis.letter)) continue;
    double& angle = offset.rotary_rad[axis.letter - 'A'];
    const double given = rad_from_deg(words_.value(axis.letter));
    angle = adds ? angle + given : given;
  }
  if (words_.has('R')) offset.rotation_rad = words_.value('R') * kPi / 180;
  if (!external && !adds) offset.known = true;
}

void BlockInterpreter::warn_of_moved_offset(int number, std::size_t at, const std::string& name) {
  if (number != state_.work_offset || out_.moves.empty()) return;
  report_.warning(at, "work-offsets",
                  fmt::format("{} sets the work offset that the program has moved in; its previous position is not "
                              "known and is assumed to be the same",
                              name),
                  "G10");
}

namespace {

std::optional<double> ToolOffset::*column_of(OffsetVariable::Kind kind) {
  switch (kind) {
    case OffsetVariable::Kind::tool_length:
      return &ToolOffset::length_mm;
    case OffsetVariable::Kind::tool_length_wear:
      return &ToolOffset::length_wear_mm;
    case OffsetVariable::Kind::tool_radius:
      return &ToolOffset::radius_mm;
    default:
      return &ToolOffset::radius_wear_mm;
  }
}

}  // namespace

std::optional<double> BlockInterpreter::offset_value(const OffsetVariable& v) {
  if (v.kind == OffsetVariable::Kind::external)
    return v.axis < 3 ? std::optional(frames_.offsets.external_mm[v.axis]) : std::nullopt;
  if (v.kind != OffsetVariable::Kind::work) {
    const auto tool = tool_offsets_.find(v.number);
    return tool == tool_offsets_.end() ? std::nullopt : tool->second.*column_of(v.kind);
  }
  WorkOffset& offset = frames_.offsets.at(v.number);
  if (v.axis == OffsetVariable::kRotation) return deg_from_rad(offset.rotation_rad);
  if (v.axis >= 3) return deg_from_rad(offset.rotary_rad[v.axis - 3]);
  if (offset.known || offset.value_mm != Vec3::Zero()) return offset.value_mm[v.axis];
  offset.read = true;
  return std::nullopt;
}

void BlockInterpreter::set_offset(const OffsetVariable& v, double value, std::size_t at) {
  if (v.kind == OffsetVariable::Kind::external) {
    if (v.axis < 3) frames_.offsets.external_mm[v.axis] = value;
  } else if (v.kind != OffsetVariable::Kind::work) {
    tool_offsets_[v.number].*column_of(v.kind) = value;
    return;
  } else if (!options_.dialect_or_default().system_4000 && v.number == state_.work_offset) {
    pending_offsets_.emplace_back(v, value);
    return;
  } else {
    WorkOffset& offset = frames_.offsets.at(v.number);
    if (v.axis == OffsetVariable::kRotation) {
      offset.rotation_rad = rad_from_deg(value);
    } else if (v.axis >= 3) {
      offset.rotary_rad[v.axis - 3] = rad_from_deg(value);
    } else {
      if (!offset.known && !offset.read) warn_of_moved_offset(v.number, at, "the assignment");
      offset.value_mm[v.axis] = value;
      offset.known = offset.known || !offset.read;
    }
  }
  frames_used_ = true;
  update_frame();
}

/// A LinuxCNC control takes what a program has set of the active offset when it is next selected.
void BlockInterpreter::take_pending_offset() {
  const auto pending = std::exchange(pending_offsets_, {});
  for (const auto& [variable, value] : pending)
    if (variable.number == state_.work_offset) {
      WorkOffset& offset = frames_.offsets.at(variable.number);
      if (variable.axis == OffsetVariable::kRotation) offset.rotation_rad = rad_from_deg(value);
      if (variable.axis < 3) offset.value_mm[variable.axis] = value, offset.known = true;
      frames_used_ = true;
    } else {
      pending_offsets_.emplace_back(variable, value);
    }
}

void BlockInterpreter::set_tool_data(int kind) {
  const std::size_t at = request_.frame_code.word->offset;
  if (!words_.has('P') || !is_whole(words_.value('P')) || !words_.has_any("RXYZ")) {
    error(at, "tool-offset", "G10 of a tool offset needs P with its number and R (or Z) with its value");
    words_.use("XYZRIJQ");
    return;
  }
  ToolOffset& tool = tool_offsets_[static_cast<int>(words_.value('P'))];
  words_.use("XYIJQ");
  const bool axes = words_.has_any("XYZ");
  const auto put = [&](std::optional<double>& place, char letter) {
    const double value = words_.value(letter) * unit_mm();
    place = state_.incremental ? place.value_or(0) + value : value;
  };
  if (words_.has('Z')) put(tool.length_mm, 'Z');
  if (!words_.has('R')) return;
  // With axis words R is the radius of LinuxCNC's tool table; without, L says which column of the memory is meant.
  if (axes || kind == 12)
    put(tool.radius_mm, 'R');
  else if (kind == 13)
    put(tool.radius_wear_mm, 'R');
  else if (kind == 10)
    put(tool.length_mm, 'R');
  else if (kind == 11)
    put(tool.length_wear_mm, 'R');
  else  // G10 P R, G10 L1 P R: one memory for both, who reads it says which it is
    tool.length_mm = tool.radius_mm = words_.value('R') * unit_mm();
}

// --- machine coordinates
// ------------------------------------------------------------------------------------------------

/// An axis goes to a machine coordinate: known in the frame of the moves where the work offset is known. The height
/// stays unknown, as it needs the tool's length.
void BlockInterpreter::settle_machine_axis(std::size_t axis, double machine_mm, Vec3& place_mm) {
  const auto index = static_cast<Eigen::Index>(axis);
  place_mm[index] = machine_mm;
  place_[axis] = AxisPlace::reference;
  if (axis == 2) return;
  if (const auto origin = frames_.offsets.machine_origin_mm(state_.work_offset)) {
    place_mm[index] = machine_mm + (*origin)[index];
    place_[axis] = AxisPlace::known;
  }
}

/// G29: through the intermediate point of the last G28 or G30 to the point of the block.
void BlockInterpreter::return_from_reference() {
  check_unit();
  if (!reference_via_mm_) {
    error(words_.offset(), "reference", "G29 without a G28 or G30 before; its intermediate point was expected");
    words_.use("XYZ");
    return;
  }
  settle_axes_for("G29", false);
  Vec3 via = position_mm_;
  for (int axis = 0; axis < 3; ++axis)
    if (words_.has(kAxisLetters[axis])) via[axis] = (*reference_via_mm_)[axis];
  const Vec3 start = position_mm_;
  if (state_.incremental) position_mm_ = via;  // increments count from the intermediate point
  const Vec3 end = target();
  position_mm_ = start;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (words_.has(kAxisLetters[axis]) && place_[axis] == AxisPlace::reference) place_[axis] = AxisPlace::known;
  add_move(MoveKind::rapid, via).reference = true;
  add_move(MoveKind::rapid, end);
  settle_axes();
}

}  // namespace camber::nc
