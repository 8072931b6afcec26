// Cycles as moves. Parameters as in "Programming cycles externally" (Programming Manual, Work Preparation).
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/frames.h"
#include "nc/siemens/block_runner.h"

namespace camber::nc::siemens {
namespace {

/// Pitches of metric coarse threads by their nominal diameter (ISO 261): MPIT.
double coarse_pitch(double nominal_mm) {
  constexpr std::pair<double, double> kPitches[] = {{3, 0.5},   {4, 0.7},  {5, 0.8},  {6, 1},    {8, 1.25}, {10, 1.5},
                                                    {12, 1.75}, {14, 2},   {16, 2},   {18, 2.5}, {20, 2.5}, {22, 2.5},
                                                    {24, 3},    {27, 3},   {30, 3.5}, {33, 3.5}, {36, 4},   {39, 4},
                                                    {42, 4.5},  {45, 4.5}, {48, 5}};
  for (const auto& [nominal, pitch] : kPitches)
    if (std::abs(nominal - nominal_mm) < 1e-9) return pitch;
  return 0;
}

}  // namespace

/// WORKPIECE(,"",,"BOX",112,Z0,Z1,ZB,X0,Y0,X1,Y1): the stock. Bits of the mask: 16: Z1 is absolute, 64: X1 and Y1 are;
/// else they count from Z0, X0 and Y0.
void Cycles::set_stock(const CycleCall& call, std::uint32_t block) {
  const std::string kind = call.text(3);
  if (at_.out.stock || (kind != "BOX" && kind != "CYLINDER" && kind != "RECTANGLE")) return;
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
  stock.min_mm = frames_.frame().from_program(stock.min_mm * modes_.unit_mm());
  stock.max_mm = frames_.frame().from_program(stock.max_mm * modes_.unit_mm());
  if ((stock.max_mm - stock.min_mm).minCoeff() > 0) at_.out.stock = stock;
}

/// A step of a cycle, in program coordinates.
void Cycles::go(CycleStep::Kind kind, const Vec3& program_mm, double feed_mm_per_s, int g) {
  if (kind != CycleStep::Kind::dwell && (program_mm - mover_.programmed()).cwiseAbs().maxCoeff() < 1e-9) return;
  const MoveKind move_kind = kind == CycleStep::Kind::rapid   ? MoveKind::rapid
                             : kind == CycleStep::Kind::dwell ? MoveKind::dwell
                                                              : MoveKind::linear;
  const Vec3 before = mover_.programmed();
  Move& move = mover_.add_move(
      move_kind, kind == CycleStep::Kind::dwell ? mover_.position_mm() : frames_.frame().from_program(program_mm));
  ++count_;
  move.canned = true;
  move.cycle = static_cast<std::uint8_t>(g);
  if (kind == CycleStep::Kind::feed) move.feed_mm_per_s = feed_mm_per_s;
  if (kind == CycleStep::Kind::dwell) move.dwell_s = feed_mm_per_s;
  for (int axis = 0; axis < 3; ++axis)
    if (program_mm[axis] != before[axis]) mover_.set_place(axis, AxisPlace::known);
}

void Cycles::rapid_to_height(double height_mm) {
  Vec3 end = mover_.programmed();
  end[at_.axes().normal] = height_mm;
  go(CycleStep::Kind::rapid, end, 0, 0);
}

void Cycles::go_round(const Vec3& end, const Vec3& centre, double sweep_rad, double feed_mm_per_s) {
  Arc arc;
  arc.center_mm = centre;
  arc.center_mm[at_.axes().normal] = mover_.programmed()[at_.axes().normal];
  arc.normal = normal_of(at_.plane);
  arc.sweep_rad = sweep_rad;
  const auto in_moves = frames_.frame().plain ? arc : from_program(frames_.frame(), arc);
  if (!in_moves) return at_.refuse_ellipse();
  at_.out.arcs.push_back(*in_moves);
  Move& move = mover_.add_move(MoveKind::arc, frames_.frame().from_program(end));
  ++count_;
  move.arc = static_cast<std::uint32_t>(at_.out.arcs.size() - 1);
  move.canned = true;
  move.feed_mm_per_s = feed_mm_per_s;
}

/// The feed of a cycle: its own parameter, or the one that is active.
std::optional<double> Cycles::cycle_feed(double given, const CycleCall& call, const char* what) {
  if (given > 0)
    return modes_.state().feed_mode == FeedMode::per_revolution
               ? given * modes_.unit_mm() * modes_.state().spindle_speed_rpm / 60
               : mm_per_s_from_mm_per_min(given * modes_.unit_mm());
  if (modes_.state().feed_mode == FeedMode::inverse_time) {
    at_.error(call.offset, "cycle", fmt::format("{} in inverse time (G93); G94 was expected before", call.row->name));
    return std::nullopt;
  }
  if (!modes_.feed() || *modes_.feed() == 0) {
    at_.error(call.offset, "feed-missing",
              fmt::format("{} without a feed ({}); F greater than zero was expected before", call.row->name, what),
              "feed");
    return std::nullopt;
  }
  return modes_.cutting_feed(0, std::string(call.row->name).c_str());
}

/// CYCLE81 to CYCLE89 and CYCLE840 where the tool stands. RTP, RFP, SDIS, DP, DPR come first in all of them.
void Cycles::drill(const CycleCall& call) {
  const std::string name(call.row->name);
  const int cycle = std::stoi(name.substr(5)), g = cycle == 840 ? 84 : cycle;
  modes_.check_unit();
  const int normal = at_.axes().normal;
  const auto of_normal = static_cast<std::uint8_t>(1U << static_cast<unsigned>(normal));
  const bool height_open = mover_.open_axes() == of_normal;  // the way to the reference plane gives it
  if (height_open)
    mover_.close_axes();
  else
    mover_.settle_axes_for(name.c_str(), false);
  mover_.prepare_cutting(name.c_str());
  if (at_.refuse_under_radius(call.offset, name)) return;
  if (!call.has(0))
    return at_.error(call.offset, "cycle",
                     fmt::format("{} has no retraction plane; RTP, its first value, was expected", name),
                     name + " RTP");
  const double unit = modes_.unit_mm();
  const double reference = call.number(1) * unit, level = reference + std::abs(call.number(2)) * unit;
  const double rtp = call.number(0) * unit;
  if (!call.has(3) && !call.has(4))
    return at_.error(call.offset, "cycle",
                     fmt::format("{} has no depth; DP or DPR, its fourth or fifth value, was expected", name),
                     name + " DP");
  const double bottom = bottom_mm(call);
  if (bottom > level)
    return at_.error(
        call.offset, "cycle",
        fmt::format("the bottom of {} at {:.4f} mm is above its reference plane with safety clearance, {:.4f} mm", name,
                    bottom, level));
  if (cycle == 81 && static_cast<int>(call.number(6)) / 10 % 10 == 1)
    return at_.error(call.offset, "not-supported",
                     "CYCLE81 by the diameter of the centring is not supported; a depth was expected");
  if (count_ > kMaxCycleMoves)
    return at_.error(call.offset, "cycle", fmt::format("the cycles make more than {} moves", kMaxCycleMoves),
                     "cycle moves");
  const auto at = [&](double height) {
    Vec3 p = mover_.programmed();
    p[normal] = height;
    return p;
  };
  const auto rapid = [&](double height) { go(CycleStep::Kind::rapid, at(height), 0, g); };
  const auto feed_to = [&](double height, double feed) { go(CycleStep::Kind::feed, at(height), feed, g); };
  const auto wait = [&](double seconds) {
    if (seconds < 0)
      seconds = modes_.state().spindle_speed_rpm > 0 ? -seconds * 60 / modes_.state().spindle_speed_rpm : 0;
    if (seconds > 0) go(CycleStep::Kind::dwell, mover_.programmed(), seconds, g);
  };
  const bool tapping = cycle == 84 || cycle == 840;
  std::optional<double> feed;
  double out_feed = 0;
  const double speed_before = modes_.state().spindle_speed_rpm;
  if (tapping) {
    const std::size_t mpit = cycle == 84 ? 7 : 9, pit = cycle == 84 ? 8 : 10;
    double pitch = std::abs(call.number(pit));
    const int pitch_unit = cycle == 84 ? static_cast<int>(call.number(13)) : 0;
    pitch = pitch_unit == 2   ? (pitch > 0 ? kMmPerInch / pitch : 0)
            : pitch_unit == 3 ? pitch * kMmPerInch
                              : pitch * unit;
    if (pitch == 0 && call.has(mpit)) pitch = coarse_pitch(std::abs(call.number(mpit)));
    const double speed = cycle == 84 && call.number(10) > 0 ? call.number(10) : modes_.state().spindle_speed_rpm;
    if (pitch > 0 && speed > 0) {
      feed = pitch * speed / 60;
      const double back = cycle == 84 && call.number(11) > 0 ? call.number(11) : speed;
      out_feed = pitch * back / 60;
      if (cycle == 84 && speed != modes_.state().spindle_speed_rpm) {
        modes_.change().spindle_speed_rpm = speed;
      }
    } else if (pitch == 0) {
      if (cycle == 84)
        at_.report.warning(call.offset, "cycle",
                           "CYCLE84 has no pitch (PIT or MPIT), which the control refuses; the active F is taken",
                           "CYCLE84 pitch");
      feed = cycle_feed(0, call, "F");
      out_feed = feed.value_or(0);
    } else {
      return at_.error(call.offset, "cycle", fmt::format("{} has no speed; SST or S was expected", name), name);
    }
  } else {
    feed = cycle_feed(cycle == 85 ? call.number(6) : 0, call, "F");
  }
  if (!feed) return;
  if (height_open && std::abs(mover_.programmed()[normal] - level) < 1e-9)
    mover_.stand_at(frames_.frame().from_program(at(level + 1)));
  rapid(level);
  switch (cycle) {
    case 83: {
      const double first_depth = call.has(6) && call.number(6) > 0 ? reference - call.number(6) * unit
                                 : call.has(5)                     ? call.number(5) * unit
                                                                   : bottom;
      const int amode = static_cast<int>(call.number(19));
      const double dam = call.number(7), least = call.number(13) * unit;
      const bool percent = amode / 100000 % 10 == 2;
      const double factor = percent ? dam / 100 : dam < 0 ? -dam : 1;
      double frf = call.number(10, 1);
      if (frf > 1) frf /= 100;
      if (!(frf > 0)) frf = 1;
      const bool removes = static_cast<int>(call.number(11)) != 0;
      const double chip_retract = call.number(14) > 0 ? call.number(14) * unit : 1.0;
      const double hole = reference - bottom;
      const double ahead = call.number(16) > 0 ? call.number(16) * unit : hole <= 30 ? 0.6 : std::min(hole / 50, 7.0);
      double depth = std::clamp(first_depth, bottom, level), stroke = reference - depth;
      if (!(stroke > 1e-6)) stroke = std::max(level - depth, 1e-3);
      if (hole / std::max(std::min(stroke, least > 0 ? least : stroke), 1e-9) > kMaxPecks)
        return at_.error(call.offset, "cycle",
                         "CYCLE83 would peck more than 100000 times; a larger first depth was expected");
      feed_to(depth, *feed * frf);
      while (depth > bottom + 1e-9) {
        wait(call.number(8));
        if (removes) {
          rapid(level);
          wait(call.number(9));
          rapid(std::min(depth + ahead, level));
        } else {
          rapid(std::min(depth + chip_retract, level));
        }
        if (percent || dam < 0) {
          stroke = std::max(stroke * std::clamp(factor, 0.001, 1.0), least > 0 ? least : 0.01 * unit);
        } else if (dam > 0) {
          const double amount = dam * unit, rest = depth - bottom;
          stroke = std::max(stroke - amount > amount ? stroke - amount : amount, least);
          if (stroke <= amount && rest < 2 * amount && rest > amount) stroke = rest / 2;
        }
        depth = std::max(depth - stroke, bottom);
        feed_to(depth, *feed);
        if (count_ > kMaxCycleMoves) break;
      }
      wait(call.has(15) ? call.number(15) : 0);
      rapid(rtp);
      return;
    }
    case 84:
    case 840:
      feed_to(bottom, *feed);
      wait(call.number(5));
      feed_to(level, out_feed);
      if (modes_.state().spindle_speed_rpm != speed_before) {
        modes_.change().spindle_speed_rpm = speed_before;
      }
      rapid(rtp);
      return;
    case 85: {
      feed_to(bottom, *feed);
      wait(call.number(5));
      const auto back = cycle_feed(call.number(7), call, "RFF");
      feed_to(level, back.value_or(*feed));
      rapid(rtp);
      return;
    }
    case 86: {
      feed_to(bottom, *feed);
      wait(call.number(5));
      const PlaneAxes axes = at_.axes();
      const Vec3 hole = mover_.programmed();
      Vec3 off = hole;
      off[axes.first] += call.number(7) * unit;
      off[axes.second] += call.number(8) * unit;
      off[normal] += call.number(9) * unit;
      go(CycleStep::Kind::rapid, off, 0, 76);
      off[normal] = std::max(level, off[normal]);
      go(CycleStep::Kind::rapid, off, 0, 76);
      Vec3 end = hole;
      end[normal] = rtp;
      go(CycleStep::Kind::rapid, end, 0, 76);
      return;
    }
    case 89:
      feed_to(bottom, *feed);
      wait(call.number(5));
      feed_to(level, *feed);
      rapid(rtp);
      return;
    default:  // 81, 82, 87, 88
      feed_to(bottom, *feed);
      if (cycle == 82 || cycle == 88 || (cycle == 81 && call.values.size() > 6)) wait(call.number(5));
      rapid(rtp);
      return;
  }
}

/// DP, or DPR below the reference plane where it is given.
double Cycles::bottom_mm(const CycleCall& call) const {
  const bool by_dpr = call.has(4) && (call.number(4) != 0 || !call.has(3));
  return (by_dpr ? call.number(1) - std::abs(call.number(4)) : call.number(3)) * modes_.unit_mm();
}

bool Cycles::begin_milling(const CycleCall& call) {
  const std::string name(call.row->name);
  modes_.check_unit();
  mover_.settle_axes_for(name.c_str(), false);
  return !at_.refuse_under_radius(call.offset, name);
}

/// Of the tool's offset, else of its cutter; 0: nothing gives it, which an error says where a cycle cannot do without.
double Cycles::cutter_radius_mm(const CycleCall& call, bool needed) {
  if (const ToolOffset* tool = tools_.offset(modes_.state().tool); tool && tools_.edge() != 0)
    if (const auto radius = tool->effective_radius_mm()) return *radius;
  const double radius = nc::cutter_radius_mm(at_.options.tool_offsets, modes_.state().tool).value_or(0);
  if (radius <= 0 && needed)
    at_.error(
        call.offset, "radius-unknown",
        fmt::format("{} needs the radius of tool {}, which nothing gives; the diameter of the cutter was expected in "
                    "the job",
                    call.row->name, modes_.state().tool));
  return radius;
}

/// CYCLE90: a helix on the thread's diameter, less or more the tool's radius, with semicircles in and out.
void Cycles::mill_thread(const CycleCall& call) {
  const std::string name(call.row->name);
  if (!begin_milling(call)) return;
  const double unit = modes_.unit_mm();
  const double rtp = call.number(0) * unit, reference = call.number(1) * unit,
               level = reference + std::abs(call.number(2)) * unit;
  const double bottom = bottom_mm(call);
  const double pitch = std::abs(call.number(7)) * unit, nominal = call.number(5) * unit, core = call.number(6) * unit;
  const bool outside = call.number(10) == 1, clockwise = call.number(9) == 2;
  if (!(pitch > 0) || !(nominal > 0) || !(core > 0) || bottom > level || !call.has(0))
    return at_.error(call.offset, "cycle",
                     fmt::format("{} needs RTP, a depth below the reference plane, DIATH, KDIAM and PIT", name));
  const auto feed = cycle_feed(call.number(8), call, "FFR");
  if (!feed) return;
  const double cutter = cutter_radius_mm(call, false);
  if (cutter == 0)
    at_.report.warning(call.offset, "radius-unknown",
                       fmt::format("no radius is given for tool {}; {} takes 0", modes_.state().tool, name), name);
  const double radius = outside ? core / 2 + cutter : nominal / 2 - cutter;
  if (!(radius > 0))
    return at_.error(
        call.offset, "cycle",
        fmt::format("the cutter of {:.3f} mm does not go into the thread of {:.3f} mm", 2 * cutter, nominal));
  at_.report.warning(call.offset, "cycle",
                     fmt::format("the ways in and out of {} are taken as semicircles; the control's may differ", name),
                     name + " ways");
  const PlaneAxes axes = at_.axes();
  Vec3 centre = mover_.programmed();
  centre[axes.first] = call.number(11) * unit;
  centre[axes.second] = call.number(12) * unit;
  const auto place = [&](double along, double height) {
    Vec3 p = centre;
    p[axes.first] += along;
    p[axes.normal] = height;
    return p;
  };
  // Inside from the centre, outside from beside the thread, both on the positive first axis.
  const double start = outside ? radius + 2 * std::max(cutter, pitch) : 0;
  const double sign = clockwise ? -1 : 1;
  rapid_to_height(std::max(mover_.programmed()[axes.normal], rtp));
  go(CycleStep::Kind::rapid, place(start, mover_.programmed()[axes.normal]), 0, 0);
  go(CycleStep::Kind::rapid, place(start, level), 0, 0);
  mover_.set_places(AxisPlace::known);
  go_round(place(radius, level), place((start + radius) / 2, level), (outside ? -sign : sign) * kPi, *feed);
  const double turns = (level - bottom) / pitch, sweep = sign * 2 * kPi * turns;
  if (turns > 1000)
    return at_.error(call.offset, "cycle",
                     fmt::format("{} would make {:.0f} turns; a larger PIT was expected", name, turns));
  Vec3 end = place(0, bottom);
  end[axes.first] += radius * std::cos(sweep);
  end[axes.second] += radius * std::sin(sweep);
  go_round(end, centre, sweep, *feed);
  const double out_by = outside ? start - radius : -radius;
  const Vec3 direction = (end - place(0, bottom)) / radius;
  Vec3 off = end + direction * out_by, middle = end + direction * (out_by / 2);
  go_round(off, middle, (outside ? -sign : sign) * kPi, *feed);
  rapid_to_height(rtp);
}

/// POCKET3(RTP, RFP, SDIS, DP, LENG, WID, CRAD, PA, PO, STA, MID, FAL, FALD, FFP1, FFD, CDIR, VARI, MIDA, AP1, AP2, AD,
/// RAD1, DP1, UMODE, FS, ZFS, GMODE, DMODE, AMODE); POCKET4 with a radius in place of LENG, WID and CRAD, without STA
/// and AP2. DMODE and AMODE: digits of newer controls.
void Cycles::mill_pocket(const CycleCall& call) {
  const std::string name(call.row->name);
  const bool round = name == "POCKET4";
  const std::size_t mid = round ? 7 : 10, place = round ? 5 : 7, gmode = round ? 22 : 26;
  const double unit = modes_.unit_mm(), cutter = cutter_radius_mm(call, true);
  if (!begin_milling(call) || cutter <= 0) return;
  const int vari = call.digit(mid + 6, 1);
  if (vari > 2 && vari != 4)
    return at_.error(
        call.offset, "not-supported",
        fmt::format("{} with VARI {} is not supported; roughing (1) or finishing (2, 4) was expected", name, vari));
  PocketCycle pocket;
  pocket.round = round;
  const PlaneAxes axes = at_.axes();
  pocket.middle_mm = mover_.programmed();
  pocket.middle_mm[axes.first] = call.number(place) * unit;
  pocket.middle_mm[axes.second] = call.number(place + 1) * unit;
  const bool diameter = call.digit(gmode + 1, 100) == 1;
  double whole[2] = {call.number(4) * unit * (round && !diameter ? 2 : 1), 0};
  whole[1] = round ? whole[0] : call.number(5) * unit;
  if (!round) {
    pocket.angle_rad = rad_from_deg(call.number(9));
    pocket.corner_mm = std::max(0.0, call.number(6) * unit - cutter);
    // A corner in place of the middle: 2 ++, 3 -+, 4 +-, 5 --.
    if (const int corner = call.digit(gmode, 1000); corner >= 2 && corner <= 5) {
      const double x = (corner % 2 == 0 ? 0.5 : -0.5) * std::abs(whole[0]),
                   y = (corner < 4 ? 0.5 : -0.5) * std::abs(whole[1]);
      const double c = std::cos(pocket.angle_rad), s = std::sin(pocket.angle_rad);
      pocket.middle_mm[axes.first] += c * x - s * y;
      pocket.middle_mm[axes.second] += s * x + c * y;
    }
  }
  for (int i = 0; i < 2; ++i) pocket.half_mm[i] = 0.5 * std::abs(whole[i]) - cutter;
  pocket.surface_mm = call.number(1) * unit;
  pocket.clearance_mm = pocket.surface_mm + std::abs(call.number(2)) * unit;
  pocket.bottom_mm =
      call.digit(gmode + 2, 1) == 1 ? pocket.surface_mm - std::abs(call.number(3)) * unit : call.number(3) * unit;
  pocket.side_mm = std::abs(call.number(mid + 1)) * unit;
  pocket.floor_mm = std::abs(call.number(mid + 2)) * unit;
  const double whole_depth = pocket.surface_mm - pocket.bottom_mm;
  pocket.step_mm = call.number(mid) > 0 ? call.number(mid) * unit : whole_depth;
  pocket.finishing_step_mm = pocket.step_mm;
  const double mida = call.number(mid + 7);
  pocket.sideways_mm = !(mida > 0)                      ? 1.6 * cutter
                       : call.digit(gmode + 2, 10) == 1 ? mida / 100 * 2 * cutter
                                                        : mida * unit;
  pocket.roughs = vari <= 1;
  pocket.finishes = vari != 1;
  if (!(whole_depth > 0) || pocket.least_mm() - pocket.side_mm < -1e-9)
    return at_.error(
        call.offset, whole_depth > 0 ? "cutter-too-large" : "cycle",
        fmt::format("{} needs a depth below its reference plane, and sides in which the tool of {:.3f} mm and the "
                    "allowance have room",
                    name, 2 * cutter));
  const auto feed = cycle_feed(call.number(mid + 3), call, "FFP1");
  if (!feed) return;
  pocket.feed_mm_per_s = pocket.finishing_mm_per_s = *feed;
  pocket.plunge_mm_per_s =
      call.number(mid + 4) > 0 ? cycle_feed(call.number(mid + 4), call, "FFD").value_or(*feed) : *feed;
  pocket.sense = sense_of(call.digit(mid + 5, 1));
  run_pocket(pocket, call);
}

/// CDIR: 0 climb cutting, 1 conventional, by the sense of the spindle; 2 G2, 3 G3.
double Cycles::sense_of(int cdir) const {
  const bool turns_back = modes_.state().spindle == SpindleDirection::counter_clockwise;
  return cdir == 3 || (cdir < 2 && (cdir == 0) != turns_back) ? 1 : -1;
}

/// Mills it from RTP, with rapids over its middle, and back to RTP.
void Cycles::run_pocket(const PocketCycle& pocket, const CycleCall& call) {
  const std::string name(call.row->name);
  at_.report.warning(call.offset, "cycle",
                     fmt::format("the plunge of {} and its ways from ring to ring are taken as straight lines; the "
                                 "control's differ",
                                 name),
                     name + " ways");
  const PlaneAxes axes = at_.axes();
  const double rtp = call.number(0) * modes_.unit_mm();
  const PocketMoves moves{[this](const Vec3& end, double speed) {
                            go(std::isinf(speed) ? CycleStep::Kind::rapid : CycleStep::Kind::feed, end, speed, 0);
                          },
                          [this](const Vec3& centre, double sweep, double speed) {
                            const Vec3 from = mover_.programmed();
                            go_round(centre + rotation_in(at_.plane, sweep) * (from - centre), centre, sweep, speed);
                          }};
  rapid_to_height(std::max(mover_.programmed()[axes.normal], rtp));
  Vec3 over = pocket.middle_mm;
  over[axes.normal] = mover_.programmed()[axes.normal];
  go(CycleStep::Kind::rapid, over, 0, 0);
  mover_.set_places(AxisPlace::known);
  if (!nc::mill_pocket(pocket, axes, mover_.programmed(), moves))
    return at_.error(call.offset, "cycle",
                     fmt::format("{} would take more than 100000 rings or depths; larger ones were expected", name));
  rapid_to_height(rtp);
}

/// LONGHOLE(RTP, RFP, SDIS, DP, DPR, NUM, LENG, CPA, CPO, RAD, STA1, INDA, FFD, FFP1, MID) and SLOT1 with WID behind
/// LENG and then CDIR, FAL, VARI, MIDF, FFP2: slots that begin on a circle and lead outwards.
void Cycles::mill_slots(const CycleCall& call) {
  const std::string name(call.row->name);
  const bool wide = name == "SLOT1";
  const std::size_t behind = wide ? 8 : 7;  // CPA
  const double unit = modes_.unit_mm(), cutter = cutter_radius_mm(call, true);
  if (!begin_milling(call) || cutter <= 0) return;
  PocketCycle slot;
  slot.surface_mm = call.number(1) * unit;
  slot.clearance_mm = slot.surface_mm + std::abs(call.number(2)) * unit;
  slot.bottom_mm = bottom_mm(call);
  const double depth = slot.surface_mm - slot.bottom_mm, length = std::abs(call.number(6)) * unit,
               count = call.number(5);
  slot.half_mm[0] = 0.5 * length - cutter;
  slot.half_mm[1] = wide ? 0.5 * std::abs(call.number(7)) * unit - cutter : 0;
  slot.corner_mm = slot.half_mm[1];
  slot.side_mm = wide ? std::abs(call.number(17)) * unit : 0;
  const int vari = wide ? call.digit(18, 1) : 1;
  const bool possible = depth > 0 && count >= 1 && count <= 1000 && vari <= 2;
  if (!possible || slot.least_mm() - slot.side_mm < -1e-9)
    return at_.error(
        call.offset, possible ? "cutter-too-large" : "cycle",
        fmt::format("{} needs NUM of 1 to 1000, VARI of 0 to 2, a depth below its reference plane, and sides "
                    "in which the tool of {:.3f} mm and the allowance have room",
                    name, 2 * cutter));
  const auto feed = cycle_feed(call.number(behind + 6), call, "FFP1");
  if (!feed) return;
  slot.feed_mm_per_s = *feed;
  slot.plunge_mm_per_s = cycle_feed(call.number(behind + 5), call, "FFD").value_or(*feed);
  slot.finishing_mm_per_s =
      wide && call.number(20) > 0 ? cycle_feed(call.number(20), call, "FFP2").value_or(*feed) : *feed;
  slot.step_mm = call.number(behind + 7) > 0 ? call.number(behind + 7) * unit : depth;
  slot.finishing_step_mm = wide ? std::abs(call.number(19)) * unit : 0;
  slot.sideways_mm = cutter;
  slot.roughs = vari != 2;
  slot.finishes = vari != 1;
  slot.sense = sense_of(wide ? call.digit(16, 1) : 0);
  const PlaneAxes axes = at_.axes();
  const double step = call.number(behind + 4) != 0 ? call.number(behind + 4) : 360 / count;
  for (int i = 0; i < static_cast<int>(count); ++i) {
    slot.angle_rad = rad_from_deg(call.number(behind + 3) + i * step);
    const double along = call.number(behind + 2) * unit + 0.5 * length;
    slot.middle_mm = mover_.programmed();
    slot.middle_mm[axes.first] = call.number(behind) * unit + along * std::cos(slot.angle_rad);
    slot.middle_mm[axes.second] = call.number(behind + 1) * unit + along * std::sin(slot.angle_rad);
    run_pocket(slot, call);
  }
}

/// CYCLE61(RTP, Z0, SDIS, Z1, X0, Y0, X1, Y1, infeed, sideways, allowance, F, VARI, LIM, DMODE, AMODE) and CYCLE71(RTP,
/// RFP, SDIS, DP, PA, PO, LENG, WID, STA, MID, MIDA, FDP, FALD, FFP1, VARI, FDP1): parallel passes across a rectangle.
void Cycles::mill_face(const CycleCall& call) {
  const std::string name(call.row->name);
  const bool old = name == "CYCLE71";
  const double unit = modes_.unit_mm(), cutter = cutter_radius_mm(call, true);
  if (!begin_milling(call) || cutter <= 0) return;
  const double top = call.number(1) * unit, clear = top + std::abs(call.number(2)) * unit, rtp = call.number(0) * unit;
  const double bottom = !old && call.digit(15, 1) == 1 ? top - std::abs(call.number(3)) * unit : call.number(3) * unit;
  const double allowance = call.number(old ? 12 : 10) * unit;
  double from[2] = {call.number(4) * unit, call.number(5) * unit},
         way[2] = {call.number(6) * unit, call.number(7) * unit};
  for (int i = 0; i < 2; ++i)
    if (!old && call.digit(15, i == 0 ? 1000 : 10000) == 1) way[i] -= from[i];
  const double angle = old ? rad_from_deg(call.number(8)) : 0;
  const double given = call.number(old ? 10 : 9);
  const double sideways = !(given > 0)                      ? 1.6 * cutter
                          : !old && call.digit(15, 10) == 1 ? given / 100 * 2 * cutter
                                                            : given * unit;
  const double step = call.number(old ? 9 : 8) * unit;
  const int vari = call.digit(old ? 14 : 12, 1), direction = call.digit(old ? 14 : 12, 10);
  const auto feed = cycle_feed(call.number(old ? 13 : 11), call, "F");
  if (!feed) return;
  const bool at_once = vari == 2 || step <= 0;
  const double low = vari == 2 ? bottom : bottom + allowance;
  if (way[0] == 0 || way[1] == 0 || bottom > top || sideways > 2 * cutter + 1e-9)
    return at_.error(
        call.offset, "cycle",
        fmt::format("{} needs two sides, a depth below its reference plane and passes no further apart than the "
                    "tool is wide",
                    name));
  const int cuts = at_once ? 1 : std::max(1, static_cast<int>(std::ceil((top - low) / step - 1e-9)));
  const int along = direction == 2 || direction == 4 ? 1 : 0, across = 1 - along;
  const int passes = std::max(1, static_cast<int>(std::ceil(std::abs(way[across]) / sideways - 1e-9)));
  if (static_cast<double>(cuts) * passes > kMaxPecks)
    return at_.error(call.offset, "cycle", fmt::format("{} would take more than 100000 passes", name));
  at_.report.warning(
      call.offset, "cycle",
      fmt::format("the passes of {} go beyond the face by the radius of the tool and the safety clearance; "
                  "the control's may differ",
                  name),
      name + " ways");
  const PlaneAxes axes = at_.axes();
  const double c = std::cos(angle), s = std::sin(angle), beyond = cutter + (clear - top);
  const auto at = [&](double on, double beside, double height) {
    double uv[2];
    uv[along] = on;
    uv[across] = beside;
    Vec3 p = Vec3::Zero();
    p[axes.first] = from[0] + c * uv[0] - s * uv[1];
    p[axes.second] = from[1] + s * uv[0] + c * uv[1];
    p[axes.normal] = height;
    return p;
  };
  rapid_to_height(std::max(mover_.programmed()[axes.normal], rtp));
  const double begin = -std::copysign(1, way[along]) * beyond, end = way[along] + std::copysign(1, way[along]) * beyond;
  for (int cut = 1; cut <= cuts; ++cut) {
    const double height = at_once ? low : std::max(top - step * cut, low);
    for (int pass = 1; pass <= passes; ++pass) {
      const double beside = way[across] * pass / passes - std::copysign(1, way[across]) * cutter;
      const bool back = direction >= 3 && pass % 2 == 0;
      if (pass == 1 || direction < 3) {
        rapid_to_height(cut == 1 && pass == 1 ? rtp : clear);
        go(CycleStep::Kind::rapid, at(begin, beside, mover_.programmed()[axes.normal]), 0, 0);
        go(CycleStep::Kind::rapid, at(begin, beside, height), 0, 0);
        mover_.set_places(AxisPlace::known);
      } else {
        go(CycleStep::Kind::feed, at(back ? end : begin, beside, height), *feed, 0);
      }
      go(CycleStep::Kind::feed, at(back ? begin : end, beside, height), *feed, 0);
    }
    rapid_to_height(clear);
  }
  rapid_to_height(rtp);
}

/// HOLES1, HOLES2, CYCLE801, CYCLE802: a rapid to each place.
void Cycles::run_pattern(const CycleCall& call, const BlockPlace& place, const std::function<void()>& visit) {
  const std::string name(call.row->name);
  const double unit = modes_.unit_mm();
  const PlaneAxes axes = at_.axes();
  std::vector<std::pair<double, double>> places;
  const auto count_of = [&](std::size_t i) {
    const double n = call.number(i);
    if (!(n >= 1 && n <= 10000)) {
      at_.error(call.offset, "cycle", fmt::format("{} of {:g} holes; 1 to 10000 were expected", name, n));
      return 0;
    }
    return static_cast<int>(n);
  };
  at_.place = place;
  at_.request = {};
  at_.words.clear(call.offset);
  const double x = call.number(0) * unit, y = call.number(1) * unit;
  if (name == "HOLES1") {
    const double angle = rad_from_deg(call.number(2));
    const int n = count_of(5);
    for (int i = 0; i < n; ++i) {
      const double along = (call.number(3) + i * call.number(4)) * unit;
      places.emplace_back(x + along * std::cos(angle), y + along * std::sin(angle));
    }
    const Vec3 at = mover_.programmed();
    const auto way = [&](const auto& p) { return std::hypot(p.first - at[axes.first], p.second - at[axes.second]); };
    if (n > 1 && way(places.back()) < way(places.front())) std::ranges::reverse(places);
  } else if (name == "HOLES2") {
    const int n = count_of(5);
    const double step = call.number(4) != 0 ? call.number(4) : n > 0 ? 360.0 / n : 0;
    for (int i = 0; i < n; ++i) {
      const Eigen::Matrix3d turn = rotation_in(Plane::xy, rad_from_deg(call.number(3) + i * step));
      places.emplace_back(x + turn(0, 0) * call.number(2) * unit, y + turn(1, 0) * call.number(2) * unit);
    }
  } else if (name == "CYCLE801") {
    const double angle = rad_from_deg(call.number(2));
    const int columns = count_of(5), rows = count_of(6);
    const bool frame_only = static_cast<int>(call.number(7)) % 10 == 1;
    for (int r = 0; r < rows; ++r)
      for (int k = 0; k < columns; ++k) {
        const int c = r % 2 == 0 ? k : columns - 1 - k;
        if (frame_only && r > 0 && r + 1 < rows && c > 0 && c + 1 < columns) continue;
        const double u = c * call.number(3) * unit, v = r * call.number(4) * unit;
        places.emplace_back(x + u * std::cos(angle) - v * std::sin(angle),
                            y + u * std::sin(angle) + v * std::cos(angle));
      }
  } else {
    const std::string masks = fmt::format("{:.0f}{:.0f}", call.number(0), call.number(1));
    if (masks.find('2') != std::string::npos)
      return at_.error(call.offset, "not-supported",
                       "CYCLE802 with incremental places is not supported; absolute ones were expected");
    for (std::size_t i = 2; i + 1 < call.values.size() && i < 20; i += 2)
      if (call.has(i) || call.has(i + 1)) places.emplace_back(call.number(i) * unit, call.number(i + 1) * unit);
  }
  modes_.check_unit();
  for (const auto& [u, v] : places) {
    at_.place = place;
    at_.editable = false;
    at_.request = {};
    Vec3 to = mover_.programmed();
    to[axes.first] = u;
    to[axes.second] = v;
    for (const int axis : {axes.first, axes.second}) mover_.set_place(axis, AxisPlace::known);
    if ((to - mover_.programmed()).norm() > 1e-9) mover_.add_move(MoveKind::rapid, frames_.frame().from_program(to));
    visit();
    if (at_.report.full()) return;
  }
}

}  // namespace camber::nc::siemens
