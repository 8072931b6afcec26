#include "feedmodel/motion_plan.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <optional>

#include "base/stage.h"
#include "feedmodel/axes.h"
#include "feedmodel/modes.h"
#include "feedmodel/overlap.h"
#include "feedmodel/path_builder.h"
#include "feedmodel/rapid.h"
#include "kinematics/joint_map.h"

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

/// Returns half of the bell time: by so much a change of speed that reaches the full acceleration is longer.
double build_up_s(const machine::AccelerationTimes& law) {
  return law.law == AccelerationLaw::bell ? 0.5 * law.bell_time_s : 0.0;
}

/// Returns what a change of speed costs more than with constant acceleration, which has done it after `plain_s`, where
/// the acceleration takes `build_up_s` to build up and as long to fall. The change takes plain_s + build_up_s or, where
/// it ends before the full acceleration is reached, 2 sqrt(plain_s build_up_s): two parabolas of the speed. It covers
/// more of the path at the mean of its speeds, which the higher one, that of the cruise, is spared.
double bell_extra_s(double plain_s, double build_up_s, double from_mm_per_s, double to_mm_per_s) {
  if (build_up_s <= 0 || plain_s <= kNoRamp) return 0;
  const double longer_s = plain_s >= build_up_s ? build_up_s : 2 * std::sqrt(plain_s * build_up_s) - plain_s;
  return longer_s * std::abs(to_mm_per_s - from_mm_per_s) / (2 * std::max(from_mm_per_s, to_mm_per_s));
}

/// Returns how long the slowest axis of a positioning still brakes when the next one may begin.
double overlap_time_s(const Segment& s, double overlap_percent) {
  Eigen::Index slowest = 0;
  axis_times_s(s.way_mm, s.axis_speed_mm_per_s, s.axis_acceleration_mm_per_s2).maxCoeff(&slowest);
  const double speed = s.axis_speed_mm_per_s[slowest], acceleration = s.axis_acceleration_mm_per_s2[slowest];
  if (std::isinf(acceleration)) return 0;
  const double peak = std::min(speed, std::sqrt(acceleration * std::abs(s.way_mm[slowest])));
  return std::min(overlap_percent / 100.0 * speed, peak) / acceleration;
}

Trapezoid trapezoid_of(const PlanRow& row, double exit_speed_mm_per_s) {
  return make_trapezoid(row.length_mm, row.entry_speed_mm_per_s, exit_speed_mm_per_s, row.speed_limit_mm_per_s,
                        row.acceleration_mm_per_s2);
}

/// Returns by how much a positioning is longer than with constant acceleration.
double positioning_extra_s(const machine::Machine& machine) {
  return 2.0 * machine.cycle.jerk_filter_s + build_up_s(acceleration_law_of(machine, 0));
}

SegmentMotion motion_in_row(const PlanRow& row, const SegmentTime& time, double exit_speed_mm_per_s,
                            const Segment& segment, const machine::Machine& machine) {
  if (segment.axes_apart) return positioning_motion(segment, positioning_extra_s(machine));
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
  motion.along = trapezoid_of(row, exit_speed_mm_per_s);
  if (time.overlapped) {
    motion.kind = SegmentMotion::Kind::overlapping;
    motion.time_scale = time.duration_s > 0 ? motion.along.duration_s() / time.duration_s : 1.0;
    return motion;
  }
  const double extra_s = std::max(0.0, time.duration_s - motion.along.duration_s());
  // Where a row has both, the braking begins in it.
  if (motion.along.accelerate_s > kNoRamp && motion.along.brake_s > kNoRamp)
    motion.brake_extra_s =
        std::min(extra_s, machine.cycle.jerk_filter_s + bell_extra_s(motion.along.brake_s, build_up_s(law),
                                                                     motion.along.peak, motion.along.exit));
  else if (motion.along.brake_s > kNoRamp)
    motion.brake_extra_s = extra_s;
  motion.accelerate_extra_s = extra_s - motion.brake_extra_s;
  return motion;
}

