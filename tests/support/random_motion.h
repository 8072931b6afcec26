#pragma once
// Random programs and random machines: what must be the same, or kept, whatever they hold.
#include <random>

#include "machine/machine_model.h"
#include "tests/support/test_program.h"

namespace camber::tests {

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double between(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random_); }
  bool chance(double fraction) { return between(0, 1) < fraction; }
  int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }

 private:
  std::mt19937 random_;
};

/// Lines, arcs, rapids, dwells, exact stops, tool changes, and codes that the path may wait for.
inline nc::Interpretation random_motion(unsigned seed) {
  Dice dice(seed);
  TestProgram p;
  Vec3 at = Vec3::Zero();
  const int moves = 8 + dice.pick(30);
  for (int i = 0; i < moves; ++i) {
    const double size = dice.chance(0.3) ? 30 : 3;
    const double feed = dice.between(200, 8000);
    const Vec3 to = at + Vec3(dice.between(-size, size), dice.between(-size, size), dice.between(-size, size) / 2);
    switch (dice.pick(8)) {
      case 0:
      case 1:
        p.rapid(to.x(), to.y(), to.z());
        at = to;
        break;
      case 2: {
        const double r = dice.between(0.5, 15);
        p.arc_xy(at.x() + r, at.y() + r, at.x(), at.y() + r, dice.chance(0.5) ? kPi / 2 : 2 * kPi + kPi / 2, feed);
        at += Vec3(r, r, 0);
        break;
      }
      case 3:
        if (dice.chance(0.3)) p.dwell(dice.between(0.01, 0.5));
        if (dice.chance(0.2)) p.new_state().path_control = static_cast<nc::PathControl>(dice.pick(3));
        if (dice.chance(0.2)) ++p.new_state().tool;
        if (dice.chance(0.3))
          p.program.events.push_back({.value = 8,
                                      .before_move = static_cast<std::uint32_t>(p.program.moves.size()),
                                      .kind = dice.chance(0.5) ? nc::EventKind::m_code : nc::EventKind::spindle_stop});
        [[fallthrough]];
      default:
        p.line(to.x(), to.y(), to.z(), feed);
        if (dice.chance(0.1)) p.program.moves.back().exact_stop = true;
        at = to;
    }
  }
  return p.program;
}

/// A machine with any of the laws, limits, filters and settings that a machine file can hold.
inline machine::Machine random_machine(unsigned seed) {
  Dice dice(seed);
  machine::Machine m;
  const auto maybe = [&](double fraction, double from, double to, double otherwise) {
    return dice.chance(fraction) ? dice.between(from, to) : otherwise;
  };
  m.control.kind = *machine::control_kind_named(dice.chance(0.3) ? "linuxcnc" : "fanuc");
  machine::Corner& corner = m.control.corner;
  corner.law = static_cast<machine::CornerLaw>(dice.pick(5));
  corner.tolerance_mm = dice.between(0.001, 0.1);
  corner.speed_difference_mm_per_s = dice.between(1, 20);
  corner.time_s = dice.between(0.001, 0.02);
  corner.acceleration_mm_per_s2 = dice.between(100, 5000);
  corner.threshold_rad = maybe(0.3, 0.01, 0.2, 0);
  corner.stop_angle_rad = maybe(0.3, 0.5, 2, machine::kNoLimit);
  corner.stop_time_s = maybe(0.5, 0, 0.05, 0);
  m.control.block_time_s = maybe(0.5, 0, 0.01, 0);
  m.control.merge_tolerance_mm = maybe(0.3, 0, 0.1, 0);
  m.control.lookahead_blocks = dice.chance(0.5) ? 1 + dice.pick(20) : 0;
  m.control.rapid_change_s = maybe(0.3, 0, 0.1, 0);
  m.control.in_position_mm = maybe(0.7, 0.001, 0.1, machine::kNoLimit);
  m.control.rest_latency_s = maybe(0.3, 0, 0.01, 0);
  m.control.path_acceleration_mm_per_s2 = maybe(0.3, 300, 3000, machine::kNoLimit);
  const double window = maybe(0.3, 0.001, 0.05, 0);
  for (machine::Axis& axis : m.axis) {
    axis.max_velocity_mm_per_s = dice.between(50, 500);
    axis.acceleration_mm_per_s2 = dice.between(300, 5000);
    axis.rapid_mm_per_s = maybe(0.3, 50, 500, machine::kNoLimit);
    axis.rapid_acceleration_mm_per_s2 = maybe(0.3, 300, 5000, machine::kNoLimit);
    axis.position_gain_per_s = maybe(0.7, 20, 80, machine::kNoLimit);
    axis.velocity_lag_s = maybe(0.3, 0, 0.005, 0);
    axis.filter_s = window;
    axis.speed_difference_mm_per_s = maybe(0.3, 1, 20, machine::kNoLimit);
  }
  machine::Cycle& cycle = m.cycle;
  cycle.rapid_path = dice.chance(0.5) ? machine::RapidPath::dogleg : machine::RapidPath::linear;
  cycle.acceleration_law = static_cast<machine::AccelerationLaw>(dice.pick(3));
  cycle.time_constant_1_s = dice.between(0.01, 0.05);
  cycle.time_constant_2_s = dice.chance(0.5) ? cycle.time_constant_1_s : dice.between(0, 0.05);
  cycle.bell_time_s = dice.between(0, 0.06);
  cycle.feed_override_percent = maybe(0.3, 50, 150, 100);
  cycle.rapid_override_percent = maybe(0.3, 25, 100, 100);
  cycle.rapid_overlap_percent = maybe(0.3, 0, 100, 0);
  cycle.linear_acceleration_mm_per_s2 = maybe(0.3, 300, 3000, machine::kNoLimit);
  cycle.arc_acceleration_mm_per_s2 = maybe(0.3, 300, 3000, machine::kNoLimit);
  cycle.arc_tolerance_mm = maybe(0.3, 0.001, 0.05, machine::kNoLimit);
  cycle.jerk_filter_s = maybe(0.3, 0, 0.03, 0);
  cycle.m_code_s = maybe(0.5, 0, 0.5, 0);
  return m;
}

}  // namespace camber::tests
