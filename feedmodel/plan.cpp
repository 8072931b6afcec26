#include "feedmodel/plan.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/stage.h"
#include "feedmodel/in_position.h"
#include "feedmodel/joint_map.h"
#include "feedmodel/modes.h"
#include "feedmodel/overlap.h"
#include "feedmodel/path_builder.h"
#include "feedmodel/rapid.h"

namespace camber::feedmodel {
namespace {

using machine::AccelerationLaw;

constexpr double kNoRamp = 1e-9;  // s; a shorter one is rounding of numbers

/// A positioning is planned as a rest: its axes stop before and after it.
PlanRow row_of(const Segment& s) {
  return {.length_mm = s.axes_apart ? 0 : s.length_mm,
          .speed_limit_mm_per_s = s.axes_apart ? 0 : s.speed_limit_mm_per_s,
          .acceleration_mm_per_s2 = s.acceleration_mm_per_s2,
          .planned_fraction = s.planned_fraction,
          .joined = s.joined,
          .entry_speed_mm_per_s = s.entry_limit_mm_per_s};
}

/// What each change of speed takes longer than constant acceleration has it.
double delay_s(const machine::Machine& machine, std::size_t mode) {
  const machine::AccelerationTimes law = acceleration_law_of(machine, mode);
  return machine.cycle.jerk_filter_s + (law.law == AccelerationLaw::bell ? 0.5 * law.bell_time_s : 0.0);
}

/// How long the slowest axis of a positioning still brakes when the next one may begin.
double overlap_time_s(const Segment& s, double overlap_percent) {
  Eigen::Index slowest = 0;
  axis_times_s(s.way_mm, s.axis_speed_mm_per_s, s.axis_acceleration_mm_per_s2).maxCoeff(&slowest);
  const double speed = s.axis_speed_mm_per_s[slowest], acceleration = s.axis_acceleration_mm_per_s2[slowest];
  if (std::isinf(acceleration)) return 0;
  const double peak = std::min(speed, std::sqrt(acceleration * std::abs(s.way_mm[slowest])));
  return std::min(overlap_percent / 100.0 * speed, peak) / acceleration;
}

class Planner {
 public:
  Planner(const nc::Interpretation& program, const machine::Machine& machine) : program_(program), machine_(machine) {
    if (has_rotary_motion(program, machine)) map_.emplace(machine, program);
    for (std::size_t mode = 0; mode <= machine.modes.size(); ++mode) {
      laws_.push_back(acceleration_law_of(machine, mode));
      delay_s_.push_back(delay_s(machine, mode));
    }
  }

  MotionPlan run() {
    constexpr std::size_t kTogether = 1024;
    // Rounded corners are segments as well; room that is not written to takes no memory, and a list that doubles does.
    plan_.rows.reserve(2 * program_.moves.size());
    plan_.times.reserve(2 * program_.moves.size());
    Stage stage("planning the motion", program_.moves.size());
    build_segments(program_, machine_, [&](const Segment& s) {
      add(s);
      if (plan_.rows.size() % kTogether == 0) stage.advance(kTogether);
    });
    plan_all_speeds();
    time_all();
    return std::move(plan_);
  }

 private:
  /// A segment kept until its time is known.
  struct Kept {
    std::size_t index = 0;
    Segment segment;
    double rest_s = 0;  ///< of the rests that follow
  };

  void add(const Segment& s) {
    plan_.rows.push_back(row_of(s));
    // The exponential law knows no corners; but no axis enters a block faster than it can go.
    if (exponential(s.mode)) plan_.rows.back().entry_speed_mm_per_s = s.axis_limit_mm_per_s;
    plan_.times.push_back(
        {.move = s.move, .mode = s.mode, .rest = s.length_mm == 0, .cutting = s.cutting, .duration_s = s.dwell_s});
    if (s.overlaps) overlaps_.push_back({plan_.rows.size() - 1, s.overlap_speed_mm_per_s});
    if (s.axes_apart) positionings_.push_back({plan_.rows.size() - 1, s, 0});
    if (std::isfinite(machine_.control.in_position_mm)) note_stop(s);
  }

