#pragma once
// A machine that is known, figures that tell it, and the trace that it leaves.
#include <cmath>

#include "calib/fit_feed_model.h"
#include "feedmodel/timed_path.h"
#include "tests/support/test_program.h"

namespace camber::tests {

inline machine::Machine known_machine() {
  machine::Machine m;
  m.control.kind = *machine::control_kind_named("linuxcnc");
  m.control.corner = {.law = machine::CornerLaw::blend, .tolerance_mm = 0.01, .step_fraction = 0.1};
  m.control.arc_normal_fraction = 0.8;
  m.control.arc_tangential_fraction = 0.6;
  m.control.stop_acceleration_fraction = 0.5;
  const double acceleration[] = {900, 700, 450}, gain[] = {25, 35, 45}, lag[] = {0.002, 0.004, 0.006};
  for (int i = 0; i < 3; ++i) {
    m.axis[i].acceleration_mm_per_s2 = acceleration[i];
    m.axis[i].position_gain_per_s = gain[i];
    m.axis[i].velocity_lag_s = lag[i];
  }
  return m;
}

/// Figures in three planes, each from rest to rest at the origin.
/// `size`: of every side; the feeds go with it the other way.
inline nc::Interpretation figures(double size = 1.0) {
  TestProgram p;
  for (double feed : {1000.0 / size, 3000.0 / size, 6000.0 / size}) {
    for (double side : {2.0 * size, 7.0 * size}) {
      p.line(side, 0, 0, feed).line(side, side, 0, feed).line(0, side, 0, feed).line(0, 0, 0, feed).dwell(0.1);
      p.line(0, side, 0, feed).line(0, side, side, feed).line(0, 0, side, feed).line(0, 0, 0, feed).dwell(0.1);
      p.line(side, 0, 0, feed).line(side / 2, 0, side, feed).line(0, 0, 0, feed).dwell(0.1);
      p.line(side, 0, 0, feed).arc_xy(side, 2, side, 1, kPi, feed).line(0, 2, 0, feed).line(0, 0, 0, feed).dwell(0.1);
    }
  }
  p.new_state().path_control = nc::PathControl::exact_path;
  for (double turn : {0.1, 0.3, 0.6}) {
    double angle = 0;
    Vec3 at = Vec3::Zero();
    for (int i = 0; i < 8; ++i) {
      at += Vec3(std::cos(angle), std::sin(angle), 0);
      angle += turn;
      p.line(at.x(), at.y(), 0, 3000);
    }
    p.dwell(0.1).line(0, 0, 0, 3000).dwell(0.1);
  }
  return p.program;
}

inline calib::FeedRun synthetic_run(const machine::Machine& machine, double size = 1.0) {
  calib::FeedRun run{"figures", figures(size), {}};
  run.trace.period_s = machine.control.period_s;
  run.trace.has_command = run.trace.has_actual = {true, true, true};
  feedmodel::predict_feed(run.program, machine, [&](std::span<const feedmodel::TimedSample> samples) {
    for (const feedmodel::TimedSample& s : samples) {
      run.trace.t_s.push_back(s.t_s);
      run.trace.command_mm.push_back(s.command_mm);
      run.trace.actual_mm.push_back(s.position_mm);
      run.trace.line.push_back(s.feed_command_mm_per_s > 0 ? run.program.moves[s.move].block + 1 : 0);
    }
  });
  run.trace.stretches = {{0, run.trace.t_s.size()}};
  return run;
}

}  // namespace camber::tests
