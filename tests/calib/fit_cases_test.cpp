// Recordings of a real control (shared data) of which fits once went wrong, each for one reason.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include <fmt/format.h>

#include "base/units.h"
#include "calib/fit_feed_model.h"
#include "kinematics/control_options.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

namespace camber::calib {
namespace {

class FitCase : public ::testing::Test {
 protected:
  machine::Machine start(const std::string& file) {
    Diagnostics diagnostics;
    return machine::read_machine(data_ + file, diagnostics);
  }

  /// `every`: keeps every n-th sample.
  FeedRun run(const machine::Machine& machine, const std::string& program, const std::string& trace, int every = 1,
              double tool_length_mm = 60) {
    std::string csv = tests::unpacked_data(trace);
    if (every > 1) {
      std::ifstream in(csv);
      csv = folder_ / "trace.csv";
      std::ofstream out(csv);
      std::string row;
      for (int number = 1; std::getline(in, row); ++number)
        if (number == 1 || number % every == 0) out << row << '\n';
    }
    Diagnostics diagnostics;
    nc::InterpreterOptions options;
    options.rotary_axes = kinematics::rotary_options(machine);
    options.tool_offsets[1].length_mm = tool_length_mm;
    FeedRun out;
    out.program_name = program;
    out.program = nc::interpret(nc::read_program(SourceText::read(data_ + program), diagnostics),
                                kinematics::interpreter_options(machine, options), diagnostics);
    out.trace = read_trace(csv, diagnostics);
    return out;
  }

  const std::string data_ = tests::data_path("") + "/";
  tests::TempFolder folder_;
};

const FitParameter& parameter(const FitFeedResult& fit, const std::string& name) {
  for (const FitParameter& p : fit.parameters)
    if (p.name == name) return p;
  throw std::runtime_error("no parameter " + name);
}

TEST_F(FitCase, VelocityFeedForward) {
  const std::string folder = "cases/fitfeed_feedforward/";
  const machine::Machine machine = start(folder + "start.toml");
  const FitFeedResult fit = fit_feed({run(machine, folder + "program.ngc", folder + "trace.csv")}, machine, {});
  const double gain[] = {31, 37, 26}, forward[] = {50, 40, 55}, lag_s[] = {0.0035, 0.0045, 0.005};
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(fit.machine.axis[i].position_gain_per_s / gain[i], 1, 0.02) << i;
    EXPECT_NEAR(fit.machine.axis[i].feed_forward_percent / forward[i], 1, 0.02) << i;
    EXPECT_NEAR(fit.machine.axis[i].velocity_lag_s / lag_s[i], 1, 0.02) << i;
    EXPECT_LT(fit.drives[i].held_out_rms_mm, 0.0002) << i;
    EXPECT_EQ(fit.machine.axis[i].filter_s, 0) << i;
  }
  EXPECT_NEAR(fit.machine.rotary[0].position_gain_per_s / 22, 1, 0.02);
  EXPECT_NEAR(fit.machine.rotary[2].position_gain_per_s / 34, 1, 0.02);
  for (const FitParameter& p : fit.parameters) {
    const bool gain = p.name.find("gain") != p.name.npos && p.written && p.std_error;
    EXPECT_TRUE(!gain || *p.std_error < 0.3 * p.value) << p.name;
  }
}

TEST_F(FitCase, TopSpeedThatAnOverlapExceeds) {
  const std::string folder = "cases/fitfeed_topspeed/";
  const machine::Machine machine = start(folder + "start.toml");
  const FitFeedResult fit = fit_feed({run(machine, folder + "exact_path.ngc", folder + "exact_path.csv"),
                                      run(machine, folder + "blended.ngc", folder + "blended.csv")},
                                     machine, {});
  EXPECT_NEAR(parameter(fit, "axis.a.max_velocity_deg_per_min").value, 1920, 0.005 * 1920);
  EXPECT_NEAR(parameter(fit, "axis.c.max_velocity_deg_per_min").value, 4800, 0.005 * 4800);
  for (const RunAccuracy& one : fit.runs) EXPECT_LT(std::abs(one.accuracy.time_error_percent), 0.5) << one.program_name;
}

TEST_F(FitCase, RapidsInWhichAnotherAxisIsAtItsLimit) {
  const std::string folder = "cases/fitfeed_rapid_share/";
  const machine::Machine machine = start(folder + "start.toml");
  const FitFeedResult fit = fit_feed({run(machine, folder + "program.ngc", folder + "trace.csv")}, machine, {});
  EXPECT_FALSE(parameter(fit, "axis.z.max_velocity_mm_per_min").written);
  EXPECT_TRUE(std::isinf(fit.machine.axis[2].max_velocity_mm_per_s));
  EXPECT_NEAR(parameter(fit, "axis.c.max_velocity_deg_per_min").value, 4800, 24);
  for (const machine::Axis& axis : fit.machine.axis) EXPECT_EQ(axis.filter_s, 0);
}

TEST_F(FitCase, ExactPathAlone) {
  const std::string folder = "cases/fitfeed_crash/";
  const machine::Machine machine = start(folder + "start.toml");
  const FitFeedResult fit = fit_feed({run(machine, folder + "program.ngc", folder + "trace.csv", 1, 80)}, machine, {});
  EXPECT_TRUE(fit.converged) << fit.message;
  EXPECT_NEAR(fit.machine.axis[0].acceleration_mm_per_s2, 700, 7);
  EXPECT_NEAR(deg_from_rad(fit.machine.rotary[2].acceleration_rad_per_s2), 600, 6);
  EXPECT_FALSE(parameter(fit, "control.stop_acceleration_share").written);
}

TEST_F(FitCase, EverySecondCycle) {
  machine::Machine machine = start("cases/fitfeed_decimated/start_p1.toml");
  const std::string programs = "linuxcnc5/programs/", traces = "linuxcnc5/";
  std::vector<FeedRun> runs;
  for (const std::string name : {"rotary_g61", "rotary_g64", "combined_g94_g61", "combined_g94_g64"})
    runs.push_back(run(machine, programs + name + ".ngc", traces + name + "_t.csv", 2, 80));
  const FitFeedResult fit = fit_feed(runs, machine, {});
  EXPECT_DOUBLE_EQ(fit.machine.control.period_s, 0.001);
  EXPECT_NEAR(fit.machine.control.block_time_s, 0.00102, 1e-6);
  const FitParameter& y = parameter(fit, "axis.y.acceleration_mm_per_s2");
  EXPECT_TRUE(!y.written || std::abs(y.value - 560) < 0.03 * 560) << y.value;
}

}  // namespace
}  // namespace camber::calib