  /// Keeps the segments at whose end the control waits for the axes: exact stops, and where rapid and feed meet.
  void note_stop(const Segment& s) {
    if (s.length_mm == 0 && !s.gap) {
      if (last_) last_->rest_s += s.dwell_s;
      return;
    }
    if (last_ && (last_->segment.exact || s.gap || last_->segment.cutting != s.cutting)) checks_.push_back(*last_);
    last_.reset();
    if (!s.gap) last_ = {plan_.rows.size() - 1, s, 0};
  }

  bool exponential(std::size_t mode) const { return laws_[mode].law == AccelerationLaw::exponential; }
  bool row_exponential(std::size_t i) const { return exponential(plan_.times[i].mode); }

  /// Look-ahead over each stretch of rows without the exponential law; no control goes from one law to another without
  /// a stop.
  void plan_all_speeds() {
    const auto depth = static_cast<std::size_t>(std::max(0, machine_.control.lookahead_blocks));
    std::vector<PlanRow>& rows = plan_.rows;
    const auto row = [&](std::size_t i) { return rows.begin() + static_cast<std::ptrdiff_t>(i); };
    for (std::size_t from = 0, end = 0; from < rows.size(); from = end) {
      const bool exponential = row_exponential(from);
      while (end < rows.size() && row_exponential(end) == exponential) ++end;
      if (from > 0) rows[from].entry_speed_mm_per_s = 0;
      if (exponential) continue;
      if (end - from == rows.size()) return plan_speeds(rows, depth);
      std::vector<PlanRow> part(row(from), row(end));
      plan_speeds(part, depth);
      std::copy(part.begin(), part.end(), row(from));
    }
  }

  bool is_positioning(std::size_t i) const {
    return next_positioning_ < positionings_.size() && positionings_[next_positioning_].index == i;
  }

  /// Returns where the segment ends.
  double finish(std::size_t i) {
    if (next_check_ < checks_.size() && checks_[next_check_].index == i) {
      const Kept& stop = checks_[next_check_++];
      const double wait_s = in_position_wait_s(machine_, stop.segment, motion_of(plan_, i, stop.segment, machine_),
                                               map_ ? &*map_ : nullptr);
      plan_.times[i].wait_s = std::max(0.0, wait_s - stop.rest_s);
    }
    return plan_.times[i].end_s();
  }

  /// overlap_s: in, how early it may begin; out, how early the next one may.
  void time_positioning(std::size_t i, double now_s, double& overlap_s) {
    const Segment& s = positionings_[next_positioning_++].segment;
    SegmentTime& time = plan_.times[i];
    const SegmentMotion motion = positioning_motion(s, 2.0 * delay_s_[0]);
    time.duration_s = motion.duration_s;
    time.start_s = now_s - std::min(overlap_s, motion.axes_s / 2.0);
    const double percent = machine_.cycle.rapid_overlap_percent;
    overlap_s = percent > 0 ? overlap_time_s(s, percent) : 0.0;
    plan_.speed_changes += 2;
  }

  void time_all() {
    double now_s = 0, overlap_s = 0;
    double speed = 0;  // at the end of the last block, under the exponential law
    int ramp = 0;      // the change of speed under way: +1 accelerating, -1 braking
    for (std::size_t i = 0; i < plan_.rows.size(); ++i) {
      if (is_positioning(i)) {
        time_positioning(i, now_s, overlap_s);
        ramp = 0;
        speed = 0;
      } else if (row_exponential(i)) {
        overlap_s = 0;
        ramp = 0;
        time_exponential(i, now_s, speed);
      } else {
        overlap_s = 0;
        speed = 0;
        if (overlaps(i) || begins_s_)
          time_overlapping(i, now_s);
        else
          time_along(i, now_s, ramp);
      }
      now_s = finish(i);
    }
  }

