#pragma once
// A control that follows a known law, and the servo trace that it leaves of a short protocol: polygons, zigzags,
// circles and chords in three planes, at feeds that its axes reach and at feeds that they do not.
#include <cmath>
#include <random>

#include "calib/fit_feed_model.h"
#include "feedmodel/timed_path.h"
#include "tests/support/random_motion.h"

namespace camber::tests {

/// Every figure starts from rest at the origin and returns to it.
class ShortProtocol {
 public:
  ShortProtocol() {
    for (const double feed : {600.0, 2000.0, 5000.0}) {
      for (int plane = 0; plane < 3; ++plane) {
        for (const double turn_deg : {10.0, 20.0, 30.0, 60.0, 90.0, 120.0}) polygon(plane, turn_deg, 4, feed);
        polygon(plane, 60, 1, feed);
      }
      for (const double turn_deg : {25.0, 40.0, 50.0, 75.0}) zigzag(turn_deg, feed);
      for (const double radius : {1.0, 4.0}) circle(radius, feed);
    }
    chords(0.05);
    chords(0.02);
  }
  const nc::Interpretation& program() const { return p_.program; }

 private:
  void line(int plane, double u, double v, double feed) {
    Vec3 at = Vec3::Zero();
    at[plane] = u;
    at[(plane + 1) % 3] = v;
    p_.line(at.x(), at.y(), at.z(), feed);
  }
  void home() { p_.dwell(0.2).rapid(0, 0, 0).dwell(0.2); }

  void polygon(int plane, double turn_deg, double side, double feed) {
    double u = 0, v = 0;
    for (int i = 0; i < std::lround(360 / turn_deg); ++i) {
      const double heading = i * turn_deg * kPi / 180;
      line(plane, u += side * std::cos(heading), v += side * std::sin(heading), feed);
    }
    home();
  }
  void zigzag(double turn_deg, double feed) {
    double u = 0, v = 0;
    for (int i = 0; i < 10; ++i) {
      const double heading = (i % 2 ? -0.5 : 0.5) * turn_deg * kPi / 180;
      line(0, u += 4 * std::cos(heading), v += 4 * std::sin(heading), feed);
    }
    home();
  }
  void circle(double radius, double feed) {
    p_.arc_xy(0, 0, -radius, 0, 2 * kPi, feed);
    home();
  }
  void chords(double length) {
    for (int i = 1; i <= 150; ++i) {
      const double phi = i * length / 40;
      line(0, 40 * std::sin(phi), 40 * (1 - std::cos(phi)), 6000);
    }
    home();
  }

  TestProgram p_;
};

struct Noise {
  double position_mm = 0;
  unsigned seed = 1;
};

/// Line by line as a control reports it; `line` is 0 in rests.
inline calib::FeedRun traced_run(const nc::Interpretation& program, const machine::Machine& machine, Noise noise) {
  calib::FeedRun run{"protocol", program, {}};
  calib::ServoTrace& t = run.trace;
  t.period_s = machine.control.period_s;
  t.has_command = t.has_actual = {true, true, true};
  std::mt19937 random(noise.seed);
  std::normal_distribution<double> error(0, noise.position_mm > 0 ? noise.position_mm : 1);
  feedmodel::predict_feed(run.program, machine, [&](std::span<const feedmodel::TimedSample> samples) {
    for (const feedmodel::TimedSample& s : samples) {
      Vec3 place = s.position_mm;
      if (noise.position_mm > 0)
        for (int i = 0; i < 3; ++i) place[i] += error(random);
      t.t_s.push_back(s.t_s);
      t.command_mm.push_back((s.command_mm * 1e4).array().round() / 1e4);
      t.actual_mm.push_back(place);
      t.line.push_back(s.feed_command_mm_per_s > 0 ? run.program.moves[s.move].block + 1 : 0);
    }
  });
  t.stretches = {{0, t.t_s.size()}};
  return run;
}

/// Any corner law with any sensible number; drives that lag.
inline machine::Machine synthetic_control(unsigned seed, machine::CornerLaw law) {
  Dice dice(seed);
  machine::Machine m;
  machine::Corner& corner = m.control.corner;
  corner.law = law;
  if (law == machine::CornerLaw::speed_difference) corner.speed_difference_mm_per_s = dice.between(1, 12);
  if (law == machine::CornerLaw::angle) corner.time_s = dice.between(0.002, 0.012);
  if (law == machine::CornerLaw::radius) corner.acceleration_mm_per_s2 = dice.between(60, 600);
  if (law == machine::CornerLaw::blend) {
    m.control.kind = *machine::control_kind_named("linuxcnc");
    m.cycle.rapid_path = machine::RapidPath::linear;
    corner.tolerance_mm = machine::kNoLimit;
    corner.step_fraction = 0.1;
    corner.short_line_time_s = 0.004;
    m.control.lookahead_blocks = 50;
    m.control.arc_normal_fraction = 0.87;
    m.control.arc_tangential_fraction = 0.5;
    m.control.stop_acceleration_fraction = 0.5;
  }
  m.control.block_time_s = dice.between(0.001, 0.004);
  for (machine::Axis& axis : m.axis) {
    axis.max_velocity_mm_per_s = 300;
    axis.acceleration_mm_per_s2 = dice.between(400, 2500);
    axis.position_gain_per_s = dice.between(25, 60);
    axis.velocity_lag_s = dice.between(0.001, 0.004);
  }
  return m;
}

}  // namespace camber::tests
