// camber time against the traces of a real control.
#include "calib/cycle_accuracy.h"

#include <cstdlib>

#include <gtest/gtest.h>

#include "test_paths.h"
#include "tests/support/accuracy_figure.h"
#include "tests/support/nc_program.h"
#include "tests/support/test_data.h"

namespace camber::calib {
namespace {

CycleAccuracy accuracy_of(const std::string& name) {
  Diagnostics diagnostics;
  const machine::Machine machine =
      machine::read_machine(CAMBER_SOURCE_DIR "/samples/machines/linuxcnc_fitted.toml", diagnostics);
  const nc::Interpretation program =
      tests::interpreted(SourceText::read(tests::data_path("linuxcnc/programs/" + name + ".ngc")).text(), {});
  return cycle_accuracy(read_trace(tests::unpacked_data("linuxcnc/" + name + "_a.csv"), diagnostics), program,
                        feedmodel::cycle_time(program, machine));
}

/// The paper's own comparison has errors of -2.79, -2.94 and -1.02 % (table 1a) on a program of long arcs, one of tiny
/// blocks and a mixed one. Ours, on programs of the same kinds: within the same 3 %.
TEST(YanShirase, A11_TimeWithinThreePerCentOfTheMachine) {
  for (const char* name : {"arcs_g64", "shortblocks_g64", "dense_g64"}) {
    const CycleAccuracy a = accuracy_of(name);
    ASSERT_TRUE(a.has_lines) << name;
    EXPECT_GT(a.total.measured_s, 10) << name;
    EXPECT_LT(std::abs(a.total.error_percent()), 3) << name;
    tests::record_figure(std::string("total time, ") + name, a.total.error_percent(), 3);
    tests::record_figure(std::string("cutting time, ") + name, a.cutting.error_percent(), 1);
    EXPECT_LT(std::abs(a.cutting.error_percent()), 1) << name;
    EXPECT_LT(std::abs(a.positioning.error_percent()), 3) << name;
    EXPECT_GT(a.parts.size(), 3u) << name;
  }
}

TEST(YanShirase, A11_ErrorsAreCountedLikeTheirs) {
  EXPECT_NEAR((TimePair{.measured_s = 100, .predicted_s = 97.21}.error_percent()), -2.79, 1e-9);
  EXPECT_EQ((TimePair{}.error_percent()), 0);
}

TEST(CycleAccuracy, AttributesMeasuredTimeToTheLinesThatRan) {
  const nc::Interpretation program = tests::interpreted("G0 X10\nG1 X20 F600\nG4 P2\nG1 X30\n");
  ServoTrace trace;
  trace.period_s = 0.5;
  // 1 s of rapid, 1.5 s of line 2, 2 s of waiting without a line, 1 s of line 4, and rests before and after.
  const double x[] = {0, 0, 5, 10, 13, 16, 20, 20, 20, 20, 20, 25, 30, 30};
  const std::uint32_t line[] = {0, 1, 1, 2, 2, 2, 0, 0, 0, 0, 4, 4, 0, 0};
  for (std::size_t k = 0; k < std::size(x); ++k) {
    trace.t_s.push_back(0.5 * static_cast<double>(k));
    trace.command_mm.push_back({x[k], 0, 0});
    trace.line.push_back(line[k]);
  }
  trace.has_command = {true, false, false};
  const CycleAccuracy a = cycle_accuracy(trace, program, feedmodel::cycle_time(program, machine::Machine{}));
  EXPECT_DOUBLE_EQ(a.total.measured_s, 5.5);
  EXPECT_DOUBLE_EQ(a.positioning.measured_s, 1);
  EXPECT_DOUBLE_EQ(a.cutting.measured_s, 2.5);
  EXPECT_DOUBLE_EQ(a.dwell.measured_s, 2);
  EXPECT_NEAR(a.cutting.predicted_s, 2, 0.01);
  EXPECT_NEAR(a.dwell.predicted_s, 2, 1e-9);
}

}  // namespace
}  // namespace camber::calib