/// Goes through the segments twice: for the speeds that braking allows, of which one number a segment is kept, and for
/// the times, of which the last few are.
class Planner {
 public:
  Planner(const nc::Interpretation& program, const machine::Machine& machine) : program_(program), machine_(machine) {
    if (kinematics::has_rotary_motion(program, machine)) map_.emplace(machine, program);
    for (std::size_t mode = 0; mode <= machine.modes.size(); ++mode) {
      laws_.push_back(acceleration_law_of(machine, mode));
    }
  }

  void plan_entry_speeds() {
    constexpr std::size_t kTogether = 1024;
    // Rounded corners are segments as well; room that is not written to takes no memory, and a list that doubles does.
    BrakingRows braking;
    braking.reserve(2 * program_.moves.size());
    Stage stage("planning the motion", program_.moves.size());
    build_segments(program_, machine_, [&](const Segment& s) {
      add(s, braking);
      if (braking.size() % kTogether == 0) stage.advance(kTogether);
    });
    const auto depth = static_cast<std::size_t>(std::max(0, machine_.control.lookahead_blocks));
    for (std::size_t i = 0; i < stretches_.size(); ++i) {
      const std::size_t from = stretches_[i].from,
                        end = i + 1 < stretches_.size() ? stretches_[i + 1].from : braking.size();
      if (from > 0) braking.set_entry_speed(from, 0);
      if (!stretches_[i].exponential) braking.brake(from, end, depth);
    }
    entry_mm_per_s_ = braking.take_entry_speeds();
  }

  std::size_t segments() const { return entry_mm_per_s_.size(); }

  /// Segments in order, with their rows and times; `next_start_s`: of the one after it.
  using Take = std::function<void(const Segment& segment, const PlanRow& row, const SegmentTime& time,
                                  double exit_speed_mm_per_s, double next_start_s)>;
  void time_segments(const Take& take) {
    build_segments(program_, machine_, [&](const Segment& s) {
      arrive(s);
      while (timed_ + 2 < known()) time_next();
      while (first_ + 1 < timed_) hand_out(take);
    });
    while (timed_ < known()) time_next();
    while (first_ < timed_) hand_out(take);
  }
  std::size_t speed_changes() const { return speed_changes_; }

 private:
  /// A segment until it, and the two after it, are known and it and the next one are timed.
  struct Row {
    Segment segment;
    PlanRow row;
    SegmentTime time;
  };
  /// A stop at which the control may wait for the axes.
  struct Stop {
    std::size_t index = 0;
    double rest_s = 0;  ///< time of the rests that follow
  };
  /// Segments from one change of the law of acceleration to the next.
  struct Stretch {
    std::size_t from = 0;
    bool exponential = false;
  };

  // --- speeds

  void add(const Segment& s, BrakingRows& braking) {
    const std::size_t i = braking.size();
    if (stretches_.empty() || stretches_.back().exponential != exponential(s.mode))
      stretches_.push_back({i, exponential(s.mode)});
    braking.add(planned_row_of(s));
    if (std::isfinite(machine_.control.in_position_mm)) note_stop(s, i);
  }

  PlanRow planned_row_of(const Segment& s) const {
    PlanRow row = row_of(s);
    // The exponential law knows no corners; but no axis enters a block faster than it can go.
    if (exponential(s.mode)) row.entry_speed_mm_per_s = s.axis_limit_mm_per_s;
    return row;
  }

  /// Keeps the segments at whose end the control waits for the axes: exact stops, and where rapid and feed meet.
  void note_stop(const Segment& s, std::size_t i) {
    if (s.length_mm == 0 && !s.gap) {
      if (last_) last_->stop.rest_s += s.dwell_s;
      return;
    }
    if (last_ && (last_->exact || s.gap || last_->cutting != s.cutting)) stops_.push_back(last_->stop);
    last_.reset();
    if (!s.gap) last_ = {{i, 0}, s.exact, s.cutting};
  }

  bool exponential(std::size_t mode) const { return laws_[mode].law == AccelerationLaw::exponential; }

  // --- times

