#include "calib/fit_feed_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "feedmodel/timed_path.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"
#include "test_paths.h"
#include "tests/support/feed_runs.h"
#include "tests/support/test_data.h"
#include "tests/support/test_program.h"

namespace camber::calib {
namespace {

using tests::figures;
using tests::known_machine;
using tests::synthetic_run;

double value_of(const FitFeedResult& result, const std::string& name) {
  for (const FitParameter& p : result.parameters)
    if (p.name == name) return p.value;
  ADD_FAILURE() << "no parameter " << name;
  return NAN;
}

constexpr double kLimitFraction = 0.03;  // block times are known to a period of 1 ms
constexpr double kDriveFraction = 1e-3;

TEST(FitFeed, GivesTheParametersOfASyntheticMachineBack) {
  const machine::Machine known = known_machine();
  machine::Machine start;
  start.control.kind = known.control.kind;
  start.control.corner = {.law = machine::CornerLaw::blend, .tolerance_mm = 0.01};
  const FitFeedResult fit = fit_feed({synthetic_run(known)}, start, {});
  EXPECT_TRUE(fit.converged) << fit.message;
  for (int i = 0; i < 3; ++i) {
    const machine::Axis &is = fit.machine.axis[i], &was = known.axis[i];
    EXPECT_NEAR(is.acceleration_mm_per_s2 / was.acceleration_mm_per_s2, 1, kLimitFraction) << i;
    EXPECT_NEAR(is.position_gain_per_s / was.position_gain_per_s, 1, kDriveFraction) << i;
    EXPECT_NEAR(is.velocity_lag_s / was.velocity_lag_s, 1, kDriveFraction) << i;
  }
  EXPECT_NEAR(fit.machine.control.arc_normal_fraction, 0.8, 0.8 * kLimitFraction);
  EXPECT_TRUE(std::isinf(value_of(fit, "axis.x.max_velocity_mm_per_min")));  // no rapid shows it: not invented
  EXPECT_LT(fit.held_out.part_time_percent, 1.0);
  EXPECT_LT(fit.held_out.speed_rms_percent, 2.0);
}

TEST(FitFeed, SaysWhatATraceOfOneAxisDoesNotTell) {
  tests::TestProgram p;
  for (int i = 1; i < 12; ++i) p.line(i % 2 ? 10 : 0, 0, 0, 500.0 * i).dwell(0.1);
  machine::Machine known = known_machine();
  FeedRun run = synthetic_run(known);
  run.program = p.program;
  run.trace = {};
  run.trace.period_s = 0.001;
  run.trace.has_command = run.trace.has_actual = {true, true, true};
  feedmodel::predict_feed(run.program, known, [&](std::span<const feedmodel::TimedSample> samples) {
    for (const feedmodel::TimedSample& s : samples) {
      run.trace.t_s.push_back(s.t_s);
      run.trace.command_mm.push_back(s.command_mm);
      run.trace.actual_mm.push_back(s.position_mm);
      run.trace.line.push_back(s.feed_command_mm_per_s > 0 ? run.program.moves[s.move].block + 1 : 0);
    }
  });
  run.trace.stretches = {{0, run.trace.t_s.size()}};
  const FitFeedResult fit = fit_feed({run}, known, {});
  for (const FitParameter& parameter : fit.parameters) {
    if (parameter.name != "axis.z.acceleration_mm_per_s2") continue;
    EXPECT_FALSE(parameter.std_error);
    EXPECT_FALSE(parameter.written);
    EXPECT_DOUBLE_EQ(fit.machine.axis[2].acceleration_mm_per_s2, 450);
  }
}

// --- a real control -------------------------------------------------------------------------------------------

FeedRun real_run(const std::string& name) {
  Diagnostics diagnostics;
  const nc::Program program =
      nc::read_program(SourceText::read(tests::data_path("linuxcnc/programs/" + name + ".ngc")), diagnostics);
  FeedRun run;
  run.program_name = name;
  run.program = nc::interpret(program, {}, diagnostics);
  run.trace = read_trace(tests::unpacked_data("linuxcnc/" + name + "_a.csv"), diagnostics);
  return run;
}

/// Fitted on all seven (bench/feed/held-out predicts each by a fit on the others). dense_g64 has five parts, of which
/// one is 3 % off.
TEST(FitFeed, PredictsTheTracedControl) {
  Diagnostics diagnostics;
  const machine::Machine fitted =
      machine::read_machine(CAMBER_SOURCE_DIR "/samples/machines/linuxcnc_fitted.toml", diagnostics);
  for (const std::string name : {"protocol_xy_g61", "protocol_xy_g64", "protocol_yz_g64", "protocol_zx_g64", "arcs_g64",
                                 "shortblocks_g64", "dense_g64"}) {
    const FeedRun run = real_run(name);
    const FeedAccuracy a = feed_accuracy(run.trace, run.program, fitted,
                                         read_parts(tests::data_path("linuxcnc/programs/" + name + ".parts.csv")), {});
    printf(
        "%-16s time %8.2f s traced, %8.2f s predicted (%+.2f %%); parts %.2f %%; path speed rms %.2f %%, p95 %.2f %%\n",
        name.c_str(), a.time_trace_s, a.time_model_s, a.time_error_percent, a.part_time_error_percent,
        a.speed_rms_percent, a.speed_p95_percent);
    EXPECT_LT(std::abs(a.time_error_percent), 1.0) << name;
    EXPECT_LT(a.part_time_error_percent, name == "dense_g64" ? 1.0 : 0.5) << name;
    EXPECT_LT(a.speed_rms_percent, 3.0) << name;
    EXPECT_LT(a.speed_p95_percent, 8.0) << name;
  }
}

TEST(FitFeed, FitsTheSamplesTrace) {
  const std::string folder = CAMBER_SOURCE_DIR "/samples/01-finishing/";
  Diagnostics diagnostics;
  FeedRun run;
  run.program =
      nc::interpret(nc::read_program(SourceText::read(folder + "trace_program.nc"), diagnostics), {}, diagnostics);
  run.trace = read_trace(folder + "trace.csv", diagnostics);
  // What the command starts from: the file as shipped, and the same without its limits.
  machine::Machine start = machine::read_machine(folder + "machine.toml", diagnostics);
  for (const bool shipped : {true, false}) {
    if (!shipped)
      for (machine::Axis& axis : start.axis) axis = {};
    const FitFeedResult fit = fit_feed({run}, start, {});
    EXPECT_TRUE(fit.converged) << fit.message;
    const double z = fit.machine.axis[2].acceleration_mm_per_s2;
    printf("sample 01, %s: Z %.2f mm/s2, held out %.3f %% of the time\n", shipped ? "as shipped" : "without limits", z,
           fit.held_out.part_time_percent);
    EXPECT_NEAR(z, 400, 8);
    // Plunges of 0.2 s are parts: a millisecond is half a percent of them.
    EXPECT_LT(fit.held_out.part_time_percent, 0.3);
    EXPECT_LT(fit.held_out.speed_rms_percent, 1.0);
    for (const DriveFit& drive : fit.drives) EXPECT_LT(drive.held_out_rms_mm, 0.002);
  }
}

}  // namespace
}  // namespace camber::calib
