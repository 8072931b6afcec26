// Blocks of drilling, tapping and boring cycles.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "nc/block_interpreter.h"

namespace camber::nc {
namespace {

constexpr char kAxisLetters[] = "XYZ";

}  // namespace

/// The way off the wall of G76 and G87: I J K of the plane, or Q along the plane's first axis. False: an error.
bool BlockInterpreter::set_shift(CycleHole& hole) {
  if (hole.g != 76 && hole.g != 87) return true;
  const PlaneAxes axes = axes_of(plane_);
  hole.shift_mm = cycle_.shift_mm;
  hole.shift_mm[axes.normal] = 0;
  if (hole.shift_mm == Vec3::Zero()) hole.shift_mm[axes.first] = cycle_.q_mm.value_or(0);
  if (hole.shift_mm == Vec3::Zero()) {
    error(words_.offset(), "cycle",
          fmt::format("G{} has no shift off the wall; Q (or I, J) other than zero was expected", hole.g), "cycle Q");
    return false;
  }
  if (hole.g != 87) return true;
  if (hole.bottom_mm < hole.retract_mm || hole.retract_mm > cycle_.initial_mm) {
    error(
        words_.offset(), "cycle",
        fmt::format("G87 bores upwards from R {:.4f} mm to {} {:.4f} mm; R below it and below the initial level {:.4f} "
                    "mm was expected",
                    hole.retract_mm, kAxisLetters[axes.normal], hole.bottom_mm, cycle_.initial_mm));
    return false;
  }
  if (return_to_r_) {
    error(words_.offset(), "cycle", "G87 with G99 would leave the tool under the work; G98 was expected");
    return false;
  }
  hole.clear_mm = cycle_.initial_mm;
  return true;
}

bool BlockInterpreter::read_cycle_words() {
  const char normal = kAxisLetters[axes_of(plane_).normal];
  if (words_.has(normal)) cycle_.z_mm = words_.scaled(normal, unit_mm());
  if (words_.has('R')) cycle_.r_mm = words_.scaled('R', unit_mm());
  if (words_.has('Q')) cycle_.q_mm = std::abs(*words_.scaled('Q', unit_mm()));
  if (words_.has('P')) cycle_.p_s = dwell_seconds('P');
  read_peck_words();
  for (int axis = 0; axis < 3; ++axis)
    if (words_.has("IJK"[axis]) && (cycle_.g == 76 || cycle_.g == 87))
      cycle_.shift_mm[axis] = words_.value("IJK"[axis]) * unit_mm();
  words_.use("IJKL");
  if (cycle_.g == 88)
    report_.warning(words_.offset(), "cycle", "G88 is retracted by hand; a rapid is taken in its place", "G88");
  const std::string name = fmt::format("G{}", cycle_.g);
  if (!words_.has_any("XYZ") && !rotary_target_) return false;
  if (!cycle_.r_mm) error(words_.offset(), "cycle", name + " has no retract level; R was expected", "cycle R");
  if (!cycle_.z_mm)
    error(words_.offset(), "cycle", fmt::format("{} has no depth; {} was expected", name, normal), "cycle Z");
  if ((cycle_.g == 73 || cycle_.g == 83) && cycle_.q_mm.value_or(0) <= 0 && !cycle_.first_peck_mm) {
    error(words_.offset(), "cycle", name + " has no depth of each peck; Q greater than zero was expected", "cycle Q");
    return false;
  }
  return cycle_.r_mm && cycle_.z_mm;
}

/// Haas: I the first peck of G73 and G83, J less with each, K at least; with Q, K of G73 is the depth after which the
/// tool goes back to R.
void BlockInterpreter::read_peck_words() {
  if (!options_.dialect_or_default().pecks_by_ijk || (cycle_.g != 73 && cycle_.g != 83)) return;
  const auto length = [&](char letter, std::optional<double>& out) {
    if (!words_.has(letter)) return;
    out = words_.value(letter) * unit_mm();
    if (*out >= 0) return;
    error(words_.offset_of(letter), "cycle",
          fmt::format("{} of G{} is negative; a depth was expected", letter, cycle_.g));
    out = 0;
  };
  length('I', cycle_.first_peck_mm);
  length('J', cycle_.peck_less_mm);
  length('K', cycle_.least_peck_mm);
  if (!cycle_.first_peck_mm) return;
  if (*cycle_.first_peck_mm <= 0 || (cycle_.peck_less_mm.value_or(0) > 0 && cycle_.least_peck_mm.value_or(0) <= 0)) {
    error(words_.offset(), "cycle",
          fmt::format("G{} with I (first peck) and J (less with each) needs I and K (least peck) greater than zero",
                      cycle_.g),
          "cycle I");
    cycle_.first_peck_mm.reset();
  }
}

void BlockInterpreter::run_cycle() {
  check_unit();
  if (!read_cycle_words()) return;
  const PlaneAxes axes = axes_of(plane_);
  // The first rapid goes over the hole.
  if (!state_.incremental && programmed()[axes.normal] >= *cycle_.r_mm)
    for (const int axis : {axes.first, axes.second})
      if (words_.has(kAxisLetters[axis]))
        open_axes_ = static_cast<std::uint8_t>(open_axes_ & ~(1U << static_cast<unsigned>(axis)));
  settle_axes_for("a drilling cycle", false);
  prepare_cutting("a drilling cycle");
  const bool k_repeats = !options_.dialect_or_default().pecks_by_ijk;
  const double repeats = words_.has('L') ? words_.value('L') : k_repeats && words_.has('K') ? words_.value('K') : 1;
  if (repeats < 0 || repeats > 1e5 || repeats != std::floor(repeats)) {
    error(words_.offset(), "cycle",
          fmt::format("{} repeats of a cycle; a whole number up to 100000 was expected", repeats));
    return;
  }
  if (repeats == 0) words_.use("XYZ");  // kept for the blocks that follow
  for (int i = 0; i < static_cast<int>(repeats); ++i) {
    if (cycle_moves_ > kMaxCycleMoves) {
      error(words_.offset(), "cycle",
            fmt::format("the drilling cycles make more than {} moves; fewer repeats (L) or a larger Q were expected",
                        kMaxCycleMoves));
      return;
    }
    if (i > 0 && state_.incremental) read_rotary_words();
    Vec3 place = programmed_target();
    place[axes.normal] = programmed()[axes.normal];
    drill(place);
    if (request_.trouble) return;
    settle_axes();
  }
}

void BlockInterpreter::drill(const Vec3& place) {
  const int normal = axes_of(plane_).normal;
  CycleHole hole;
  hole.g = cycle_.g;
  hole.from_mm = programmed();
  hole.place_mm = place;
  hole.retract_mm = *cycle_.r_mm + (state_.incremental ? cycle_.initial_mm : 0);
  hole.bottom_mm = *cycle_.z_mm + (state_.incremental ? hole.retract_mm : 0);
  hole.clear_mm = return_to_r_ ? hole.retract_mm : std::max(cycle_.initial_mm, hole.retract_mm);
  hole.peck_mm = cycle_.first_peck_mm.value_or(cycle_.q_mm.value_or(0));
  hole.peck_less_mm = cycle_.first_peck_mm ? cycle_.peck_less_mm.value_or(0) : 0;
  hole.least_peck_mm = cycle_.first_peck_mm ? cycle_.least_peck_mm.value_or(0) : 0;
  if (cycle_.g == 73 && !cycle_.first_peck_mm && options_.dialect_or_default().pecks_by_ijk)
    hole.clear_every_mm = cycle_.least_peck_mm.value_or(0);
  hole.dwell_s = cycle_.p_s.value_or(0);
  hole.peck_clearance_mm = options_.peck_clearance_mm;
  const std::string name = fmt::format("G{}", cycle_.g);
  const double depth = hole.retract_mm - hole.bottom_mm;
  if (depth < 0 && hole.g != 87) {
    error(words_.offset(), "cycle",
          fmt::format("the bottom of {} at {} {:.4f} mm is above its retract level R {:.4f} mm", name,
                      kAxisLetters[normal], hole.bottom_mm, hole.retract_mm));
    return;
  }
  const double smallest_mm = hole.peck_less_mm > 0 ? std::min(hole.peck_mm, hole.least_peck_mm) : hole.peck_mm;
  if ((cycle_.g == 73 || cycle_.g == 83) && depth > smallest_mm * kMaxPecks) {
    error(words_.offset(), "cycle", fmt::format("{} would peck more than 100000 times; a larger Q was expected", name));
    return;
  }
  if (!set_shift(hole)) return;
  const auto feed = cutting_feed(std::abs(depth), name.c_str());
  if (!feed) return;
  for (const CycleStep& step : hole_steps(hole, axes_of(plane_))) {
    if (rotary_target_) turn_before(step);
    Move& move = add_cycle_move(step);
    if (move.kind == MoveKind::linear) move.feed_mm_per_s = *feed;
    for (int axis = 0; axis < 3; ++axis)
      if (move.end_mm[axis] != move.start_mm[axis] && !state_.incremental)
        place_[static_cast<std::size_t>(axis)] = AxisPlace::known;
  }
}

Move& BlockInterpreter::add_cycle_move(const CycleStep& step) {
  const MoveKind kind = step.kind == CycleStep::Kind::rapid   ? MoveKind::rapid
                        : step.kind == CycleStep::Kind::dwell ? MoveKind::dwell
                                                              : MoveKind::linear;
  Move& move = add_move(kind, frame_.from_program(step.end_mm));
  ++cycle_moves_;
  move.canned = true;
  move.cycle = static_cast<std::uint8_t>(cycle_.g);
  move.dwell_s = step.dwell_s;
  return move;
}

/// Rotary words of a cycle turn with the rapid over the hole, or before the tool goes down where there is none; where
/// the tool first rises to R, after that.
void BlockInterpreter::turn_before(const CycleStep& step) {
  const PlaneAxes axes = axes_of(plane_);
  const Vec3 way = step.end_mm - programmed();
  constexpr double kRoundingMm = 1e-9;
  if (std::abs(way[axes.first]) > kRoundingMm || std::abs(way[axes.second]) > kRoundingMm) return;
  if (way[axes.normal] <= kRoundingMm) {
    add_cycle_move({CycleStep::Kind::rapid, programmed(), 0});
    return;
  }
  const auto target = std::exchange(rotary_target_, std::nullopt);
  add_cycle_move(step);
  rotary_target_ = target;
}

}  // namespace camber::nc
