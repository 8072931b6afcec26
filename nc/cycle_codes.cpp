#include "nc/cycle_codes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace camber::nc {

/// The way off the wall of G76 and G87: I J K of the plane, or Q along the plane's first axis. False: an error.
bool CycleCodes::set_shift(CycleHole& hole) {
  if (hole.g != 76 && hole.g != 87) return true;
  const PlaneAxes axes = axes_of(modal_.plane());
  hole.shift_mm = cycle_.shift_mm;
  hole.shift_mm[axes.normal] = 0;
  if (hole.shift_mm == Vec3::Zero()) hole.shift_mm[axes.first] = cycle_.q_mm.value_or(0);
  if (hole.shift_mm == Vec3::Zero()) {
    at_.error(at_.words.offset(), "cycle",
              fmt::format("G{} has no shift off the wall; Q (or I, J) other than zero was expected", hole.g),
              "cycle Q");
    return false;
  }
  if (hole.g != 87) return true;
  if (hole.bottom_mm < hole.retract_mm || hole.retract_mm > cycle_.initial_mm) {
    at_.error(
        at_.words.offset(), "cycle",
        fmt::format("G87 bores upwards from R {:.4f} mm to {} {:.4f} mm; R below it and below the initial level {:.4f} "
                    "mm was expected",
                    hole.retract_mm, kAxisLetters[axes.normal], hole.bottom_mm, cycle_.initial_mm));
    return false;
  }
  if (modal_.return_to_r()) {
    at_.error(at_.words.offset(), "cycle", "G87 with G99 would leave the tool under the work; G98 was expected");
    return false;
  }
  hole.clear_mm = cycle_.initial_mm;
  return true;
}

bool CycleCodes::read_cycle_words() {
  const char normal = kAxisLetters[axes_of(modal_.plane()).normal];
  if (at_.words.has(normal)) cycle_.z_mm = at_.words.scaled(normal, modal_.unit_mm());
  if (at_.words.has('R')) cycle_.r_mm = at_.words.scaled('R', modal_.unit_mm());
  if (at_.words.has('Q')) cycle_.q_mm = std::abs(*at_.words.scaled('Q', modal_.unit_mm()));
  if (at_.words.has('P')) cycle_.p_s = at_.dwell_seconds('P');
  read_peck_words();
  for (int axis = 0; axis < 3; ++axis)
    if (at_.words.has("IJK"[axis]) && (modal_.cycle_g() == 76 || modal_.cycle_g() == 87))
      cycle_.shift_mm[axis] = at_.words.value("IJK"[axis]) * modal_.unit_mm();
  at_.words.use("IJKL");
  if (modal_.cycle_g() == 88)
    at_.report.warning(at_.words.offset(), "cycle", "G88 is retracted by hand; a rapid is taken in its place", "G88");
  const std::string name = fmt::format("G{}", modal_.cycle_g());
  if (!at_.words.has_any("XYZ") && !rotary_.target()) return false;
  if (!cycle_.r_mm) at_.error(at_.words.offset(), "cycle", name + " has no retract level; R was expected", "cycle R");
  if (!cycle_.z_mm)
    at_.error(at_.words.offset(), "cycle", fmt::format("{} has no depth; {} was expected", name, normal), "cycle Z");
  if ((modal_.cycle_g() == 73 || modal_.cycle_g() == 83) && cycle_.q_mm.value_or(0) <= 0 && !cycle_.first_peck_mm) {
    at_.error(at_.words.offset(), "cycle", name + " has no depth of each peck; Q greater than zero was expected",
              "cycle Q");
    return false;
  }
  return cycle_.r_mm && cycle_.z_mm;
}

/// Haas: I the first peck of G73 and G83, J less with each, K at least; with Q, K of G73 is the depth after which the
/// tool goes back to R.
void CycleCodes::read_peck_words() {
  if (!at_.dialect().pecks_by_ijk || (modal_.cycle_g() != 73 && modal_.cycle_g() != 83)) return;
  const auto length = [&](char letter, std::optional<double>& out) {
    if (!at_.words.has(letter)) return;
    out = at_.words.value(letter) * modal_.unit_mm();
    if (*out >= 0) return;
    at_.error(at_.words.offset_of(letter), "cycle",
              fmt::format("{} of G{} is negative; a depth was expected", letter, modal_.cycle_g()));
    out = 0;
  };
  length('I', cycle_.first_peck_mm);
  length('J', cycle_.peck_less_mm);
  length('K', cycle_.least_peck_mm);
  if (!cycle_.first_peck_mm) return;
  if (*cycle_.first_peck_mm <= 0 || (cycle_.peck_less_mm.value_or(0) > 0 && cycle_.least_peck_mm.value_or(0) <= 0)) {
    at_.error(at_.words.offset(), "cycle",
              fmt::format("G{} with I (first peck) and J (less with each) needs I and K (least peck) greater than zero",
                          modal_.cycle_g()),
              "cycle I");
    cycle_.first_peck_mm.reset();
  }
}

