// Traces that contradict the program that they are given with: each is named, with its place.
#include "calib/trace_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/feed_runs.h"

namespace camber::calib {
namespace {

using tests::TestProgram;

machine::Machine machine_of_test() {
  machine::Machine m;
  m.control.corner.law = machine::CornerLaw::exact_stop;
  m.cycle.rapid_path = machine::RapidPath::linear;
  for (machine::Axis& axis : m.axis) {
    axis.max_velocity_mm_per_s = 150;
    axis.acceleration_mm_per_s2 = 1000;
    axis.position_gain_per_s = 60;
  }
  return m;
}

nc::Interpretation steps() {
  TestProgram p;
  p.line(30, 0, 0, 1500).line(30, 12, 0, 1500).line(55, 12, -5, 3000).line(55, 40, -5, 3000).dwell(0.2);
  p.rapid(0, 40, 0).rapid(0, 0, 0).dwell(0.1).line(20, 3, -2, 2000).line(40, 3, -2, 2000);
  return p.program;
}

FeedRun run_of(const nc::Interpretation& program) {
  FeedRun run{"steps.nc", program, {}};
  ServoTrace& t = run.trace;
  t.path = "steps.csv";
  t.has_command = t.has_actual = {true, true, true};
  feedmodel::predict_feed(program, machine_of_test(), [&](std::span<const feedmodel::TimedSample> samples) {
    for (const feedmodel::TimedSample& s : samples) {
      t.t_s.push_back(s.t_s);
      t.command_mm.push_back(s.command_mm);
      t.actual_mm.push_back(s.position_mm);
      t.line.push_back(s.feed_command_mm_per_s > 0 ? program.moves[s.move].block + 1 : 0);
      t.row.push_back(t.row.size() + 2);
    }
  });
  set_stretches(t);
  return run;
}

/// The message, or nothing.
std::string said(FeedRun run) {
  set_stretches(run.trace);
  Diagnostics diagnostics;
  try {
    check_trace(run, machine_of_test(), diagnostics);
  } catch (const InputError& e) {
    EXPECT_EQ(e.diagnostics().size(), 1u);
    EXPECT_EQ(e.diagnostics().front().location.file, "steps.csv");
    return e.diagnostics().front().message + " [" + e.diagnostics().front().check + "]";
  }
  return {};
}

template <class Change>
FeedRun changed(const Change& change) {
  FeedRun run = run_of(steps());
  for (std::size_t k = 0; k < run.trace.size(); ++k) {
    change(run.trace.command_mm[k]);
    change(run.trace.actual_mm[k]);
  }
  return run;
}

TEST(TraceCheck, TakesATraceOfItsProgramInAnyWorkOffset) {
  EXPECT_EQ(said(run_of(steps())), "");
  EXPECT_EQ(said(changed([](Vec3& p) { p += Vec3(120, -33, 480); })), "");
}

TEST(TraceCheck, NamesAnotherProgram) {
  TestProgram other;
  for (int i = 1; i < 12; ++i) other.line(7.0 * i, i % 2 * 9.0, 0, 1200);
  FeedRun run = run_of(steps());
  run.program = other.program;
  EXPECT_EQ(
      said(run),
      "the axes do not go the way of line 2 of steps.nc (0 % of the ways between ends of lines agree); a trace of "
      "this program was expected [trace-program]");
}

TEST(TraceCheck, NamesLinesThatTheProgramDoesNotHave) {
  FeedRun run = run_of(steps());
  for (std::uint32_t& line : run.trace.line)
    if (line == 10) line = 40;
  EXPECT_EQ(said(run),
            "line 40 is commanded, but the last that moves in steps.nc is 10; a trace of this program was expected "
            "[trace-program]");
}

TEST(TraceCheck, NamesExchangedAndTurnedAxes) {
  EXPECT_EQ(said(changed([](Vec3& p) { std::swap(p.x(), p.y()); })),
            "X of the program is Y of the trace, Y of the program is X of the trace; the axes of the program were "
            "expected [trace-axes]");
  EXPECT_EQ(said(changed([](Vec3& p) { p.x() = -p.x(); })),
            "X of the program is -X of the trace; the axes of the program were expected [trace-axes]");
}

TEST(TraceCheck, NamesUnitsOfPositionsAndTimes) {
  EXPECT_EQ(said(changed([](Vec3& p) { p /= 25.4; })),
            "the positions are in inch: ways between the ends of lines are 0.0393701 times those of steps.nc; mm were "
            "expected [trace-units]");
  FeedRun run = run_of(steps());
  for (double& t : run.trace.t_s) t *= 1000;
  EXPECT_EQ(
      said(run),
      "held speeds are 0.001 times the programmed feeds: the time is not in s; seconds were expected [trace-units]");
}

TEST(TraceCheck, NamesAClockThatJumpsButNotMissingSamples) {
  FeedRun jump = run_of(steps());
  for (std::size_t k = 500; k < jump.trace.size(); ++k) jump.trace.t_s[k] += 4;
  EXPECT_EQ(said(jump),
            "the time goes on by 4.001 s at 4.5 s, the axes by 0.025 mm as in a sample of 0.001 s before; a time that "
            "runs evenly was expected [trace-time]");
  FeedRun missing = run_of(steps());
  const auto erase = [](auto& v) { v.erase(v.begin() + 500, v.begin() + 640); };
  erase(missing.trace.t_s), erase(missing.trace.command_mm), erase(missing.trace.actual_mm), erase(missing.trace.line);
  EXPECT_EQ(said(missing), "");
}

/// All of the run, or a while of it, at a fraction of the feeds: as a control does it, the times of the motion longer.
FeedRun at_override(double fraction, std::size_t from, std::size_t end) {
  const FeedRun whole = run_of(steps());
  FeedRun run = whole;
  ServoTrace& t = run.trace;
  t.t_s.clear(), t.command_mm.clear(), t.actual_mm.clear(), t.line.clear(), t.row.clear();
  for (double at = 0; at < static_cast<double>(whole.trace.size() - 1);) {
    const auto i = static_cast<std::size_t>(at);
    const double u = at - static_cast<double>(i);
    t.t_s.push_back(0.001 * static_cast<double>(t.t_s.size()));
    t.command_mm.push_back((1 - u) * whole.trace.command_mm[i] + u * whole.trace.command_mm[i + 1]);
    t.actual_mm.push_back((1 - u) * whole.trace.actual_mm[i] + u * whole.trace.actual_mm[i + 1]);
    t.line.push_back(whole.trace.line[i]);
    at += i >= from && i < end ? fraction : 1.0;
  }
  return run;
}

TEST(TraceCheck, NamesOverrides) {
  EXPECT_EQ(said(at_override(0.8, 0, 1000000)),
            "the axes hold 1200.0 mm/min in line 1 of steps.nc, which is programmed with F1500: an override of 80 %; a "
            "trace at 100 % was expected [trace-override]");
  EXPECT_EQ(
      said(at_override(1.2, 0, 1000000)),
      "the axes hold 1800.0 mm/min in line 1 of steps.nc, which is programmed with F1500: an override of 120 %; a "
      "trace at 100 % was expected [trace-override]");
  EXPECT_EQ(said(at_override(0.6, 1250, 1500)),
            "the axes hold 900.0 mm/min in line 2 of steps.nc, which is programmed with F1500: an override of 60 %; a "
            "trace at 100 % was expected [trace-override]");
}

TEST(TraceCheck, NamesAFeedHold) {
  FeedRun run = run_of(steps());
  ServoTrace& t = run.trace;
  const auto hold = [](auto& v) { v.insert(v.begin() + 400, 900, v[400]); };
  hold(t.command_mm), hold(t.actual_mm), hold(t.line), hold(t.row);
  while (t.t_s.size() < t.line.size()) t.t_s.push_back(t.t_s.back() + 0.001);
  EXPECT_EQ(said(run),
            "the axes stand still for 0.90 s inside line 1 of steps.nc: a feed hold; a trace without one was expected "
            "[trace-override]");
}

}  // namespace
}  // namespace camber::calib
