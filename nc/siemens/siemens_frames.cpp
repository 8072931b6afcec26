// Where programmed coordinates lie: TRANS, ROT, SCALE, MIRROR, CYCLE800, frame variables.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/LU>

#include "base/units.h"
#include "nc/frames.h"
#include "nc/siemens/block_runner.h"

namespace camber::nc::siemens {
namespace {

constexpr char kAxisLetters[] = "XYZ";

/// About Z, then the new Y, then the new X: the order of ROT and of CROT (RPY angles).
Eigen::Matrix3d rpy(const Vec3& angles_rad) {
  return rotation_in(Plane::xy, angles_rad.z()) * rotation_in(Plane::zx, angles_rad.y()) *
         rotation_in(Plane::yz, angles_rad.x());
}

Eigen::Matrix3d about(int axis, double angle_deg) {
  return rotation_in(axis == 0 ? Plane::yz : axis == 1 ? Plane::zx : Plane::xy, rad_from_deg(angle_deg));
}

}  // namespace

Affine BlockRunner::total_frame() const {
  Affine out;
  const double angle = offsets_.rotation_rad(state_.work_offset);
  if (angle != 0) out.linear = rotation_in(Plane::xy, angle);
  if (swivelled_) out = out.then_inside(*swivelled_);
  return out.then_inside(programmable_);
}

void BlockRunner::update_frame() {
  const Affine total = total_frame();
  Frame frame;
  frame.origin_mm = offsets_.origin_mm(state_.work_offset, out_.moves.empty());
  frame.linear = total.linear;
  frame.shift_mm = frame.origin_mm + total.shift_mm;
  frame.shift_only = frame.linear == Eigen::Matrix3d::Identity();
  frame.plain = frame.shift_only && frame.shift_mm == Vec3::Zero();
  if (!frame.shift_only) frame.inverse = frame.linear.inverse();
  if (frame == frame_) return;
  frame_ = frame;
  change_state();
  for (std::size_t i = 0; i < out_.frames.size(); ++i)
    if (out_.frames[i] == frame) {
      state_.frame = static_cast<std::uint32_t>(i);
      return;
    }
  state_.frame = static_cast<std::uint32_t>(out_.frames.size());
  out_.frames.push_back(frame);
}

void BlockRunner::run_frame_command() {
  const WordRow& row = *request_.frame;
  const std::string name(row.name);
  const bool additive = name.front() == 'A';
  if (radius_.active && radius_.radius_mm != 0) {
    error(request_.frame_offset, "cutter-radius",
          fmt::format("{} under G{}; G40 was expected before", name, radius_.g));
    return;
  }
  const bool any = words_.has_any("XYZ") || words_.has(Extra::rpl);
  if (!additive) fine_shift_mm_ = Vec3::Zero();
  if (!any && !additive) {
    programmable_ = {};
    return update_frame();
  }
  Affine own;
  Vec3 angles = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const Slot& slot = words_.of(kAxisLetters[axis]);
    if (!slot.given) continue;
    if (name.ends_with("TRANS")) {
      own.shift_mm[axis] = slot.value * unit_mm();
    } else if (name.ends_with("ROT")) {
      angles[axis] = rad_from_deg(slot.value);
    } else if (name.ends_with("MIRROR")) {
      own.linear(axis, axis) = -1;
    } else {
      if (!(slot.value >= 1e-3 && slot.value <= 1e3)) {
        error(slot.offset, "scaling",
              fmt::format("{} scales {} by {:g}; 0.001 to 1000 was expected", name, kAxisLetters[axis], slot.value));
        return;
      }
      own.linear(axis, axis) = slot.value;
    }
  }
  if (name.ends_with("ROT")) {
    const Slot& rpl = words_.of(Extra::rpl);
    own.linear = rpl.given ? rotation_in(plane_, rad_from_deg(rpl.value)) : rpy(angles);
  }
  programmable_ = additive ? programmable_.then_inside(own) : own;
  update_frame();
}