  void arrive(const Segment& s) {
    const std::size_t i = known();
    Row& now = rows_.emplace_back();
    now.segment = s;
    now.row = planned_row_of(s);
    now.row.entry_speed_mm_per_s = entry_mm_per_s_[i];
    if (next_stretch_ < stretches_.size() && stretches_[next_stretch_].from == i) {
      reachable_ = {};
      ++next_stretch_;
    }
    if (!exponential(s.mode)) now.row.entry_speed_mm_per_s = reachable_.enter(now.row);
    now.time = {
        .move = s.move, .mode = s.mode, .rest = s.length_mm == 0, .cutting = s.cutting, .duration_s = s.dwell_s};
  }

  std::size_t known() const { return first_ + rows_.size(); }
  Row& at(std::size_t i) { return rows_[i - first_]; }
  const Row& at(std::size_t i) const { return rows_[i - first_]; }
  bool row_exponential(std::size_t i) const { return exponential(at(i).time.mode); }
  double exit_speed_mm_per_s(std::size_t i) const { return i + 1 < known() ? at(i + 1).row.entry_speed_mm_per_s : 0.0; }
  Trapezoid profile_at(std::size_t i) const { return trapezoid_of(at(i).row, exit_speed_mm_per_s(i)); }

  void hand_out(const Take& take) {
    const Row& row = rows_.front();
    const double end_s = row.time.end_s();
    // The pause for a whole period belongs to the segment that waits for it.
    take(row.segment, row.row, row.time, exit_speed_mm_per_s(first_),
         first_ + 1 < known() ? std::min(at(first_ + 1).time.start_s, end_s) : end_s);
    rows_.pop_front();
    ++first_;
  }

  /// Returns where the segment ends.
  double finish(std::size_t i) {
    if (next_stop_ < stops_.size() && stops_[next_stop_].index == i) {
      const Row& row = at(i);
      const double wait_s = in_position_wait_s(
          machine_, row.segment, motion_in_row(row.row, row.time, exit_speed_mm_per_s(i), row.segment, machine_),
          map_ ? &*map_ : nullptr);
      at(i).time.wait_s = std::max(0.0, wait_s - stops_[next_stop_++].rest_s);
    }
    return at(i).time.end_s();
  }

  /// Times a positioning move: it may begin before the segment before it ends, and the next one before it ends.
  void time_positioning(std::size_t i) {
    const Segment& s = at(i).segment;
    SegmentTime& time = at(i).time;
    const SegmentMotion motion = positioning_motion(s, positioning_extra_s(machine_));
    time.duration_s = motion.duration_s;
    time.start_s = now_s_ - std::min(overlap_s_, motion.axes_s / 2.0);
    const double percent = machine_.cycle.rapid_overlap_percent;
    overlap_s_ = percent > 0 ? overlap_time_s(s, percent) : 0.0;
    speed_changes_ += 2;
  }

  void time_next() {
    const std::size_t i = timed_;
    if (at(i).segment.axes_apart) {
      time_positioning(i);
      ramp_ = 0;
      speed_ = 0;
    } else if (row_exponential(i)) {
      overlap_s_ = 0;
      ramp_ = 0;
      time_exponential(i);
    } else {
      overlap_s_ = 0;
      speed_ = 0;
      if (at(i).segment.overlaps || begins_s_)
        time_overlapping(i);
      else
        time_along(i);
    }
    now_s_ = finish(i);
    ++timed_;
  }

  bool rests_at(std::size_t i) const { return i >= known() || at(i).time.rest; }

  /// A block that begins while the one before it brakes, or of which the next one does.
  void time_overlapping(std::size_t i) {
    SegmentTime& time = at(i).time;
    const PlanRow& row = at(i).row;
    const Trapezoid profile = profile_at(i);
    const bool next = at(i).segment.overlaps;
    OverlapOptions options{.start_s = begins_s_ ? *begins_s_ : start_of(i, profile),
                           .alone_from_s = now_s_,
                           .period_s = machine_.control.period_s};
    if (next)
      options.speed =
          std::min(at(i).segment.overlap_speed_mm_per_s, overlap_speed(row, at(i + 1).row, rests_at(i + 2)));
    const OverlapTimes found = profile.entry == 0 && profile.exit == 0 && std::isfinite(row.acceleration_mm_per_s2)
                                   ? overlap_times(row, options)
                                   : trapezoid_times(profile, options);
    time.overlapped = true;
    time.start_s = options.start_s;
    time.duration_s = std::max(now_s_, found.end_s) - options.start_s;
    speed_changes_ += 2;
    begins_s_.reset();
    if (next) begins_s_ = std::min(found.next_start_s, time.end_s());
  }

