#include "feedmodel/cycle_time.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>

#include "base/units.h"
#include "feedmodel/axis_places.h"
#include "feedmodel/motion_plan.h"
#include "feedmodel/rapid.h"
#include "feedmodel/rests.h"
#include "feedmodel/yan_shirase.h"
#include "kinematics/joint_map.h"
#include "kinematics/program_joints.h"

namespace camber::feedmodel {
namespace {

void add_plan(const MotionPlan& plan, MotionTimes& out) {
  assert(plan.times.size() == plan.rows.size());
  double end_s = 0;
  for (std::size_t i = 0; i < plan.times.size(); ++i) {
    const SegmentTime& time = plan.times[i];
    out.move_s[time.move] += time.end_s() - end_s;
    end_s = time.end_s();
    if (time.cutting && !time.rest)
      out.acceleration[time.move] = static_cast<float>(plan.rows[i].acceleration_mm_per_s2);
  }
  out.speed_changes = plan.speed_changes;
}

void count_positionings(const nc::Interpretation& program, const machine::Machine& machine, MotionTimes& out) {
  const Vec3 speed = rapid_speeds_mm_per_s(machine), acceleration = rapid_accelerations_mm_per_s2(machine);
  AxisPlaces places(machine, kinematics::has_rotary_motion(program, machine));
  for (const nc::Move& move : program.moves) {
    const AxisPlaces::Way way = places.pass(move);
    out.unplaced_moves += !way.complete;
    const Vec3 distance = way.to_mm - way.from_mm;
    if (move.kind == nc::MoveKind::rapid && !distance.isZero(0))
      out.below_full_rapid += below_full_rapid(distance, speed, acceleration);
  }
}

}  // namespace

MotionTimes motion_times(const nc::Interpretation& program, const machine::Machine& machine) {
  MotionTimes out;
  out.move_s.assign(program.moves.size(), 0.0);
  out.acceleration.assign(program.moves.size(), 0.0F);
  add_plan(plan_motion(program, machine), out);
  count_positionings(program, machine, out);
  return out;
}

namespace {

using nc::EventKind;

/// Time of a turn of the index table from rest to rest; it may turn either way.
double index_time_s(const machine::IndexTable& table, double turn_deg) {
  const double around = std::fabs(std::remainder(turn_deg, 360.0));
  if (around < 1e-9) return 0;
  const Vec3 turn(rad_from_deg(around), 0, 0), speed(table.max_velocity_rad_per_s, 1, 1),
      acceleration(table.acceleration_rad_per_s2, 1, 1);
  return rapid_time_s(turn, speed, acceleration) + table.clamp_s;
}

/// Times of the events of one block, by kind.
struct Actions {
  double spindle_s = 0, index_s = 0, codes_s = 0;  // may run along with the motion
  double tool_change_s = 0, pallet_s = 0;          // everything waits for them
};

class CycleClock {
 public:
  CycleClock(const nc::Interpretation& program, const machine::Machine& machine)
      : program_(program),
        machine_(machine),
        places_(machine, kinematics::has_rotary_motion(program, machine)),
        rapid_speed_(rapid_speeds_mm_per_s(machine)),
        rapid_acceleration_(rapid_accelerations_mm_per_s2(machine)) {
    const bool clamps = std::ranges::any_of(machine.rotary, [](const machine::RotaryAxis& a) { return a.clamp_s > 0; });
    if (clamps && kinematics::has_rotary_motion(program, machine)) joints_.emplace(machine, program);
  }

  CycleTime run() {
    out_.g00 = out_.g01 = DistanceHistogram(machine_.cycle.histogram_step_mm);
    MotionTimes motion = motion_times(program_, machine_);
    out_.below_full_rapid = motion.below_full_rapid;
    out_.speed_changes = motion.speed_changes;
    out_.unplaced_moves = motion.unplaced_moves;
    for (std::size_t i = 0; i < program_.moves.size(); ++i) {
      const nc::Move& move = program_.moves[i];
      work_off_events(i, motion.move_s[i]);
      use(program_.state_of(move).tool);
      add_move(move, motion.move_s[i], motion.acceleration[i]);
      if (joints_) use(tool_).time.index_s += clamp_of_move_s(move, joints_->next());
    }
    work_off_events(program_.moves.size(), 0);
    for (CycleUse& tool : out_.tools) out_.all += tool;
    out_.move_s = std::move(motion.move_s);
    return std::move(out_);
  }

 private:
  /// The events before a move, block by block; those of its own block act while it moves.
  void work_off_events(std::size_t move, double motion_s) {
    while (next_ < program_.events.size() && program_.events[next_].before_move <= move) {
      std::size_t end = next_;
      const std::uint32_t block = program_.events[next_].block;
      while (end < program_.events.size() && program_.events[end].block == block &&
             program_.events[end].before_move == program_.events[next_].before_move)
        ++end;
      const bool together = move < program_.moves.size() && program_.moves[move].block == block;
      book(actions_of(std::span(program_.events).subspan(next_, end - next_)), together ? motion_s : 0.0);
      next_ = end;
    }
  }

