#include "feedmodel/motion_times.h"

#include <algorithm>
#include <cmath>

#include "feedmodel/axis_places.h"
#include "feedmodel/exponential.h"
#include "feedmodel/limits.h"
#include "feedmodel/path_builder.h"
#include "feedmodel/plan.h"
#include "feedmodel/rapid.h"

namespace camber::feedmodel {
namespace {

using machine::AccelerationLaw;
using machine::RapidPath;

constexpr double kNoRamp = 1e-9;  // s; a shorter one is rounding of numbers

/// What becomes of a segment beside its row in the plan.
struct RowInfo {
  std::uint32_t move = 0;
  bool cutting = false, rest = false;
  double dwell_s = 0;
};

class MotionClock {
 public:
  MotionClock(const nc::Interpretation& program, const machine::Machine& machine,
              const std::vector<std::uint32_t>& rests)
      : program_(program),
        machine_(machine),
        cycle_(machine.cycle),
        rests_(rests),
        dog_leg_(cycle_.rapid_path == RapidPath::dogleg) {
    out_.move_s.assign(program.moves.size(), 0.0);
    out_.acceleration.assign(program.moves.size(), 0.0F);
  }

  MotionTimes run() {
    collect();
    if (cycle_.acceleration_law == AccelerationLaw::exponential)
      time_exponential();
    else
      time_linear();
    time_rapids();
    return std::move(out_);
  }

 private:
  void collect() {
    PathOptions options;
    options.rests = rests_;
    options.rest_at_rapids = dog_leg_;
    options.feed_factor = cycle_.feed_override_percent / 100.0;
    options.rapid_factor = cycle_.rapid_override_percent / 100.0;
    options.linear_acceleration_mm_per_s2 = cycle_.linear_acceleration_mm_per_s2;
    rows_.reserve(program_.moves.size());
    info_.reserve(program_.moves.size());
    build_segments(
        program_, machine_, [&](const Segment& s) { add(s); }, options);
  }

  void add(const Segment& s) {
    rows_.push_back({.length_mm = s.length_mm,
                     .speed_limit_mm_per_s = s.speed_limit_mm_per_s,
                     .acceleration_mm_per_s2 = s.acceleration_mm_per_s2,
                     .planned_fraction = s.planned_fraction,
                     .joined = s.joined,
                     .entry_speed_mm_per_s = s.entry_limit_mm_per_s});
    info_.push_back({s.move, s.cutting, s.length_mm == 0, s.dwell_s});
    if (s.radius_mm > 0 && s.cutting && program_.moves[s.move].kind == nc::MoveKind::arc) limit_arc(s);
    if (s.cutting) out_.acceleration[s.move] = static_cast<float>(rows_.back().acceleration_mm_per_s2);
  }

  /// The control's own limits on an arc, beside those of its axes. Source: Takata 1999, eqs. 2.9, 2.10.
  void limit_arc(const Segment& s) {
    PlanRow& row = rows_.back();
    const double r = helix_curvature_radius(s.radius_mm, s.rise.norm() / s.turn_rad_per_mm);
    row.acceleration_mm_per_s2 = std::min(row.acceleration_mm_per_s2, cycle_.arc_acceleration_mm_per_s2);
    row.speed_limit_mm_per_s = std::min(row.speed_limit_mm_per_s, arc_speed(r, cycle_.arc_acceleration_mm_per_s2, 1));
    if (std::isinf(cycle_.arc_tolerance_mm)) return;
    for (const machine::Axis& axis : machine_.axis)
      row.speed_limit_mm_per_s =
          std::min(row.speed_limit_mm_per_s, arc_servo_speed(r, cycle_.arc_tolerance_mm, axis.position_gain_per_s,
                                                             axis.feed_forward_percent, cycle_.arc_loop_factor));
  }

  bool replaced(std::size_t i) const { return dog_leg_ && !info_[i].cutting && !info_[i].rest; }

  void time_linear() {
    plan_speeds(rows_, static_cast<std::size_t>(std::max(0, machine_.control.lookahead_blocks)));
    PlanClock clock(machine_.control.period_s);
    int ramp = 0;  // the change of speed under way: +1 accelerating, -1 braking
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (replaced(i)) {
        ramp = 0;
        continue;
      }
      const double before_s = clock.now_s();
      const Trapezoid profile = profile_of(rows_, i);
      clock.begin(profile);
      double duration_s = info_[i].rest ? info_[i].dwell_s : profile.duration_s();
      clock.advance(duration_s);
      duration_s = clock.now_s() - before_s;
      if (!info_[i].rest) duration_s += cycle_.jerk_filter_s * count_changes(profile, ramp);
      out_.move_s[info_[i].move] += duration_s;
    }
  }

