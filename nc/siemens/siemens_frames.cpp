// Where programmed coordinates lie: TRANS, ROT, SCALE, MIRROR, frame variables.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/LU>

#include "base/units.h"
#include "nc/siemens/siemens_motion.h"

namespace camber::nc::siemens {
namespace {

constexpr char kAxisLetters[] = "XYZ";

/// About Z, then the new Y, then the new X: the order of ROT and of CROT (RPY angles).
Eigen::Matrix3d rpy(const Vec3& angles_rad) {
  return rotation_in(Plane::xy, angles_rad.z()) * rotation_in(Plane::zx, angles_rad.y()) *
         rotation_in(Plane::yz, angles_rad.x());
}

}  // namespace

ProgramFrames::ProgramFrames(BlockContext& at, Modes& modes)
    : at_(at), modes_(modes), offsets_(at.options.work_offsets_mm) {
  for (const auto& [number, angles] : at.options.rotary_offsets_rad) offsets_.at(number).rotary_rad = angles;
  update();
}

void ProgramFrames::set_programmable(const Affine& frame) {
  programmable_ = frame;
  update();
}

void ProgramFrames::set_swivelled(const std::optional<Affine>& frame) {
  programmable_ = {};
  swivelled_ = frame;
  update();
}

/// Sets ModalState::work_offset: G54 to G57 by their number, G505 to G599 as G54.1 P5 to P99, G500 as 500.
void ProgramFrames::set_work_offset(int g) {
  const int number = g > 500 ? 540000 + g - 500 : g;
  if (number != modes_.state().work_offset) at_.refuse_under_radius(at_.words.offset(), fmt::format("G{}", g));
  if (g == 500 && !at_.options.work_offsets_mm.empty()) offsets_.at(500).known = true;
  modes_.change().work_offset = number;
  update();
}

Affine ProgramFrames::total() const {
  Affine out;
  const double angle = offsets_.rotation_rad(modes_.state().work_offset);
  if (angle != 0) out.linear = rotation_in(Plane::xy, angle);
  if (swivelled_) out = out.then_inside(*swivelled_);
  return out.then_inside(programmable_);
}

void ProgramFrames::update() {
  const Affine all = total();
  Frame frame;
  frame.origin_mm = offsets_.origin_mm(modes_.state().work_offset, at_.out.moves.empty());
  frame.linear = all.linear;
  frame.shift_mm = frame.origin_mm + all.shift_mm;
  frame.shift_only = frame.linear == Eigen::Matrix3d::Identity();
  frame.plain = frame.shift_only && frame.shift_mm == Vec3::Zero();
  if (!frame.shift_only) frame.inverse = frame.linear.inverse();
  if (frame == frame_) return;
  frame_ = frame;
  for (std::size_t i = 0; i < at_.out.frames.size(); ++i)
    if (at_.out.frames[i] == frame) {
      modes_.change().frame = static_cast<std::uint32_t>(i);
      return;
    }
  modes_.change().frame = static_cast<std::uint32_t>(at_.out.frames.size());
  at_.out.frames.push_back(frame);
}

void ProgramFrames::run_command() {
  const WordRow& row = *at_.request.frame;
  const std::string name(row.name);
  const bool additive = name.front() == 'A';
  if (at_.refuse_under_radius(at_.request.frame_offset, name)) return;
  const bool any = at_.words.has_any("XYZ") || at_.words.has(Extra::rpl);
  if (!additive) fine_shift_mm_ = Vec3::Zero();
  if (!any && !additive) {
    programmable_ = {};
    return update();
  }
  Affine own;
  Vec3 angles = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const Slot& slot = at_.words.of(kAxisLetters[axis]);
    if (!slot.given) continue;
    if (name.ends_with("TRANS")) {
      own.shift_mm[axis] = slot.value * modes_.unit_mm();
    } else if (name.ends_with("ROT")) {
      angles[axis] = rad_from_deg(slot.value);
    } else if (name.ends_with("MIRROR")) {
      own.linear(axis, axis) = -1;
    } else {
      if (!(slot.value >= 1e-3 && slot.value <= 1e3)) {
        at_.error(
            slot.offset, "scaling",
            fmt::format("{} scales {} by {:g}; 0.001 to 1000 was expected", name, kAxisLetters[axis], slot.value));
        return;
      }
      own.linear(axis, axis) = slot.value;
    }
  }
  if (name.ends_with("ROT")) {
    const Slot& rpl = at_.words.of(Extra::rpl);
    own.linear = rpl.given ? rotation_in(at_.plane, rad_from_deg(rpl.value)) : rpy(angles);
  }
  programmable_ = additive ? programmable_.then_inside(own) : own;
  update();
}