  /// Does the same for a block that is entered, or left, at speed (lines rounded with their neighbours at the other
  /// end).
  static OverlapTimes trapezoid_times(const Trapezoid& profile, const OverlapOptions& options) {
    const double end_s = options.start_s + profile.duration_s();
    const double brake_s =
        std::isinf(profile.acceleration)
            ? 0.0
            : std::min({options.speed / profile.acceleration, profile.brake_s, end_s - options.alone_from_s});
    return {.end_s = end_s, .next_start_s = end_s - std::max(0.0, brake_s)};
  }

  void time_along(std::size_t i) {
    SegmentTime& time = at(i).time;
    const Trapezoid profile = profile_at(i);
    time.start_s = start_of(i, profile);
    if (time.rest) return;
    time.duration_s = profile.duration_s();
    const auto begins = [&](int kind, double phase_s) {
      if (phase_s <= kNoRamp) return false;
      const bool begun = kind != 0 && kind != ramp_;
      ramp_ = kind;
      return begun;
    };
    time.accelerates = begins(+1, profile.accelerate_s);
    time.duration_s += ramp_extra_s(time.accelerates, profile.accelerate_s, profile.entry, profile.peak, time.mode);
    begins(0, profile.cruise_s);
    time.brakes = begins(-1, profile.brake_s);
    time.duration_s += ramp_extra_s(time.brakes, profile.brake_s, profile.peak, profile.exit, time.mode);
    speed_changes_ += std::size_t{time.accelerates} + std::size_t{time.brakes};
  }

  /// Returns what the next part of the change of speed under way costs more than with constant acceleration.
  double ramp_extra_s(bool begins, double plain_s, double from_mm_per_s, double to_mm_per_s, std::size_t mode) {
    if (plain_s <= kNoRamp) return 0;
    if (begins) change_ = {.from_mm_per_s = from_mm_per_s};
    change_.plain_s += plain_s;
    const double before_s = change_.extra_s;
    change_.extra_s = bell_extra_s(change_.plain_s, build_up_s(laws_[mode]), change_.from_mm_per_s, to_mm_per_s);
    return (begins ? machine_.cycle.jerk_filter_s : 0.0) + std::max(0.0, change_.extra_s - before_s);
  }

  /// A start from (almost) rest waits for the next period of the control: after a rest or a positioning always, after
  /// the stop of another block where the control starts it on a period.
  double start_of(std::size_t i, const Trapezoid& profile) const {
    const double period_s = machine_.control.period_s;
    const bool after_block = i > 0 && !at(i - 1).time.rest && !at(i - 1).segment.axes_apart;
    const bool from_rest = profile.length > 0 && profile.entry < profile.acceleration * period_s;
    if (!from_rest || (after_block && !machine_.control.starts_on_period) || now_s_ <= 0 ||
        std::isinf(profile.acceleration))
      return now_s_;
    return std::max(now_s_, std::ceil(now_s_ / period_s - 1e-9) * period_s);
  }

  /// Block by block; the speed at a block's end is the next one's start, and a stop costs T1 + T2.
  void time_exponential(std::size_t i) {
    SegmentTime& time = at(i).time;
    PlanRow& row = at(i).row;
    const double t1 = laws_[time.mode].time_constant_1_s, t2 = laws_[time.mode].time_constant_2_s;
    time.start_s = now_s_;
    row.entry_speed_mm_per_s = speed_ = std::min(speed_, row.entry_speed_mm_per_s);
    if (time.rest) {
      speed_ = 0;
      return;
    }
    const ExponentialRamp ramp{speed_, row.speed_limit_mm_per_s, t1, t2};
    const bool at_once = std::isinf(ramp.command_mm_per_s);  // a rapid of axes without a limit
    const double time_s = at_once ? 0.0 : ramp.time_of(row.length_mm);
    const bool stops = stops_after(i);
    time.duration_s = time_s + (stops ? t1 + t2 : 0.0);
    speed_ = stops || at_once ? 0.0 : ramp.speed_at(time_s);
  }

