// Limits of linear and rotary axes from the trace of a program with rotary motion.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "base/units.h"
#include "calib/feed_accuracy.h"
#include "calib/fit_feed_model.h"
#include "feedmodel/timed_path.h"
#include "kinematics/control_options.h"
#include "kinematics/program_joints.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"
#include "test_paths.h"

namespace camber::calib {
namespace {

constexpr double kLimitFraction = 0.08;  // times of these short parts are known to a period of 1 ms

/// Positionings of each linear axis, far enough to show its acceleration and too short for its top speed, between
/// blocks in which A or C is what limits.
std::string positionings_and_turns() {
  std::string text = "G21 G90 G94 G64\nG10 L2 P1 X0 Y0 Z0\nG54\nT1 M6\nG43 H1\nG0 X0 Y0 Z0 A0 C0\nG4 P0.2\n";
  const double places[] = {3, 0, 6, 1, 9, 2, 12, 0};
  for (int i = 0; i < 8; ++i) {
    const double at = places[i];
    text += fmt::format("G0 X{}\nG0 Y{} Z{}\nG4 P0.1\nG0 Z{}\nX{} Y{}\nG4 P0.1\n", at, at, -at, 1 - at, at + 1, at - 1);
    text += fmt::format("G1 X{} Z{} A{} F2000\nX{} A{}\nX{} Z{} A{}\nG4 P0.1\nG1 Y{} C{} F3000\nY{} Z{} C{}\nG4 P0.1\n",
                        at + 1, -at, 3 * at + 2, at, at, at + 2, 2 - at, at + 9, at + 2, 5 * at + 4, at, at, 2 * at);
  }
  return text + "M30\n";
}

FeedRun traced(const machine::Machine& machine, const std::string& text) {
  Diagnostics diagnostics;
  const nc::Program program = nc::read_program(SourceText("turns.nc", text), diagnostics);
  nc::InterpreterOptions options;
  options.rotary_axes = kinematics::rotary_options(machine);
  options.tool_offsets[1].length_mm = 80;
  FeedRun run{"turns", nc::interpret(program, kinematics::interpreter_options(machine, options), diagnostics), {}};
  ServoTrace& trace = run.trace;
  trace.period_s = machine.control.period_s;
  trace.has_command = trace.has_actual = {true, true, true};
  trace.has_rotary_command = trace.has_rotary_actual = {true, false, true};
  feedmodel::predict_joints(run.program, machine, [&](auto samples, auto joints) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      trace.t_s.push_back(samples[i].t_s);
      trace.command_mm.push_back(samples[i].command_mm);
      trace.actual_mm.push_back(samples[i].position_mm);
      trace.rotary_command_deg.push_back(deg_from_rad(1) * joints[i].command_rad);
      trace.rotary_actual_deg.push_back(deg_from_rad(1) * joints[i].position_rad);
      trace.line.push_back(run.program.moves[samples[i].move].block + 1);
    }
  });
  trace.stretches = {{0, trace.t_s.size()}};
  return run;
}

TEST(FitFiveAxes, PositioningsTellTheAccelerationsOfLinearAxes) {
  Diagnostics diagnostics;
  machine::Machine known =
      machine::read_machine(CAMBER_SOURCE_DIR "/samples/machines/linuxcnc_five_axis.toml", diagnostics);
  machine::Machine start = known;
  start.control.stop_acceleration_fraction = machine::Control{}.stop_acceleration_fraction;
  for (machine::Axis& axis : start.axis) {
    axis.acceleration_mm_per_s2 = machine::Axis{}.acceleration_mm_per_s2;
    axis.position_gain_per_s = machine::kNoLimit;
    axis.velocity_lag_s = 0;
  }
  for (machine::RotaryAxis& axis : start.rotary) axis.position_gain_per_s = machine::kNoLimit, axis.velocity_lag_s = 0;
  const FitFeedResult fit = fit_feed({traced(known, positionings_and_turns())}, start, {});
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(fit.machine.axis[i].acceleration_mm_per_s2 / known.axis[i].acceleration_mm_per_s2, 1, kLimitFraction)
        << i;
  EXPECT_NEAR(fit.machine.control.stop_acceleration_fraction, 0.5, 0.5 * kLimitFraction);
  for (const std::size_t i : {0U, 2U}) {
    EXPECT_NEAR(fit.machine.rotary[i].position_gain_per_s, known.rotary[i].position_gain_per_s, 0.1) << i;
    EXPECT_NEAR(fit.machine.rotary[i].velocity_lag_s, known.rotary[i].velocity_lag_s, 1e-4) << i;
  }
}

/// Lines of X Y Z, lines that turn as well and lines that only turn: all have a time at their programmed feed.
TEST(FitFiveAxes, ConstantFeedIsThatOfWhatFCounts) {
  Diagnostics diagnostics;
  const machine::Machine machine =
      machine::read_machine(CAMBER_SOURCE_DIR "/samples/machines/linuxcnc_five_axis.toml", diagnostics);
  const std::string text =
      "G21 G90 G94 G64\nG0 X0 Y0 Z0 A0 C0\nG4 P0.1\nG1 A20 F600\nG4 P0.1\nG1 X30 C9 F1200\n"
      "G4 P0.1\nG93 G1 X0 C0 F20\nC30 F15\nM2\n";
  const FeedRun run = traced(machine, text);
  const auto parts = parts_of(run.program, machine);
  ASSERT_EQ(parts.size(), 4U);
  const FeedAccuracy constant = constant_feed_accuracy(run.trace, run.program, machine, parts, {});
  ASSERT_EQ(constant.parts.size(), 4U);
  EXPECT_NEAR(constant.parts[0].time_model_s, 20.0 / 10, 1e-9);
  EXPECT_NEAR(constant.parts[1].time_model_s, 30.0 / 20, 1e-9);
  EXPECT_NEAR(constant.parts[2].time_model_s, 60.0 / 20, 1e-9);
  EXPECT_NEAR(constant.parts[3].time_model_s, 60.0 / 15, 1e-9);
  for (const PartAccuracy& part : constant.parts) {
    EXPECT_GT(part.speed_rms_percent, 0);
    EXPECT_LT(part.speed_rms_percent, 50);
  }
}

}  // namespace
}  // namespace camber::calib