  void book(const Actions& actions, double motion_s) {
    const bool sequential = machine_.cycle.code_order == machine::CodeOrder::sequential;
    CycleSplit& time = use(tool_).time;
    double longest_s = motion_s;
    const auto beside = [&](double action_s) {
      const double longer_s = std::max(0.0, action_s - longest_s);
      longest_s += longer_s;
      return longer_s;
    };
    time.spindle_s += beside(actions.spindle_s);
    time.index_s += beside(actions.index_s);
    time.m_code_s += sequential ? actions.codes_s : beside(actions.codes_s);
    time.tool_change_s += actions.tool_change_s;
    time.pallet_s += actions.pallet_s;
  }

  Actions actions_of(std::span<const nc::Event> events) {
    const machine::Cycle& cycle = machine_.cycle;
    Actions actions;
    bool orient = false;
    for (const nc::Event& event : events) {
      switch (event.kind) {
        case EventKind::tool_select:
          actions.codes_s += cycle.t_code_s;
          break;
        case EventKind::spindle_speed:
          actions.codes_s += cycle.s_code_s;
          commanded_rpm_ = event.value;
          break;
        case EventKind::tool_change:
          actions.tool_change_s += change_tool(static_cast<int>(event.value));
          break;
        case EventKind::spindle_clockwise:
        case EventKind::spindle_counter_clockwise:
          actions.codes_s += cycle.m_code_s;
          turn_ = event.kind == EventKind::spindle_clockwise ? 1 : -1;
          break;
        case EventKind::spindle_stop:
          actions.codes_s += cycle.m_code_s;
          turn_ = 0;
          break;
        case EventKind::spindle_orient:
          actions.codes_s += cycle.m_code_s;
          turn_ = 0;
          orient = true;
          break;
        case EventKind::m_code:
          actions.codes_s += cycle.m_code_s;
          if (joints_) actions.index_s += release_s(event.value);
          break;
        case EventKind::index:
          actions.index_s += turn_table(event);
          break;
        case EventKind::pallet:
          actions.pallet_s += cycle.pallet_change_s;
          break;
      }
    }
    actions.spindle_s = bring_spindle_to(turn_ * commanded_rpm_) + (orient ? machine_.spindle.orient_s : 0.0);
    return actions;
  }

  /// A code that releases axes: they are clamped again later, and both is booked here.
  double release_s(double m_code) const {
    double longest_s = 0;
    for (const machine::RotaryAxis& axis : machine_.rotary)
      if (axis.clamp_m > 0 && axis.unclamp_m == m_code) longest_s = std::max(longest_s, axis.clamp_s);
    return longest_s;
  }

  /// Axes without such codes release and clamp themselves, together, for each positioning that turns them.
  double clamp_of_move_s(const nc::Move& move, const kinematics::MoveJoints& now) const {
    double longest_s = 0;
    if (move.kind != nc::MoveKind::rapid) return 0;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const machine::RotaryAxis& axis = machine_.rotary[static_cast<std::size_t>(i)];
      if (axis.clamp_m == 0 && now.start_rad[i] != now.end_rad[i]) longest_s = std::max(longest_s, axis.clamp_s);
    }
    return longest_s;
  }

  double bring_spindle_to(double signed_rpm) {
    const machine::Spindle& spindle = machine_.spindle;
    const bool reverses = signed_rpm * spindle_rpm_ < 0;
    const double time_s =
        reverses ? spindle_start_s(spindle, std::abs(spindle_rpm_)) + spindle_start_s(spindle, std::abs(signed_rpm))
                 : spindle_change_s(spindle, std::abs(spindle_rpm_), std::abs(signed_rpm));
    spindle_rpm_ = signed_rpm;
    return time_s;
  }

  /// Head to the change position while the spindle stops and turns into its place, the change, the head back. A tool
  /// that is in the spindle already is not changed. The spindle stands afterwards.
  double change_tool(int tool) {
    if (changed_ && tool == tool_) return 0;
    changed_ = true;
    ++use(tool).tool_changes;
    const machine::ToolChange& change = machine_.tool_change;
    const double stop_s = bring_spindle_to(0) + machine_.spindle.orient_s;
    turn_ = 0;
    if (change.chip_to_chip_s > 0) return change.chip_to_chip_s;
    const double head_s = rapid_time_s(places_.way_to_change(), rapid_speed_, rapid_acceleration_);
    return std::max(head_s, stop_s) + change.tool_to_tool_s + head_s;
  }

  double turn_table(const nc::Event& event) {
    const double to_deg = event.incremental ? table_deg_ + event.value : event.value;
    const double time_s = index_time_s(machine_.index, to_deg - table_deg_);
    table_deg_ = to_deg;
    return time_s;
  }