  /// Changes of speed that begin in this profile; one that goes on from the segment before is counted there.
  int count_changes(const Trapezoid& p, int& ramp) {
    int begun = 0;
    const auto phase = [&](int kind, double duration_s) {
      if (duration_s <= kNoRamp) return;
      if (kind != 0 && kind != ramp) ++begun;
      ramp = kind;
    };
    phase(+1, p.accelerate_s);
    phase(0, p.cruise_s);
    phase(-1, p.brake_s);
    out_.speed_changes += static_cast<std::size_t>(begun);
    return begun;
  }

  /// Block by block; the speed at a block's end is the next one's start, and a stop costs T1 + T2.
  void time_exponential() {
    const double t1 = cycle_.time_constant_1_s, t2 = cycle_.time_constant_2_s;
    double speed = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (info_[i].rest) {
        out_.move_s[info_[i].move] += info_[i].dwell_s;
        speed = 0;
        continue;
      }
      if (replaced(i)) continue;
      const ExponentialRamp ramp{speed, rows_[i].speed_limit_mm_per_s, t1, t2};
      const bool at_once = std::isinf(ramp.command_mm_per_s);  // a rapid of axes without a limit
      const double time_s = at_once ? 0.0 : ramp.time_of(rows_[i].length_mm);
      const bool stops = i + 1 >= rows_.size() || info_[i + 1].rest || stops_after(i);
      out_.move_s[info_[i].move] += time_s + (stops ? t1 + t2 : 0.0);
      speed = stops || at_once ? 0.0 : ramp.speed_at(time_s);
    }
  }

  bool stops_after(std::size_t i) const {
    const nc::Move& move = program_.moves[info_[i].move];
    const bool exact = program_.state_of(move).path_control == nc::PathControl::exact_stop;
    return move.exact_stop || exact || info_[i].cutting != info_[i + 1].cutting || !info_[i].cutting;
  }

  /// Rapids with each axis on its own, and ways to the reference point, which the path does not hold.
  void time_rapids() {
    const Vec3 speed = rapid_speeds_mm_per_s(machine_), acceleration = rapid_accelerations_mm_per_s2(machine_);
    AxisPlaces places(machine_.tool_change);
    double overlap_s = 0;  // of the rapid before, while its braking can be used
    std::size_t rest = 0;
    for (std::size_t i = 0; i < program_.moves.size(); ++i) {
      const nc::Move& move = program_.moves[i];
      const AxisPlaces::Way way = places.pass(move);
      while (rest < rests_.size() && rests_[rest] < i) ++rest;
      if (rest < rests_.size() && rests_[rest] == i) overlap_s = 0;
      out_.unplaced_moves += !way.complete;
      if (move.kind != nc::MoveKind::rapid) {
        overlap_s = 0;
        continue;
      }
      const Vec3 distance = way.to_mm - way.from_mm;
      if (distance.isZero(0)) continue;
      out_.below_full_rapid += below_full_rapid(distance, speed, acceleration);
      if (!dog_leg_ && !move.reference) continue;
      double time_s = rapid_time_s(distance, speed, acceleration);
      const double saved_s = std::min(overlap_s, time_s / 2.0);
      overlap_s = overlap_time_s(distance, speed, acceleration);
      time_s += 2.0 * cycle_.jerk_filter_s;
      out_.speed_changes += 2;
      out_.move_s[i] = time_s - saved_s;
    }
  }

  /// How long the slowest axis still brakes when the next rapid may begin.
  double overlap_time_s(const Vec3& distance, const Vec3& speed, const Vec3& acceleration) const {
    if (cycle_.rapid_overlap_percent <= 0) return 0;
    Eigen::Index slowest = 0;
    axis_times_s(distance, speed, acceleration).maxCoeff(&slowest);
    if (std::isinf(acceleration[slowest])) return 0;
    const double peak = std::min(speed[slowest], std::sqrt(acceleration[slowest] * std::abs(distance[slowest])));
    return std::min(cycle_.rapid_overlap_percent / 100.0 * speed[slowest], peak) / acceleration[slowest];
  }

  const nc::Interpretation& program_;
  const machine::Machine& machine_;
  const machine::Cycle& cycle_;
  const std::vector<std::uint32_t>& rests_;
  bool dog_leg_;
  std::vector<PlanRow> rows_;
  std::vector<RowInfo> info_;
  MotionTimes out_;
};

}  // namespace

MotionTimes motion_times(const nc::Interpretation& program, const machine::Machine& machine,
                         const std::vector<std::uint32_t>& rests) {
  return MotionClock(program, machine, rests).run();
}

}  // namespace camber::feedmodel