  bool overlaps(std::size_t i) const { return next_overlap_ < overlaps_.size() && overlaps_[next_overlap_].index == i; }

  bool rests_at(std::size_t i) const { return i >= plan_.times.size() || plan_.times[i].rest; }

  /// A block that begins while the one before it brakes, or of which the next one does.
  void time_overlapping(std::size_t i, double now_s) {
    SegmentTime& time = plan_.times[i];
    const PlanRow& row = plan_.rows[i];
    const Trapezoid profile = profile_of(plan_.rows, i);
    const bool next = overlaps(i);
    OverlapOptions options{.start_s = begins_s_ ? *begins_s_ : start_of(profile, now_s),
                           .alone_from_s = now_s,
                           .period_s = machine_.control.period_s};
    if (next)
      options.speed =
          std::min(overlaps_[next_overlap_++].speed, overlap_speed(row, plan_.rows[i + 1], rests_at(i + 2)));
    const OverlapTimes found = profile.entry == 0 && profile.exit == 0 && std::isfinite(row.acceleration_mm_per_s2)
                                   ? overlap_times(row, options)
                                   : trapezoid_times(profile, options);
    time.overlapped = true;
    time.start_s = options.start_s;
    time.duration_s = std::max(now_s, found.end_s) - options.start_s;
    plan_.speed_changes += 2;
    begins_s_.reset();
    if (next) begins_s_ = std::min(found.next_start_s, time.end_s());
  }

  /// The same for a block that is entered, or left, at speed (lines rounded with their neighbours at the other end).
  static OverlapTimes trapezoid_times(const Trapezoid& profile, const OverlapOptions& options) {
    const double end_s = options.start_s + profile.duration_s();
    const double brake_s =
        std::isinf(profile.acceleration)
            ? 0.0
            : std::min({options.speed / profile.acceleration, profile.brake_s, end_s - options.alone_from_s});
    return {.end_s = end_s, .next_start_s = end_s - std::max(0.0, brake_s)};
  }

  void time_along(std::size_t i, double now_s, int& ramp) {
    SegmentTime& time = plan_.times[i];
    const Trapezoid profile = profile_of(plan_.rows, i);
    time.start_s = start_of(profile, now_s);
    if (time.rest) return;
    const auto begins = [&](int kind, double phase_s) {
      if (phase_s <= kNoRamp) return false;
      const bool begun = kind != 0 && kind != ramp;
      ramp = kind;
      return begun;
    };
    time.accelerates = begins(+1, profile.accelerate_s);
    begins(0, profile.cruise_s);
    time.brakes = begins(-1, profile.brake_s);
    const int changes = (time.accelerates ? 1 : 0) + (time.brakes ? 1 : 0);
    plan_.speed_changes += static_cast<std::size_t>(changes);
    time.duration_s = profile.duration_s() + changes * delay_s_[time.mode];
  }

  /// A start from (almost) rest waits for the next period of the control.
  double start_of(const Trapezoid& profile, double now_s) const {
    const double period_s = machine_.control.period_s;
    const bool from_rest = profile.length > 0 && profile.entry < profile.acceleration * period_s;
    if (!from_rest || now_s <= 0 || std::isinf(profile.acceleration)) return now_s;
    return std::max(now_s, std::ceil(now_s / period_s - 1e-9) * period_s);
  }

  /// Block by block; the speed at a block's end is the next one's start, and a stop costs T1 + T2.
  void time_exponential(std::size_t i, double now_s, double& speed) {
    SegmentTime& time = plan_.times[i];
    PlanRow& row = plan_.rows[i];
    const double t1 = laws_[time.mode].time_constant_1_s, t2 = laws_[time.mode].time_constant_2_s;
    time.start_s = now_s;
    row.entry_speed_mm_per_s = speed = std::min(speed, row.entry_speed_mm_per_s);
    if (time.rest) {
      speed = 0;
      return;
    }
    const ExponentialRamp ramp{speed, row.speed_limit_mm_per_s, t1, t2};
    const bool at_once = std::isinf(ramp.command_mm_per_s);  // a rapid of axes without a limit
    const double time_s = at_once ? 0.0 : ramp.time_of(row.length_mm);
    const bool stops = stops_after(i);
    time.duration_s = time_s + (stops ? t1 + t2 : 0.0);
    speed = stops || at_once ? 0.0 : ramp.speed_at(time_s);
  }

