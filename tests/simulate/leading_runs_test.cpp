// A prediction that goes on from what the first tools of another path have left, against one of the whole path.
#include <string>

#include <gtest/gtest.h>

#include "simulate/predict_path.h"

namespace camber::simulate {
namespace {

/// A flat tool of 6 mm takes the step off, one of 5 mm finishes its wall.
machine::Job step_job() {
  machine::Job job;
  job.program = "p.nc";
  for (const int number : {1, 2}) {
    machine::Tool tool;
    tool.number = number;
    tool.type = machine::ToolType::flat;
    tool.diameter_mm = number == 1 ? 6 : 5;
    tool.overhang_mm = 30;
    tool.root_stiffness_N_per_mm = 5000;
    job.tools[number] = tool;
  }
  job.material = {2000, 700, 0, 15, 15, 0};
  job.stock.box = {{0, 0, -2}, {4, 9, 0}};
  return job;
}

std::string step(double rough_y, double wall_y) {
  return "G21 G90 G17\nT1 M6\nS3000 M3\nG0 X-5 Y" + std::to_string(rough_y) +
         " Z5\nG0 Z-1.5\nG1 X9 F400\nG0 Z5\nT2 M6\nS3000 M3\nG0 X-5 Y" + std::to_string(wall_y) +
         "\nG0 Z-1.5\nG1 X9 F300\nG0 Z5\nM30\n";
}

SimulatedProgram motion(const machine::Job& job, const std::string& text) {
  Diagnostics diagnostics;
  return motion::simulate_motion(SourceText("p.nc", text), job, {}, diagnostics);
}

void expect_same(const Prediction& a, const Prediction& b) {
  ASSERT_EQ(a.surface.size(), b.surface.size());
  for (std::size_t i = 0; i < a.surface.size(); ++i) {
    ASSERT_EQ(a.surface[i].error_mm, b.surface[i].error_mm);
    ASSERT_EQ(a.surface[i].machined_stamp, b.surface[i].machined_stamp);
  }
  ASSERT_EQ(a.cut.loads.size(), b.cut.loads.size());
  for (std::size_t k = 0; k < a.cut.loads.size(); ++k) {
    ASSERT_EQ(a.cut.loads[k].force_max_N, b.cut.loads[k].force_max_N);
    ASSERT_EQ(a.cut.loads[k].chip_mm3, b.cut.loads[k].chip_mm3);
  }
  EXPECT_EQ(a.cut.chip_mm3, b.cut.chip_mm3);
  EXPECT_EQ(a.cut.stock_mm3, b.cut.stock_mm3);
  EXPECT_EQ(a.form_error_um.p95, b.form_error_um.p95);
  EXPECT_EQ(a.machined->volume_mm3(), b.machined->volume_mm3());
}

class LeadingRunsTest : public ::testing::Test {
 protected:
  LeadingRunsTest() { leading.runs = 1; }

  Prediction going_on(const SimulatedProgram& program) {
    PredictOptions options;
    options.leading = &leading;
    return predict(job, target, program, options);
  }
  Prediction whole(const SimulatedProgram& program) const { return predict(job, target, program, {}); }

  machine::Job job = step_job();
  SimulatedProgram given = motion(job, step(3, 2.4));
  Diagnostics diagnostics;
  Target target = make_target(job, given, diagnostics);
  LeadingRuns leading;
};

TEST_F(LeadingRunsTest, GiveWhatTheWholePathGives) {
  const SimulatedProgram shifted = motion(job, step(3, 2.43));
  ASSERT_EQ(given.path.runs.size(), 2u);
  expect_same(going_on(given), whole(given));
  ASSERT_TRUE(leading.cut.has_value());
  EXPECT_EQ(leading.cut->stamps.size(), given.path.runs[0].count);
  EXPECT_TRUE(leading.begin(shifted.path));
  const Prediction expected = whole(shifted);
  for (int again = 0; again < 2; ++again) expect_same(going_on(shifted), expected);
}

TEST_F(LeadingRunsTest, OfAnotherPathAreCutAnew) {
  const SimulatedProgram shifted = motion(job, step(3.1, 2.4));
  going_on(given);
  EXPECT_FALSE(leading.begin(shifted.path));
  expect_same(going_on(shifted), whole(shifted));
  EXPECT_TRUE(leading.begin(shifted.path)) << "kept instead";
}

}  // namespace
}  // namespace camber::simulate
