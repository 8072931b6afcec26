// What is held out is never fitted: the numbers stay the same to the last bit, whatever the parts held out say.
#include <gtest/gtest.h>

#include "calib/fit_limits.h"
#include "tests/support/feed_runs.h"

namespace camber::calib {
namespace {

/// Commanded times of every part of the figures; every third one is held out.
TimedLines timed(const nc::Interpretation& program, const machine::Machine& machine) {
  TimedLines lines;
  lines.program = &program;
  lines.parts = parts_of(program);
  for (std::size_t i = 0; i < lines.parts.size(); ++i) {
    lines.kept_back.push_back(i % 3 == 2);
    lines.group.push_back(static_cast<int>(i));
  }
  lines.step_s = machine.control.period_s;
  lines.time_s.resize(lines.parts.size());
  lines.time_s = planned_times_s(lines, machine, feedmodel::plan_motion(program, machine));
  return lines;
}

TEST(HeldOut, PartsChangeNoNumberOfTheLimits) {
  const machine::Machine known = tests::known_machine();
  const nc::Interpretation program = tests::figures();
  const TimedLines right = timed(program, known);
  TimedLines wrong = right;
  for (std::size_t i = 0; i < wrong.parts.size(); ++i)
    if (wrong.kept_back[i]) wrong.time_s[i] *= 1.5;
  machine::Machine start = known;
  for (machine::Axis& axis : start.axis) axis.acceleration_mm_per_s2 = 300;
  const auto fit = [&](const TimedLines& lines) {
    return fit_limits({lines}, start, limit_parameters(start), 15, true);
  };
  const LimitFit a = fit(right), b = fit(wrong);
  ASSERT_EQ(a.parameters.size(), b.parameters.size());
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    EXPECT_EQ(a.parameters[i].fitted.value, b.parameters[i].fitted.value) << a.parameters[i].name;
    EXPECT_EQ(a.parameters[i].fitted.std_error, b.parameters[i].fitted.std_error) << a.parameters[i].name;
  }
  EXPECT_EQ(a.fitted_cost, b.fitted_cost);
  EXPECT_GT(b.held_out_cost, 10 * a.held_out_cost + 10);
  EXPECT_NEAR(a.machine.axis[0].acceleration_mm_per_s2, known.axis[0].acceleration_mm_per_s2, 0.1 * 900);
}

}  // namespace
}  // namespace camber::calib