/// G58: the shift of TRANS, G59: a fine one beside it; of the axes in the block alone.
void BlockRunner::set_programmable_shift() {
  for (int axis = 0; axis < 3; ++axis) {
    const Slot& slot = words_.of(kAxisLetters[axis]);
    if (!slot.given) continue;
    double &fine = fine_shift_mm_[axis], &shift = programmable_.shift_mm[axis];
    const double coarse = request_.shift == 58 ? slot.value * unit_mm() : shift - fine;
    if (request_.shift == 59) fine = slot.value * unit_mm();
    shift = coarse + fine;
  }
  update_frame();
}

/// $P_UIFR[1,X,TR]=10, $P_UIFR[1]=CTRANS(...), $P_PFRAME=CROT(...), $TC_DP6[1,1]=5.
void BlockRunner::set_frame_variable(const std::string& name, const std::vector<double>& indexes,
                                     const std::vector<std::string>& index_names, const Value& value,
                                     std::uint32_t offset) {
  const auto whole_index = [&](std::size_t i) {
    return i < indexes.size() ? static_cast<int>(std::min(std::max(indexes[i], 0.0), 1e8)) : -1;
  };
  if (name == "$P_PFRAME") {
    if (!value.frame) return error(offset, "type", "$P_PFRAME is a frame; CTRANS, CROT and the like were expected");
    programmable_ = *value.frame;
    return update_frame();
  }
  if (name == "$P_UIFR" || name == "$P_IFRAME") {
    const int n = name == "$P_IFRAME" ? -1 : whole_index(0);
    const int number = name == "$P_IFRAME" ? state_.work_offset : n == 0 ? 500 : n <= 4 ? 53 + n : 540000 + n;
    WorkOffset& work = offsets_.at(number);
    const auto warn = [&] {
      if (number == state_.work_offset && !out_.moves.empty() && !work.known)
        report_.warning(offset, "work-offsets",
                        "the assignment sets the work offset that the program has moved in; its previous position is "
                        "not known and is assumed to be the same",
                        "work offset set");
    };
    if (value.frame) {
      const Eigen::Matrix3d& m = value.frame->linear;
      const double angle = std::atan2(m(1, 0), m(0, 0));
      if ((m - rotation_in(Plane::xy, angle)).cwiseAbs().maxCoeff() > 1e-9)
        return error(offset, "not-supported",
                     fmt::format("{} with a rotation about X or Y, a mirror image or a scale is not supported; ROT, "
                                 "MIRROR or SCALE in the program was expected",
                                 name));
      warn();
      work.value_mm = value.frame->shift_mm;
      work.rotation_rad = angle;
      work.known = true;
      return update_frame();
    }
    const std::size_t at = name == "$P_IFRAME" ? 0 : 1;
    const std::string axis = at < index_names.size() ? index_names[at] : "",
                      what = at + 1 < index_names.size() ? index_names[at + 1] : "";
    const int which = axis == "X" ? 0 : axis == "Y" ? 1 : axis == "Z" ? 2 : -1;
    if (which >= 0 && what == "TR" && !value.text) {
      warn();
      work.value_mm[which] = value.number * unit_mm();
      return update_frame();
    }
    if (which == 2 && what == "RT" && !value.text) {
      work.rotation_rad = rad_from_deg(value.number);
      return update_frame();
    }
    if (what == "FI" && !value.text && value.number == 0) return;
    return error(
        offset, "not-supported",
        fmt::format("this part of {} is not supported; [n,X,TR], [n,Z,RT] or a whole frame was expected", name));
  }
  if ((name == "$TC_DP6" || name == "$TC_DP3") && !value.text) {
    ToolOffset& tool = tool_offsets_[whole_index(0)];
    (name == "$TC_DP6" ? tool.radius_mm : tool.length_mm) = value.number * unit_mm();
    return update_tool_length();
  }
  if (name == "$P_UBFR" || name == "$P_CHBFR" || name == "$P_BFRAME" || name == "$P_CHBFRAME" ||
      name == "$P_ACTFRAME" || name == "$P_SETFR" || name == "$P_PARTFR" || name == "$P_TOOLFR" || name == "$P_WPFR" ||
      name == "$P_CYCFR" || name == "$P_WPFRAME" || name == "$P_TOOLFRAME" || name == "$P_PARTFRAME" ||
      name == "$P_SETFRAME") {
    if (value.frame && value.frame->is_identity()) return;
    return error(offset, "not-supported",
                 fmt::format("setting {} is not supported; TRANS, ROT or $P_UIFR was expected", name));
  }
  report_.warning(offset, "no-effect", fmt::format("{} is set without effect", name), name);
}