  bool stops_after(std::size_t i) const {
    if (i + 1 >= known() || at(i + 1).time.rest || !row_exponential(i + 1)) return true;
    const nc::Move& move = program_.moves[at(i).time.move];
    const bool exact = path_control_of(machine_, program_.state_of(move)) == nc::PathControl::exact_stop;
    const bool cutting = at(i).time.cutting;
    return move.exact_stop || exact || cutting != at(i + 1).time.cutting || !cutting;
  }

  const nc::Interpretation& program_;
  const machine::Machine& machine_;
  std::vector<machine::AccelerationTimes> laws_;  ///< one per mode
  std::optional<kinematics::JointMap> map_;       // of a program with rotary motion
  std::vector<Stretch> stretches_;                // in order
  std::vector<Stop> stops_;                       // in order
  struct LastMotion {
    Stop stop;
    bool exact = false, cutting = false;
  };
  std::optional<LastMotion> last_;
  std::vector<double> entry_mm_per_s_;  // of all segments, as braking allows

  std::deque<Row> rows_;
  std::size_t first_ = 0, timed_ = 0;  // segments that were handed out, that were timed
  std::size_t next_stop_ = 0, next_stretch_ = 0;
  ReachableSpeed reachable_;
  double now_s_ = 0, overlap_s_ = 0;
  double speed_ = 0;  // at the end of the last block, under the exponential law
  int ramp_ = 0;      // the change of speed under way: +1 accelerating, -1 braking
  struct SpeedChange {
    double from_mm_per_s = 0, plain_s = 0, extra_s = 0;  ///< so far
  };
  SpeedChange change_;              // under way
  std::optional<double> begins_s_;  // the next segment, while the one before it brakes
  std::size_t speed_changes_ = 0;
};

}  // namespace

MotionPlan plan_motion(const nc::Interpretation& program, const machine::Machine& machine) {
  Planner planner(program, machine);
  planner.plan_entry_speeds();
  MotionPlan out;
  out.rows.reserve(planner.segments());
  out.times.reserve(planner.segments());
  planner.time_segments([&](const Segment&, const PlanRow& row, const SegmentTime& time, double, double) {
    out.rows.push_back(row);
    out.times.push_back(time);
  });
  out.speed_changes = planner.speed_changes();
  return out;
}

void follow_motion(const nc::Interpretation& program, const machine::Machine& machine, const TakeMotion& take) {
  constexpr std::size_t kTogether = 1024;  // segments between two steps of the progress
  Planner planner(program, machine);
  planner.plan_entry_speeds();
  Stage stage("following the axes", planner.segments());
  std::size_t i = 0;
  planner.time_segments([&](const Segment& segment, const PlanRow& row, const SegmentTime& time,
                            double exit_speed_mm_per_s, double next_start_s) {
    take(segment, motion_in_row(row, time, exit_speed_mm_per_s, segment, machine), time, next_start_s);
    if (++i % kTogether == 0) stage.advance(kTogether);
  });
}

Trapezoid profile_of(const std::vector<PlanRow>& rows, std::size_t i) {
  return trapezoid_of(rows[i], i + 1 < rows.size() ? rows[i + 1].entry_speed_mm_per_s : 0.0);
}

SegmentMotion motion_of(const MotionPlan& plan, std::size_t i, const Segment& segment,
                        const machine::Machine& machine) {
  return motion_in_row(plan.rows[i], plan.times[i],
                       i + 1 < plan.rows.size() ? plan.rows[i + 1].entry_speed_mm_per_s : 0.0, segment, machine);
}

}  // namespace camber::feedmodel