  bool stops_after(std::size_t i) const {
    if (i + 1 >= plan_.times.size() || plan_.times[i + 1].rest || !row_exponential(i + 1)) return true;
    const nc::Move& move = program_.moves[plan_.times[i].move];
    const bool exact = path_control_of(machine_, program_.state_of(move)) == nc::PathControl::exact_stop;
    const bool cutting = plan_.times[i].cutting;
    return move.exact_stop || exact || cutting != plan_.times[i + 1].cutting || !cutting;
  }

  const nc::Interpretation& program_;
  const machine::Machine& machine_;
  std::vector<machine::AccelerationTimes> laws_;  ///< by mode
  std::vector<double> delay_s_;                   ///< by mode
  MotionPlan plan_;
  std::optional<JointMap> map_;              // of a program with rotary motion
  std::vector<Kept> positionings_, checks_;  // in order
  std::size_t next_positioning_ = 0, next_check_ = 0, next_overlap_ = 0;
  struct Overlap {
    std::size_t index = 0;
    double speed = 0;  // Segment::overlap_speed_mm_per_s
  };
  std::vector<Overlap> overlaps_;   // in order
  std::optional<double> begins_s_;  // the next segment, while the one before it brakes
  std::optional<Kept> last_;        // the motion just before
};

}  // namespace

MotionPlan plan_motion(const nc::Interpretation& program, const machine::Machine& machine) {
  return Planner(program, machine).run();
}

Trapezoid profile_of(const std::vector<PlanRow>& rows, std::size_t i) {
  const double exit = i + 1 < rows.size() ? rows[i + 1].entry_speed_mm_per_s : 0.0;
  return make_trapezoid(rows[i].length_mm, rows[i].entry_speed_mm_per_s, exit, rows[i].speed_limit_mm_per_s,
                        rows[i].acceleration_mm_per_s2);
}

SegmentMotion motion_of(const MotionPlan& plan, std::size_t i, const Segment& segment,
                        const machine::Machine& machine) {
  const SegmentTime& time = plan.times[i];
  const PlanRow& row = plan.rows[i];
  if (segment.axes_apart) return positioning_motion(segment, 2.0 * delay_s(machine, 0));
  SegmentMotion motion;
  motion.duration_s = time.duration_s;
  if (time.rest) return motion;
  const machine::AccelerationTimes law = acceleration_law_of(machine, time.mode);
  if (law.law == AccelerationLaw::exponential) {
    motion.kind = SegmentMotion::Kind::exponential;
    motion.ramp = {row.entry_speed_mm_per_s, row.speed_limit_mm_per_s, law.time_constant_1_s, law.time_constant_2_s};
    if (!std::isinf(row.speed_limit_mm_per_s)) motion.ramp_s = motion.ramp.time_of(row.length_mm);
    return motion;
  }
  motion.kind = SegmentMotion::Kind::along_path;
  motion.along = profile_of(plan.rows, i);
  if (time.overlapped) {
    motion.kind = SegmentMotion::Kind::overlapping;
    motion.time_scale = time.duration_s > 0 ? motion.along.duration_s() / time.duration_s : 1.0;
    return motion;
  }
  motion.accelerate_extra_s = time.accelerates ? delay_s(machine, time.mode) : 0.0;
  motion.brake_extra_s = time.brakes ? delay_s(machine, time.mode) : 0.0;
  return motion;
}

}  // namespace camber::feedmodel