/// CYCLE800(_FR, _TC, _ST, _MODE, _X0, _Y0, _Z0, _A, _B, _C, _X1, _Y1, _Z1, _DIR, _FR_I, _DMODE): a plane is swivelled.
/// Without parameters, or with the data set "0": back. _MODE: bits 6 and 7 say how the angles count (0: axis by axis,
/// 1: solid angle, 2: projection angle, 3: the rotary axes directly); the pairs of bits below, which axis is turned
/// first, second and third (1: X, 2: Y, 3: Z). _ST: digit 1 (ones): a new plane (0) or one that adds (1).
void BlockRunner::swivel(const CycleCall& call, const BlockPlace&) {
  const std::size_t at = call.offset;
  if (radius_.active && radius_.radius_mm != 0)
    return error(at, "cutter-radius", fmt::format("CYCLE800 under G{}; G40 was expected before", radius_.g));
  if (state_.tip_control != TipControl::off)
    return error(at, "tilted-frame", "CYCLE800 under TRAORI; TRAFOOF was expected before");
  const bool back =
      call.text(1) == "0" || std::ranges::none_of(call.values, [](const auto& v) { return v.has_value(); });
  const int st = static_cast<int>(call.number(2)), mode = static_cast<int>(call.number(3));
  const bool additive = st % 10 == 1 && swivelled_;
  const Vec3 before_mm(call.number(4), call.number(5), call.number(6)),
      angle(call.number(7), call.number(8), call.number(9)),
      behind_mm(call.number(10), call.number(11), call.number(12));
  Affine own;
  own.shift_mm = before_mm * unit_mm();
  const int kind = mode >> 6 & 3;
  if (!back) {
    if (kind == 0) {
      for (int i = 0; i < 3; ++i) {
        const int axis = (mode >> (2 * i) & 3) - 1;
        if (axis >= 0) own.linear = own.linear * about(axis, angle[i]);
      }
    } else if (angle != Vec3::Zero()) {
      return error(
          at, "not-supported",
          fmt::format(
              "CYCLE800 with {} (mode {}) is not supported; angles axis by axis (mode 57, 27, 39 ...) were expected",
              kind == 1   ? "solid angles"
              : kind == 2 ? "projection angles"
                          : "rotary axes given directly",
              mode));
    }
    own.shift_mm += own.linear * behind_mm * unit_mm();
  }
  programmable_ = {};
  if (back)
    swivelled_.reset();
  else
    swivelled_ = additive ? swivelled_->then_inside(own) : own;
  const bool tilted = swivelled_ && swivelled_->linear != Eigen::Matrix3d::Identity();
  if (tilted && options_.rotary_axes.empty()) {
    error(
        at, "not-read",
        fmt::format("CYCLE800 (plane swivelled by {:g}, {:g}, {:g} degrees) is read on a machine with [kinematics], by "
                    "camber check, time, feed, fit-feed, predict, compensate and post",
                    angle.x(), angle.y(), angle.z()),
        "CYCLE800");
    swivelled_.reset();
    return update_frame();
  }
  update_frame();
  if (options_.rotary_axes.empty()) return;
  const WorkFrame frame = tilted ? WorkFrame::tilted : WorkFrame::machine;
  const bool turns = tilted || aligned_ || state_.work_frame != WorkFrame::machine || rotary_axes_turned();
  state_.work_frame = frame;
  change_state();
  const int direction = static_cast<int>(call.number(13));
  if (!turns || (!back && direction == 0)) {  // 0: the frame alone, no motion
    if (!out_.moves.empty() && rotary_axes_turned()) open_axes("CYCLE800");
    return;
  }
  RotaryTarget target;
  target.is_direction = true;
  direction_code_ = "CYCLE800";
  target.end = frame_.linear.col(2).normalized();
  if (!tilted) {  // back: the rotary axes go to zero
    target.is_direction = false;
    target.end = Vec3::Zero();
    for (const RotaryOption& axis : options_.rotary_axes)
      target.given = static_cast<std::uint8_t>(target.given | 1U << (axis.letter - 'A'));
  }
  rotary_target_ = target;
  aligned_ = tilted;
  open_axes("CYCLE800");
  check_unit();
  Move& move = add_move(MoveKind::rapid, position_mm_);
  move.editable = false;
}

