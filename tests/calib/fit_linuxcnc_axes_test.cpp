// Limits of five axes from traces of a real control (data/linuxcnc5), and what they predict of a trace that the fit
// has not seen. bench/feed/held-out does so for all twelve.
#include <gtest/gtest.h>

#include <string>

#include "base/units.h"
#include "calib/feed_accuracy.h"
#include "calib/fit_acceleration.h"
#include "calib/fit_feed_model.h"
#include "kinematics/control_options.h"
#include "kinematics/joint_map.h"
#include "kinematics/machine_moves.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

namespace camber::calib {
namespace {

/// The chain of the machine and nothing of what it does.
machine::Machine machine_without_limits() {
  const tests::TempFolder folder;
  Diagnostics diagnostics;
  return machine::read_machine(folder.write("start.toml", R"([control]
dialect = "linuxcnc"
corner = { law = "blend", tolerance_mm = inf }
[kinematics]
chain = ["part", "c", "a", "bed", "x", "y", "z", "spindle"]
[axis.a]
direction = [1, 0, 0]
point_mm = [25, -8.5, -70]
positive = "table"
[axis.c]
direction = [0, 0, 1]
point_mm = [25, -15, -40]
positive = "table"
)"),
                               diagnostics);
}

FeedRun control_run(const std::string& name, const machine::Machine& machine) {
  Diagnostics diagnostics;
  const nc::Program program =
      nc::read_program(SourceText::read(tests::data_path("linuxcnc5/programs/" + name + ".ngc")), diagnostics);
  nc::InterpreterOptions options;
  options.rotary_axes = kinematics::rotary_options(machine);
  options.tool_offsets[1].length_mm = 80;
  FeedRun run{name, nc::interpret(program, kinematics::interpreter_options(machine, options), diagnostics),
              read_trace(tests::unpacked_data("linuxcnc5/" + name + "_t.csv"), diagnostics)};
  if (kinematics::has_rotary_motion(run.program, machine)) kinematics::place_moves(run.program, machine);
  return run;
}

TEST(FitLinuxcncAxes, RampsOnTheExactPathShowTheLimitsThatTheyReach) {
  const machine::Machine machine = machine_without_limits();
  const auto held = held_accelerations({control_run("combined_g94_g61", machine)});
  EXPECT_NEAR(held[0].value, 700, 0.7);
  EXPECT_EQ(held[1].value, 0);  // Y is limited by another axis wherever it moves
  EXPECT_NEAR(held[2].value, 420, 0.4);
  EXPECT_NEAR(held[3].value, 260, 0.3);
  EXPECT_EQ(held[4].value, 0);
  EXPECT_NEAR(held[5].value, 600, 0.6);
  // Overlapping blocks add up to half as much again: nothing is taken from them.
  for (const FittedValue& value : held_accelerations({control_run("rotary_g64", machine)})) EXPECT_EQ(value.value, 0);
}

TEST(FitLinuxcncAxes, TwoTracesWithoutTipControlPredictOneWithIt) {
  const machine::Machine start = machine_without_limits();
  const FitFeedResult fit =
      fit_feed({control_run("combined_g94_g61", start), control_run("rotary_g64", start)}, start, {});
  EXPECT_TRUE(fit.converged) << fit.message;
  EXPECT_NEAR(fit.machine.control.stop_acceleration_fraction, 0.5, 0.002);
  EXPECT_NEAR(deg_from_rad(fit.machine.rotary[0].acceleration_rad_per_s2), 260, 0.3);
  EXPECT_NEAR(deg_from_rad(fit.machine.rotary[2].acceleration_rad_per_s2), 600, 0.6);

  const FeedRun unseen = control_run("tcp_sphere_normal_g64", start);
  const FeedAccuracy accuracy =
      feed_accuracy(unseen.trace, unseen.program, fit.machine, parts_of(unseen.program, fit.machine), {});
  ASSERT_EQ(accuracy.parts.size(), 5U);
  for (const PartAccuracy& part : accuracy.parts) {
    EXPECT_NEAR(part.time_model_s / part.time_trace_s, 1, 0.005) << "lines from " << part.part.line_first;
    EXPECT_LT(part.speed_rms_percent, 3) << "lines from " << part.part.line_first;
  }
}

}  // namespace
}  // namespace camber::calib