void CycleCodes::run_cycle() {
  modal_.check_unit();
  if (!read_cycle_words()) return;
  const PlaneAxes axes = axes_of(modal_.plane());
  // The first rapid goes over the hole.
  if (!modal_.state().incremental && frames_.programmed()[axes.normal] >= *cycle_.r_mm)
    for (const int axis : {axes.first, axes.second})
      if (at_.words.has(kAxisLetters[axis])) rotary_.close_axis(axis);
  rotary_.settle_axes_for("a drilling cycle", false);
  mover_.prepare_cutting("a drilling cycle");
  const bool k_repeats = !at_.dialect().pecks_by_ijk;
  const double repeats = at_.words.has('L')                ? at_.words.value('L')
                         : k_repeats && at_.words.has('K') ? at_.words.value('K')
                                                           : 1;
  if (repeats < 0 || repeats > 1e5 || repeats != std::floor(repeats)) {
    at_.error(at_.words.offset(), "cycle",
              fmt::format("{} repeats of a cycle; a whole number up to 100000 was expected", repeats));
    return;
  }
  if (repeats == 0) at_.words.use("XYZ");  // kept for the blocks that follow
  for (int i = 0; i < static_cast<int>(repeats); ++i) {
    if (moves_made_ > kMaxCycleMoves) {
      at_.error(
          at_.words.offset(), "cycle",
          fmt::format("the drilling cycles make more than {} moves; fewer repeats (L) or a larger Q were expected",
                      kMaxCycleMoves));
      return;
    }
    if (i > 0 && modal_.state().incremental) rotary_.read_rotary_words();
    Vec3 place = mover_.programmed_target();
    place[axes.normal] = frames_.programmed()[axes.normal];
    drill(place);
    if (at_.request.trouble) return;
    mover_.settle_axes();
  }
}

void CycleCodes::drill(const Vec3& place) {
  const int normal = axes_of(modal_.plane()).normal;
  CycleHole hole;
  hole.g = modal_.cycle_g();
  hole.from_mm = frames_.programmed();
  hole.place_mm = place;
  hole.retract_mm = *cycle_.r_mm + (modal_.state().incremental ? cycle_.initial_mm : 0);
  hole.bottom_mm = *cycle_.z_mm + (modal_.state().incremental ? hole.retract_mm : 0);
  hole.clear_mm = modal_.return_to_r() ? hole.retract_mm : std::max(cycle_.initial_mm, hole.retract_mm);
  hole.peck_mm = cycle_.first_peck_mm.value_or(cycle_.q_mm.value_or(0));
  hole.peck_less_mm = cycle_.first_peck_mm ? cycle_.peck_less_mm.value_or(0) : 0;
  hole.least_peck_mm = cycle_.first_peck_mm ? cycle_.least_peck_mm.value_or(0) : 0;
  if (modal_.cycle_g() == 73 && !cycle_.first_peck_mm && at_.dialect().pecks_by_ijk)
    hole.clear_every_mm = cycle_.least_peck_mm.value_or(0);
  hole.dwell_s = cycle_.p_s.value_or(0);
  hole.peck_clearance_mm = at_.options.peck_clearance_mm;
  const std::string name = fmt::format("G{}", modal_.cycle_g());
  const double depth = hole.retract_mm - hole.bottom_mm;
  if (depth < 0 && hole.g != 87) {
    at_.error(at_.words.offset(), "cycle",
              fmt::format("the bottom of {} at {} {:.4f} mm is above its retract level R {:.4f} mm", name,
                          kAxisLetters[normal], hole.bottom_mm, hole.retract_mm));
    return;
  }
  const double smallest_mm = hole.peck_less_mm > 0 ? std::min(hole.peck_mm, hole.least_peck_mm) : hole.peck_mm;
  if ((modal_.cycle_g() == 73 || modal_.cycle_g() == 83) && depth > smallest_mm * kMaxPecks) {
    at_.error(at_.words.offset(), "cycle",
              fmt::format("{} would peck more than 100000 times; a larger Q was expected", name));
    return;
  }
  if (!set_shift(hole)) return;
  const auto feed = modal_.cutting_feed(std::abs(depth), name.c_str());
  if (!feed) return;
  for (const CycleStep& step : hole_steps(hole, axes_of(modal_.plane()))) {
    if (rotary_.target()) turn_before(step);
    Move& move = add_cycle_move(step);
    if (move.kind == MoveKind::linear) move.feed_mm_per_s = *feed;
    for (int axis = 0; axis < 3; ++axis)
      if (move.end_mm[axis] != move.start_mm[axis] && !modal_.state().incremental)
        place_.axis[static_cast<std::size_t>(axis)] = AxisPlace::known;
  }
}

Move& CycleCodes::add_cycle_move(const CycleStep& step) {
  const MoveKind kind = step.kind == CycleStep::Kind::rapid   ? MoveKind::rapid
                        : step.kind == CycleStep::Kind::dwell ? MoveKind::dwell
                                                              : MoveKind::linear;
  Move& move = mover_.add_move(kind, frames_.frame().from_program(step.end_mm));
  ++moves_made_;
  move.canned = true;
  move.cycle = static_cast<std::uint8_t>(modal_.cycle_g());
  move.dwell_s = step.dwell_s;
  return move;
}

/// Rotary words of a cycle turn with the rapid over the hole, or before the tool goes down where there is none; where
/// the tool first rises to R, after that.
void CycleCodes::turn_before(const CycleStep& step) {
  const PlaneAxes axes = axes_of(modal_.plane());
  const Vec3 way = step.end_mm - frames_.programmed();
  constexpr double kRoundingMm = 1e-9;
  if (std::abs(way[axes.first]) > kRoundingMm || std::abs(way[axes.second]) > kRoundingMm) return;
  if (way[axes.normal] <= kRoundingMm) {
    add_cycle_move({CycleStep::Kind::rapid, frames_.programmed(), 0});
    return;
  }
  const auto target = rotary_.take_target();
  add_cycle_move(step);
  rotary_.give_target(target);
}

void CycleCodes::begin() {
  cycle_ = {};
  cycle_.initial_mm = frames_.programmed()[axes_of(modal_.plane()).normal];
}

}  // namespace camber::nc
