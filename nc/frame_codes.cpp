#include "nc/frame_codes.h"

#include <cmath>

#include <Eigen/LU>

#include <fmt/format.h>

#include "base/units.h"

namespace camber::nc {
namespace {

constexpr char kScaleLetters[] = "IJK";

bool is_offset_number(double value) { return value == std::floor(value) && value >= 0 && value < 1e6; }

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

FrameCodes::FrameCodes(BlockContext& at, ModalGroups& modal, ToolPlace& place)
    : at_(at),
      modal_(modal),
      place_(place),
      frames_(at.options.work_offsets_mm),
      used_(!at.options.work_offsets_mm.empty()),
      tool_offsets_(at.options.tool_offsets) {
  for (const auto& [number, angles] : at.options.rotary_offsets_rad) frames_.offsets.at(number).rotary_rad = angles;
  update_frame();
}

void FrameCodes::update_frame() {
  const Frame frame = frames_.frame(modal_.state().work_offset, at_.out.moves.empty());
  if (frame == frame_) return;
  frame_ = frame;
  for (std::size_t i = 0; i < at_.out.frames.size(); ++i)
    if (at_.out.frames[i] == frame) {
      modal_.change().frame = static_cast<std::uint32_t>(i);
      return;
    }
  modal_.change().frame = static_cast<std::uint32_t>(at_.out.frames.size());
  at_.out.frames.push_back(frame);
}

/// G15, G16, G50, G92.1 to G92.3: codes without words of their own.
void FrameCodes::read_frame_code(const Code& code) {
  const int t = code.tenths;
  if (t == 150 || t == 160) {
    frames_.polar = t == 160;
    if (t == 160) {
      at_.relied_ends.add(at_.out.moves);
      const Vec3 p = programmed();
      const PlaneAxes axes = axes_of(modal_.plane());
      polar_angle_deg_ = std::atan2(p[axes.second], p[axes.first]) * 180 / kPi;
      if (!at_.not_editable_told)
        at_.report.warning(code.word->offset, "not-editable",
                           "moves in polar coordinates (G16) are read, but compensation leaves them unchanged");
      at_.not_editable_told = true;
    }
  } else if (t == 500) {
    frames_.scale = Vec3::Ones();
  } else {
    restore_shift(t);
  }
}

void FrameCodes::set_local_shift() {
  if (!at_.words.has_any("XYZ"))
    at_.error(at_.request.frame_code.word->offset, "frame", "G52 has no axis; X, Y or Z was expected");
  Vec3& shift = at_.dialect().g52_is_g92 ? frames_.g92_mm : frames_.g52_mm;
  for (int axis = 0; axis < 3; ++axis)
    if (at_.words.has(kAxisLetters[axis])) shift[axis] = at_.words.value(kAxisLetters[axis]) * modal_.unit_mm();
  frames_.g92_kept_mm = frames_.g92_mm;
}

/// G92: where the tool stands has the given coordinates from now on.
void FrameCodes::set_position() {
  if (!at_.words.has_any("XYZ")) {
    at_.error(at_.request.frame_code.word->offset, "frame", "G92 has no axis; X, Y or Z was expected");
    return;
  }
  for (int axis = 0; axis < 3; ++axis)
    if (at_.words.has(kAxisLetters[axis]) && place_.axis[static_cast<std::size_t>(axis)] != AxisPlace::known)
      place_at_program_point(axis, at_.words.value(kAxisLetters[axis]) * modal_.unit_mm());
  Vec3 p = programmed();
  for (int axis = 0; axis < 3; ++axis)
    if (at_.words.has(kAxisLetters[axis])) p[axis] = at_.words.value(kAxisLetters[axis]) * modal_.unit_mm();
  if (!at_.dialect().g52_is_g92)
    for (int axis = 0; axis < 3; ++axis)
      if (at_.words.has(kAxisLetters[axis])) {
        frames_.g92_mm[axis] += frames_.g52_mm[axis];
        frames_.g52_mm[axis] = 0;
      }
  frames_.g92_mm +=
      frames_.offset_rotation(modal_.state().work_offset).transpose() * (place_.position_mm - frame_.from_program(p));
  frames_.g92_kept_mm = frames_.g92_mm;
}

/// The axis stood where nobody knew; now it is known. The moves that led there end there.
void FrameCodes::place_at_program_point(int axis, double programmed_mm) {
  Vec3 p = programmed();
  p[axis] = programmed_mm;
  const double by = frame_.from_program(p)[axis] - place_.position_mm[axis];
  place_.position_mm[axis] += by;
  place_.axis[static_cast<std::size_t>(axis)] = AxisPlace::known;
  for (std::size_t m = at_.out.moves.size(); m-- > 0 && at_.out.moves[m].reference;) {
    at_.out.moves[m].end_mm[axis] += by;
    if (m > 0 && !at_.out.moves[m - 1].reference) break;
    at_.out.moves[m].start_mm[axis] += by;
  }
}

void FrameCodes::restore_shift(int tenths) {
  if (tenths == 923) {
    frames_.g92_mm = frames_.g92_kept_mm;
    return;
  }
  at_.words.use("P");
  if (tenths == 921) frames_.g92_kept_mm = Vec3::Zero();
  frames_.g92_mm = Vec3::Zero();
}

void FrameCodes::set_rotation() {
  if (!at_.words.has('R')) {
    at_.error(at_.request.frame_code.word->offset, "frame", "G68 has no angle; R in degrees was expected");
    at_.words.use("XYZ");
    return;
  }
  Vec3 centre = frames_.in_work_mm(programmed());
  for (int axis = 0; axis < 3; ++axis)
    if (at_.words.has(kAxisLetters[axis])) centre[axis] = at_.words.value(kAxisLetters[axis]) * modal_.unit_mm();
  const double angle = at_.words.value('R') * kPi / 180;
  const bool adds = frames_.rotated && modal_.state().incremental && at_.dialect().rotation_r_adds_in_g91;
  frames_.rotation_rad = adds ? frames_.rotation_rad + angle : angle;
  frames_.rotation_centre_mm = centre;
  frames_.rotation_plane = modal_.plane();
  frames_.rotated = true;
}

double FrameCodes::scale_value(char letter) {
  const double value = at_.words.value(letter);
  return at_.written_with_point(at_.words.word(letter)) ? value : value * at_.dialect().scale_unit;
}

void FrameCodes::set_scaling() {
  Vec3 centre = frames_.in_work_mm(programmed()), scale = Vec3::Ones();
  for (int axis = 0; axis < 3; ++axis)
    if (at_.words.has(kAxisLetters[axis])) centre[axis] = at_.words.value(kAxisLetters[axis]) * modal_.unit_mm();
  if (at_.words.has('P')) {
    scale = Vec3::Constant(scale_value('P'));
  } else if (at_.words.has_any("IJK")) {
    for (int axis = 0; axis < 3; ++axis)
      if (at_.words.has(kScaleLetters[axis])) scale[axis] = scale_value(kScaleLetters[axis]);
  } else {
    at_.error(at_.request.frame_code.word->offset, "frame", "G51 has no scale; P, or I J K, was expected");
    return;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double s = std::abs(scale[axis]);
    if (s >= 0.01 && s <= 100) continue;
    at_.error(at_.request.frame_code.word->offset, "scaling",
              fmt::format("G51 scales {} by {}; 0.01 to 100 was expected (1 without a decimal point is {})",
                          kAxisLetters[axis], scale[axis], at_.dialect().scale_unit));
    return;
  }
  frames_.scale = scale;
  frames_.scale_centre_mm = centre;
}

void FrameCodes::set_mirror() {
  const bool on = at_.request.frame_code.tenths == 511;
  const bool any = at_.words.has_any("XYZ");
  if (on && !any) at_.error(at_.request.frame_code.word->offset, "frame", "G51.1 has no axis; X, Y or Z was expected");
  for (int axis = 0; axis < 3; ++axis) {
    auto& mirror = frames_.mirror_at_mm[static_cast<std::size_t>(axis)];
    const bool given = at_.words.has(kAxisLetters[axis]);
    const double at = given ? at_.words.value(kAxisLetters[axis]) * modal_.unit_mm() : 0;
    if (on && given) mirror = at;
    if (!on && (given || !any)) mirror.reset();
  }
}

/// G16: the first axis of the plane is a radius, the second an angle in degrees; about the programmed zero (G90) or
/// from where the tool stands, the angle added to the last one (G91).
Vec3 FrameCodes::polar_target(Vec3 end) {
  const PlaneAxes axes = axes_of(modal_.plane());
  const char radius_letter = kAxisLetters[axes.first], angle_letter = kAxisLetters[axes.second];
  const char height_letter = kAxisLetters[axes.normal];
  if (at_.words.has(height_letter)) {
    const double value = at_.words.value(height_letter) * modal_.unit_mm();
    end[axes.normal] = modal_.state().incremental ? end[axes.normal] + value : value;
  }
  if (!at_.words.has(radius_letter) && !at_.words.has(angle_letter)) return end;
  if (!modal_.state().incremental && !at_.words.has(radius_letter)) at_.relied_ends.add(at_.out.moves);
  double radius = modal_.state().incremental ? 0 : std::hypot(end[axes.first], end[axes.second]);
  if (at_.words.has(radius_letter)) radius = at_.words.value(radius_letter) * modal_.unit_mm();
  if (at_.words.has(angle_letter))
    polar_angle_deg_ = at_.words.value(angle_letter) + (modal_.state().incremental ? polar_angle_deg_ : 0);
  const double angle = polar_angle_deg_ * kPi / 180;
  const double x = radius * std::cos(angle), y = radius * std::sin(angle);
  end[axes.first] = x + (modal_.state().incremental ? end[axes.first] : 0);
  end[axes.second] = y + (modal_.state().incremental ? end[axes.second] : 0);
  return end;
}

void FrameCodes::set_data() {
  const std::size_t at = at_.request.frame_code.word->offset;
  const double written = at_.words.has('L') ? at_.words.value('L') : -1;
  const int kind = !at_.words.has('L') ? -1 : is_offset_number(written) ? static_cast<int>(written) : -2;
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
      at_.error(at, "not-read",
                fmt::format("G10 L{} is not read; L2, L20 (work offsets) or L1, L10 to L13 (tool offsets) was "
                            "expected",
                            written),
                "G10");
      at_.words.use("XYZIJKPQR");
      break;
  }
}

void FrameCodes::set_work_offset_data(bool touch_off) {
  const std::size_t at = at_.request.frame_code.word->offset;
  const char* const name = touch_off ? "G10 L20" : "G10 L2";
  if (!at_.words.has('P') || !is_offset_number(at_.words.value('P'))) {
    at_.error(at, "work-offset", fmt::format("{} needs a P with the number of the offset", name));
    at_.words.use("XYZR");
    return;
  }
  const int p = static_cast<int>(at_.words.value('P'));
  const bool extended = touch_off && at_.dialect().g10_l20_is_g54_1;
  if (!extended && p > 9) {
    at_.error(at, "work-offset", fmt::format("{} P{} is not a work offset; P0 to P9 was expected", name, p));
    at_.words.use("XYZR");
    return;
  }
  const bool external = !extended && p == 0 && at_.dialect().g10_p0_is_external;
  const int number = extended ? 540000 + p : p == 0 ? modal_.state().work_offset : p <= 6 ? 53 + p : 590 + p - 6;
  WorkOffset& offset = frames_.offsets.at(number);
  Vec3& value = external ? frames_.offsets.external_mm : offset.value_mm;
  const bool adds = modal_.state().incremental && at_.dialect().g10_adds_in_g91;
  if (touch_off && !extended) {
    // The tool's place gets the given coordinates in the offset.
    Frames wished = frames_;
    Frame frame = wished.frame(number, at_.out.moves.empty());
    Vec3 p_mm = frame.to_program(place_.position_mm);
    for (int axis = 0; axis < 3; ++axis)
      if (at_.words.has(kAxisLetters[axis])) p_mm[axis] = at_.words.value(kAxisLetters[axis]) * modal_.unit_mm();
    value += place_.position_mm - frame.from_program(p_mm);
    return;
  }
  if (!external && !offset.known && !adds) warn_of_moved_offset(number, at, name);
  for (int axis = 0; axis < 3; ++axis) {
    if (!at_.words.has(kAxisLetters[axis])) continue;
    const double given = at_.words.value(kAxisLetters[axis]) * modal_.unit_mm();
    value[axis] = adds ? value[axis] + given : given;
  }
  for (const RotaryOption& axis : at_.options.rotary_axes) {
    if (external || !at_.words.has(axis.letter)) continue;
    double& angle = offset.rotary_rad[axis.letter - 'A'];
    const double given = rad_from_deg(at_.words.value(axis.letter));
    angle = adds ? angle + given : given;
  }
  if (at_.words.has('R')) offset.rotation_rad = at_.words.value('R') * kPi / 180;
  if (!external && !adds) offset.known = true;
}

void FrameCodes::warn_of_moved_offset(int number, std::size_t at, const std::string& name) {
  if (number != modal_.state().work_offset || at_.out.moves.empty()) return;
  at_.report.warning(at, "work-offsets",
                     fmt::format("{} sets the work offset that the program has moved in; its previous position is not "
                                 "known and is assumed to be the same",
                                 name),
                     "G10");
}

std::optional<double> FrameCodes::offset_value(const OffsetVariable& v) {
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

void FrameCodes::set_offset(const OffsetVariable& v, double value, std::size_t at) {
  if (v.kind == OffsetVariable::Kind::external) {
    if (v.axis < 3) frames_.offsets.external_mm[v.axis] = value;
  } else if (v.kind != OffsetVariable::Kind::work) {
    tool_offsets_[v.number].*column_of(v.kind) = value;
    return;
  } else if (!at_.dialect().system_4000 && v.number == modal_.state().work_offset) {
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
  used_ = true;
  update_frame();
}

/// A LinuxCNC control takes what a program has set of the active offset when it is next selected.
void FrameCodes::take_pending_offset() {
  const auto pending = std::exchange(pending_offsets_, {});
  for (const auto& [variable, value] : pending)
    if (variable.number == modal_.state().work_offset) {
      WorkOffset& offset = frames_.offsets.at(variable.number);
      if (variable.axis == OffsetVariable::kRotation) offset.rotation_rad = rad_from_deg(value);
      if (variable.axis < 3) offset.value_mm[variable.axis] = value, offset.known = true;
      used_ = true;
    } else {
      pending_offsets_.emplace_back(variable, value);
    }
}

void FrameCodes::set_tool_data(int kind) {
  const std::size_t at = at_.request.frame_code.word->offset;
  if (!at_.words.has('P') || !is_offset_number(at_.words.value('P')) || !at_.words.has_any("RXYZ")) {
    at_.error(at, "tool-offset", "G10 of a tool offset needs P with its number and R (or Z) with its value");
    at_.words.use("XYZRIJQ");
    return;
  }
  ToolOffset& tool = tool_offsets_[static_cast<int>(at_.words.value('P'))];
  at_.words.use("XYIJQ");
  const bool axes = at_.words.has_any("XYZ");
  const auto put = [&](std::optional<double>& place, char letter) {
    const double value = at_.words.value(letter) * modal_.unit_mm();
    place = modal_.state().incremental ? place.value_or(0) + value : value;
  };
  if (at_.words.has('Z')) put(tool.length_mm, 'Z');
  if (!at_.words.has('R')) return;
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
    tool.length_mm = tool.radius_mm = at_.words.value('R') * modal_.unit_mm();
}

/// An axis goes to a machine coordinate: known in the frame of the moves where the work offset is known. The height
/// stays unknown, as it needs the tool's length.
void FrameCodes::settle_machine_axis(std::size_t axis, double machine_mm, Vec3& place_mm) {
  const auto index = static_cast<Eigen::Index>(axis);
  place_mm[index] = machine_mm;
  place_.axis[axis] = AxisPlace::reference;
  if (axis == 2) return;
  if (const auto origin = frames_.offsets.machine_origin_mm(modal_.state().work_offset)) {
    place_mm[index] = machine_mm + (*origin)[index];
    place_.axis[axis] = AxisPlace::known;
  }
}

void FrameCodes::work_offset_selected() {
  if (!pending_offsets_.empty()) take_pending_offset();
  if (used_) update_frame();
}

void FrameCodes::run_frame_code() {
  switch (at_.request.frame_code.tenths) {
    case 100:
      return set_data();
    case 501:
    case 511:
      return set_mirror();
    case 510:
      return set_scaling();
    case 520:
      return set_local_shift();
    case 680:
      return set_rotation();
    default:
      return set_position();
  }
}

const ToolOffset* FrameCodes::tool_offset(int number) const {
  const auto found = tool_offsets_.find(number);
  return found == tool_offsets_.end() ? nullptr : &found->second;
}

void FrameCodes::set_tilt(const std::optional<Tilt>& tilt) { frames_.tilt = tilt; }

bool FrameCodes::cancel_rotation() {
  frames_.rotated = false;
  frames_.rotation_rad = 0;
  if (!frames_.tilt) return false;
  frames_.tilt.reset();
  return true;
}

Vec3 FrameCodes::tilted_normal() const {
  return (frames_.offset_rotation(modal_.state().work_offset) * frames_.tilt->rotation).col(2).normalized();
}

}  // namespace camber::nc