void BlockRunner::settle_machine_axis(std::size_t axis, double machine_mm, Vec3& place_mm) {
  const auto index = static_cast<Eigen::Index>(axis);
  place_mm[index] = machine_mm;
  place_[axis] = AxisPlace::reference;
  if (axis == 2) return;  // the height needs the tool's length
  if (const auto origin = offsets_.machine_origin_mm(state_.work_offset)) {
    place_mm[index] = machine_mm + (*origin)[index];
    place_[axis] = AxisPlace::known;
  }
}

/// WORKPIECE(,"",,"BOX",112,Z0,Z1,ZB,X0,Y0,X1,Y1): the stock. Bits of the mask: 16: Z1 is absolute, 64: X1 and Y1 are;
/// else they count from Z0, X0 and Y0.
void BlockRunner::set_stock(const CycleCall& call, std::uint32_t block) {
  const std::string kind = call.text(3);
  if (out_.stock || (kind != "BOX" && kind != "CYLINDER" && kind != "RECTANGLE")) return;
  const double z0 = call.number(5), z1 = call.number(6);
  ProgramStock stock;
  stock.block = block;
  const auto mask = static_cast<unsigned>(std::max(0.0, call.number(4)));
  const double bottom = (mask & 16U) != 0 ? z1 : z0 + z1;
  if (kind == "BOX") {
    const double x0 = call.number(8), y0 = call.number(9), x1 = call.number(10), y1 = call.number(11);
    const double xe = (mask & 64U) != 0 || mask == 0 ? x1 : x0 + x1, ye = (mask & 64U) != 0 || mask == 0 ? y1 : y0 + y1;
    stock.min_mm = Vec3(std::min(x0, xe), std::min(y0, ye), std::min(z0, bottom));
    stock.max_mm = Vec3(std::max(x0, xe), std::max(y0, ye), std::max(z0, bottom));
  } else if (kind == "CYLINDER") {
    const double radius = call.number(8) / 2;
    stock.cylinder = true;
    stock.min_mm = Vec3(-radius, -radius, std::min(z0, bottom));
    stock.max_mm = Vec3(radius, radius, std::max(z0, bottom));
  } else {  // width, length about the centre
    const double width = call.number(8), length = call.number(9);
    stock.min_mm = Vec3(-width / 2, -length / 2, std::min(z0, bottom));
    stock.max_mm = Vec3(width / 2, length / 2, std::max(z0, bottom));
  }
  stock.min_mm = frame_.from_program(stock.min_mm * unit_mm());
  stock.max_mm = frame_.from_program(stock.max_mm * unit_mm());
  if ((stock.max_mm - stock.min_mm).minCoeff() > 0) out_.stock = stock;
}

}  // namespace camber::nc::siemens