  CycleUse& use(int tool) {
    tool_ = tool;
    if (last_use_ && out_.tools[*last_use_].tool == tool) return out_.tools[*last_use_];
    auto it = std::find_if(out_.tools.begin(), out_.tools.end(), [&](const CycleUse& u) { return u.tool == tool; });
    last_use_ = static_cast<std::size_t>(it - out_.tools.begin());
    if (it == out_.tools.end()) out_.tools.push_back({.tool = tool});
    return out_.tools[*last_use_];
  }

  void add_move(const nc::Move& move, double time_s, double acceleration) {
    const AxisPlaces::Way way = places_.pass(move);
    CycleUse& tool = use(tool_);
    switch (move.kind) {
      case nc::MoveKind::dwell:
        tool.time.dwell_s += time_s;
        return;
      case nc::MoveKind::rapid: {
        const double length = (way.to_mm - way.from_mm).norm();
        tool.time.positioning_s += time_s;
        tool.positioning_mm += length;
        if (length > 0) out_.g00.add(length);
        return;
      }
      case nc::MoveKind::linear:
      case nc::MoveKind::arc:
        break;
    }
    tool.time.cutting_s += time_s;
    const double length = move.reference ? 0.0 : nc::length_mm(program_, move);
    if (length <= 0 || move.feed_mm_per_s <= 0) return;
    if (move.kind == nc::MoveKind::linear) out_.g01.add(length);
    ++tool.cutting_moves;
    tool.cutting_mm += length;
    tool.commanded_s += length / (move.feed_mm_per_s * machine_.cycle.feed_override_percent / 100.0);
    if (acceleration > 0) last_acceleration_ = acceleration;  // of merged lines only the last one has one
    tool.acceleration_mm2_per_s2 += length * last_acceleration_;
  }

  const nc::Interpretation& program_;
  const machine::Machine& machine_;
  AxisPlaces places_;
  std::optional<kinematics::ProgramJoints> joints_;  ///< only for a program with rotary motion whose axes are clamped
  Vec3 rapid_speed_, rapid_acceleration_;
  CycleTime out_;
  std::size_t next_ = 0;  // event to come
  std::optional<std::size_t> last_use_;
  int tool_ = 0;
  bool changed_ = false;
  double commanded_rpm_ = 0, spindle_rpm_ = 0;  // spindle_rpm_: negative for M4
  int turn_ = 0;
  double table_deg_ = 0;
  double last_acceleration_ = 0;
};

}  // namespace

double CycleSplit::total_s() const {
  double total = 0;
  for (const CycleKind& kind : kCycleKinds) total += this->*kind.field;
  return total;
}

CycleSplit& CycleSplit::operator+=(const CycleSplit& other) {
  for (const CycleKind& kind : kCycleKinds) this->*kind.field += other.*kind.field;
  return *this;
}

const CycleKind& dominant_kind(const CycleSplit& split) {
  return *std::max_element(std::begin(kCycleKinds), std::end(kCycleKinds),
                           [&](const CycleKind& a, const CycleKind& b) { return split.*a.field < split.*b.field; });
}

double CycleUse::commanded_feed_mm_per_s() const { return commanded_s > 0 ? cutting_mm / commanded_s : 0; }
double CycleUse::average_feed_mm_per_s() const { return time.cutting_s > 0 ? cutting_mm / time.cutting_s : 0; }
double CycleUse::acceleration_mm_per_s2() const { return cutting_mm > 0 ? acceleration_mm2_per_s2 / cutting_mm : 0; }
double CycleUse::e() const { return time.cutting_s > 0 ? commanded_s / time.cutting_s : 0; }

double CycleUse::k() const {
  if (cutting_moves == 0) return 0;
  return block_feed_number(commanded_feed_mm_per_s(), acceleration_mm_per_s2(),
                           cutting_mm / static_cast<double>(cutting_moves));
}

CycleUse& CycleUse::operator+=(const CycleUse& other) {
  time += other.time;
  tool_changes += other.tool_changes;
  cutting_mm += other.cutting_mm;
  positioning_mm += other.positioning_mm;
  cutting_moves += other.cutting_moves;
  commanded_s += other.commanded_s;
  acceleration_mm2_per_s2 += other.acceleration_mm2_per_s2;
  return *this;
}

DistanceHistogram::DistanceHistogram(double step_mm) {
  constexpr int kSteps = 20;
  if (step_mm > 0)
    for (int i = 1; i <= kSteps; ++i) edges_mm.push_back(step_mm * i);
  else
    edges_mm.assign(std::begin(kDistanceEdgesMm), std::end(kDistanceEdgesMm));
  counts.assign(edges_mm.size() + 1, 0);
}

void DistanceHistogram::add(double distance_mm) {
  const auto edge = std::lower_bound(edges_mm.begin(), edges_mm.end(), distance_mm);
  ++counts[static_cast<std::size_t>(edge - edges_mm.begin())];
  ++moves;
  length_mm += distance_mm;
}

CycleTime cycle_time(const nc::Interpretation& program, const machine::Machine& machine) {
  return CycleClock(program, machine).run();
}

}  // namespace camber::feedmodel
