#include "calib/block_time.h"

#include <gtest/gtest.h>

#include "feedmodel/timed_path.h"
#include "tests/support/test_program.h"

namespace camber::calib {
namespace {

/// Lines along X, 200 of each length.
nc::Interpretation chords(const std::vector<double>& lengths, double feed) {
  tests::TestProgram p;
  double x = 0;
  for (double length : lengths) {
    for (int i = 0; i < 200; ++i) p.line(x += length, 0, 0, feed);
    p.dwell(0.1);
  }
  return p.program;
}

ServoTrace run_on(const machine::Machine& machine, const nc::Interpretation& program) {
  ServoTrace trace;
  feedmodel::predict_feed(program, machine, [&](std::span<const feedmodel::TimedSample> samples) {
    for (const feedmodel::TimedSample& s : samples) {
      trace.t_s.push_back(s.t_s);
      trace.command_mm.push_back(s.command_mm);
      trace.actual_mm.push_back(s.position_mm);
      trace.line.push_back(s.feed_command_mm_per_s > 0 ? program.moves[s.move].block + 1 : 0);
    }
  });
  set_stretches(trace);
  return trace;
}

machine::Machine machine_of(double block_time_s) {
  machine::Machine m;
  m.control.block_time_s = block_time_s;
  m.control.corner.law = machine::CornerLaw::angle;
  for (machine::Axis& axis : m.axis) axis.acceleration_mm_per_s2 = 4000;
  return m;
}

TEST(BlockTime, IsFoundWhereTwoLengthsAgree) {
  const nc::Interpretation program = chords({1.0, 0.3, 0.1, 0.03, 0.01}, 10000);
  const ServoTrace trace = run_on(machine_of(0.004), program);
  const BlockTimeFit fit = fit_block_time({{&program, &trace}});
  ASSERT_TRUE(fit.block_time_s) << fit.message;
  EXPECT_NEAR(fit.block_time_s->value, 0.004, 0.004 * 0.02);
  EXPECT_LT(std::abs(fit.block_time_s->value - 0.004), 3 * fit.block_time_s->std_error + 1e-5);
  ASSERT_EQ(fit.runs.size(), 5u);
  EXPECT_FALSE(fit.runs[0].saturated);
  EXPECT_TRUE(fit.runs[4].saturated);
}

TEST(BlockTime, SaysWhyItTellsNothing) {
  const nc::Interpretation one = chords({0.03}, 10000), slow = chords({1, 0.3}, 600);
  const ServoTrace of_one = run_on(machine_of(0.004), one), of_slow = run_on(machine_of(0.004), slow);
  const BlockTimeFit single = fit_block_time({{&one, &of_one}});
  EXPECT_FALSE(single.block_time_s);
  EXPECT_EQ(single.message,
            "lines of 0.03 mm alone are slower than their feed: another limit could be the cause; run the saturation "
            "program of camber protocol, which has more lengths");
  const BlockTimeFit reached = fit_block_time({{&slow, &of_slow}});
  EXPECT_FALSE(reached.block_time_s);
  EXPECT_EQ(reached.message,
            "every run of lines of one length reaches its feed: the block time is too short to show in these programs");
}

}  // namespace
}  // namespace camber::calib