/// G58: the shift of TRANS, G59: a fine one beside it; of the axes in the block alone.
void ProgramFrames::set_programmable_shift() {
  for (int axis = 0; axis < 3; ++axis) {
    const Slot& slot = at_.words.of(kAxisLetters[axis]);
    if (!slot.given) continue;
    double &fine = fine_shift_mm_[axis], &shift = programmable_.shift_mm[axis];
    const double coarse = at_.request.shift == 58 ? slot.value * modes_.unit_mm() : shift - fine;
    if (at_.request.shift == 59) fine = slot.value * modes_.unit_mm();
    shift = coarse + fine;
  }
  update();
}

/// $P_UIFR[1,X,TR]=10, $P_UIFR[1]=CTRANS(...), $P_PFRAME=CROT(...), $TC_DP6[1,1]=5.
void ProgramFrames::set_variable(const std::string& name, const std::vector<double>& indexes,
                                 const std::vector<std::string>& index_names, const Value& value,
                                 std::uint32_t offset) {
  const auto whole_index = [&](std::size_t i) {
    return i < indexes.size() ? static_cast<int>(std::min(std::max(indexes[i], 0.0), 1e8)) : -1;
  };
  if (name == "$P_PFRAME") {
    if (!value.frame) return at_.error(offset, "type", "$P_PFRAME is a frame; CTRANS, CROT and the like were expected");
    programmable_ = *value.frame;
    return update();
  }
  if (name == "$P_UIFR" || name == "$P_IFRAME") {
    const int n = name == "$P_IFRAME" ? -1 : whole_index(0);
    const int number = name == "$P_IFRAME" ? modes_.state().work_offset : n == 0 ? 500 : n <= 4 ? 53 + n : 540000 + n;
    WorkOffset& work = offsets_.at(number);
    const auto warn = [&] {
      if (number == modes_.state().work_offset && !at_.out.moves.empty() && !work.known)
        at_.report.warning(
            offset, "work-offsets",
            "the assignment sets the work offset that the program has moved in; its previous position is "
            "not known and is assumed to be the same",
            "work offset set");
    };
    if (value.frame) {
      const Eigen::Matrix3d& m = value.frame->linear;
      const double angle = std::atan2(m(1, 0), m(0, 0));
      if ((m - rotation_in(Plane::xy, angle)).cwiseAbs().maxCoeff() > 1e-9)
        return at_.error(
            offset, "not-supported",
            fmt::format("{} with a rotation about X or Y, a mirror image or a scale is not supported; ROT, "
                        "MIRROR or SCALE in the program was expected",
                        name));
      warn();
      work.value_mm = value.frame->shift_mm;
      work.rotation_rad = angle;
      work.known = true;
      return update();
    }
    const std::size_t at = name == "$P_IFRAME" ? 0 : 1;
    const std::string axis = at < index_names.size() ? index_names[at] : "",
                      what = at + 1 < index_names.size() ? index_names[at + 1] : "";
    const int which = axis == "X" ? 0 : axis == "Y" ? 1 : axis == "Z" ? 2 : -1;
    if (which >= 0 && what == "TR" && !value.text) {
      warn();
      work.value_mm[which] = value.number * modes_.unit_mm();
      return update();
    }
    if (which == 2 && what == "RT" && !value.text) {
      work.rotation_rad = rad_from_deg(value.number);
      return update();
    }
    if (what == "FI" && !value.text && value.number == 0) return;
    return at_.error(
        offset, "not-supported",
        fmt::format("this part of {} is not supported; [n,X,TR], [n,Z,RT] or a whole frame was expected", name));
  }
  if (name == "$P_UBFR" || name == "$P_CHBFR" || name == "$P_BFRAME" || name == "$P_CHBFRAME" ||
      name == "$P_ACTFRAME" || name == "$P_SETFR" || name == "$P_PARTFR" || name == "$P_TOOLFR" || name == "$P_WPFR" ||
      name == "$P_CYCFR" || name == "$P_WPFRAME" || name == "$P_TOOLFRAME" || name == "$P_PARTFRAME" ||
      name == "$P_SETFRAME") {
    if (value.frame && value.frame->is_identity()) return;
    return at_.error(offset, "not-supported",
                     fmt::format("setting {} is not supported; TRANS, ROT or $P_UIFR was expected", name));
  }
  at_.report.warning(offset, "no-effect", fmt::format("{} is set without effect", name), name);
}

}  // namespace camber::nc::siemens
