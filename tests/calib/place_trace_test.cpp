// Traces without lines, and pieces of runs, on the path of their program.
#include "calib/place_trace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/fit_feed_model.h"
#include "calib/fit_limits.h"
#include "calib/line_speeds.h"
#include "tests/support/feed_runs.h"
#include "tests/support/synthetic_control.h"

namespace camber::calib {
namespace {

using tests::known_machine;
using tests::synthetic_run;

ServoTrace piece_of_trace(const ServoTrace& whole, std::size_t first, std::size_t end, std::size_t every) {
  ServoTrace t;
  t.has_command = t.has_actual = {true, true, true};
  for (std::size_t k = first; k < std::min(end, whole.size()); k += every) {
    t.t_s.push_back(whole.t_s[k]);
    t.command_mm.push_back(whole.command_mm[k]);
    t.actual_mm.push_back(whole.actual_mm[k]);
  }
  set_stretches(t);
  return t;
}

TEST(PlaceTrace, FindsTheLinesOfAWholeRun) {
  const FeedRun run = synthetic_run(known_machine());
  ServoTrace trace = piece_of_trace(run.trace, 0, run.trace.size(), 1);
  const auto placed = place_on_path(trace, run.program);
  ASSERT_TRUE(placed);
  EXPECT_LT(placed->off_path_p95_mm, 0.5);
  set_lines(trace, run.program, *placed);
  EXPECT_EQ(trace.line.size(), trace.size());
}

/// A spiral of lines, logged seven times a second from somewhere inside it, in machine coordinates.
class PositionLog : public ::testing::Test {
 protected:
  PositionLog() {
    tests::TestProgram p;
    p.rapid(10, 0, 5);
    for (int i = 1; i < 900; ++i) {
      const double phi = 0.08 * i, r = 10 + 0.4 * phi;
      p.line(r * std::cos(phi), r * std::sin(phi), 5 - 0.002 * i, 2000);
    }
    run_.program = p.program;
    machine_.axis[0].acceleration_mm_per_s2 = machine_.axis[1].acceleration_mm_per_s2 = 800;
    machine_.axis[2].acceleration_mm_per_s2 = 800;
    machine_.control.corner = {.law = machine::CornerLaw::speed_difference, .speed_difference_mm_per_s = 4};
    run_ = tests::traced_run(p.program, machine_, {});
  }
  machine::Machine machine_;
  FeedRun run_;
};

TEST_F(PositionLog, GivesTimesOfPiecesThatThePlanHas) {
  const ServoTrace log = piece_of_trace(run_.trace, 7001, run_.trace.size() - 5003, 143);
  const auto placed = place_on_path(log, run_.program);
  ASSERT_TRUE(placed);
  StretchRun pieces{"spiral", run_.program, placed_stretches(log, run_.program, *placed, {.piece_s = 1})};
  ASSERT_GT(pieces.timed.size(), 20u);
  std::size_t count = 0;
  const std::vector<LoggedLines> logged = logged_lines({pieces}, 3, count);
  const TimedLines& lines = logged.front().lines;
  const auto planned_s = planned_times_s(lines, machine_, feedmodel::plan_motion(*lines.program, machine_));
  ASSERT_EQ(planned_s.size(), pieces.timed.size());
  for (std::size_t i = 0; i < planned_s.size(); ++i) {
    EXPECT_TRUE(pieces.timed[i].stretch.begins_in_motion());
    EXPECT_NEAR(planned_s[i], lines.time_s[i], 3 * lines.sigma_s[i]) << lines.parts[i].line_first;
  }
}

/// Where samples are far apart, the way along corners and circles is much longer than its chord.
TEST(PlaceTrace, FollowsSharpCornersAndCirclesBetweenSamples) {
  tests::TestProgram p;
  for (int row = 0; row < 6; ++row) {
    const double y = 12.0 * row;
    for (int i = 1; i <= 12; ++i) p.line(4.0 * i, y + (i % 2 ? 5 : 0), 0, 4500);
    p.arc_xy(48, y, 48 - 3, y, 2 * kPi, 4500);
    p.line(48, y + 6, 0, 4500).line(0, y + 6, 0, 4500).line(0, y + 12, 0, 4500);
  }
  machine::Machine machine;
  for (machine::Axis& axis : machine.axis) axis.acceleration_mm_per_s2 = 900;
  machine.control.corner = {.law = machine::CornerLaw::speed_difference, .speed_difference_mm_per_s = 15};
  const FeedRun run = tests::traced_run(p.program, machine, {});
  const ServoTrace log = piece_of_trace(run.trace, 211, run.trace.size() - 307, 143);
  const auto placed = place_on_path(log, run.program);
  ASSERT_TRUE(placed);
  for (std::size_t k = 0; k < log.size(); ++k) {
    const std::uint32_t line = run.trace.line[211 + 143 * k];
    if (line == 0) continue;
    // At the end of a block the drives lag behind the line that is commanded.
    EXPECT_NEAR(run.program.moves[placed->place[k].move].block + 1, line, 1) << k;
  }
}

TEST_F(PositionLog, IsPlacedInAnotherWorkOffset) {
  ServoTrace log = piece_of_trace(run_.trace, 0, run_.trace.size(), 20);
  for (Vec3& p : log.actual_mm) p += Vec3(-240, 31, 77);
  const auto placed = place_on_path(log, run_.program);
  ASSERT_TRUE(placed);
  EXPECT_NEAR(placed->offset_mm.x(), 240, 0.1);
}

TEST_F(PositionLog, OfAnotherProgramIsNotPlaced) {
  tests::TestProgram other;
  for (int i = 1; i < 50; ++i) other.line(3.0 * i, i % 2 * 4.0, 0, 1000);
  const ServoTrace log = piece_of_trace(run_.trace, 0, run_.trace.size(), 20);
  EXPECT_FALSE(place_on_path(log, other.program));
}

/// Zigzags in all planes with positionings between, on axes that differ in acceleration and gain.
class SparseLog : public ::testing::Test {
 protected:
  SparseLog() {
    constexpr double kAccelerations[] = {1400, 800, 500}, kGains[] = {70, 25, 40};
    for (int i = 0; i < 3; ++i) {
      machine_.axis[i].max_velocity_mm_per_s = 120 + 80 * i;
      machine_.axis[i].acceleration_mm_per_s2 = kAccelerations[i];
      machine_.axis[i].position_gain_per_s = kGains[i];
    }
    machine_.control.corner = {.law = machine::CornerLaw::angle, .time_s = 0.006};
    record();
  }

  void record() {
    tests::TestProgram p;
    for (int run = 0; run < 18; ++run) {
      Vec3 at = Vec3::Zero();
      for (int i = 0; i < 24; ++i) {
        at[run % 3] += 3 + (i + run) % 4;
        at[(run + 1) % 3] += (i % 2 ? 1 : -1) * (2 + run % 5);
        p.line(at.x(), at.y(), at.z(), 1500 + 900 * (run % 4));
      }
      p.rapid(0, 0, 0);
    }
    run_ = tests::traced_run(p.program, machine_, {});
    const ServoTrace log = piece_of_trace(run_.trace, 0, run_.trace.size(), 143);
    if (const auto placed = place_on_path(log, run_.program))
      timed_ = placed_stretches(log, run_.program, *placed, {.piece_s = 0.4});
  }
  machine::Machine machine_;
  FeedRun run_;
  std::vector<TimedStretch> timed_;  ///< empty: the log was not placed
};

/// In a dog-leg rapid the axes are far off the line between its ends.
TEST_F(SparseLog, IsPlacedThroughRapidsOffTheirLines) { EXPECT_GT(timed_.size(), 60u); }

TEST_F(SparseLog, TellsAccelerationsOfAxesThatLagByDifferentTimes) {
  const FitFeedResult fit = fit_feed({}, {{"zigzags", run_.program, timed_}}, {}, {});
  EXPECT_EQ(fit.law, "speed change by angle");
  for (int i = 0; i < 3; ++i) {
    const double acceleration = machine_.axis[i].acceleration_mm_per_s2;
    EXPECT_NEAR(fit.machine.axis[i].acceleration_mm_per_s2, acceleration, 0.08 * acceleration) << i;
  }
  // Pieces that were held out agree within about what their times are known to (some 7 ms), and on the whole better.
  double time_s = 0, model_s = 0, off = 0, count = 0;
  for (const LoggedTime& t : fit.logged) {
    if (!t.kept_back) continue;
    time_s += t.time_s, model_s += t.model_s;
    off += std::abs(t.model_s - t.time_s) / t.sigma_s, ++count;
  }
  EXPECT_GT(count, 15);
  EXPECT_LT(off / count, 1.5);
  EXPECT_NEAR(model_s, time_s, 0.01 * time_s);
  // No block is short enough to show a longer one.
  EXPECT_LE(fit.machine.control.block_time_s, 0.001);
}

/// Such a control is slower at every change of speed than any corner law explains.
TEST_F(SparseLog, TellsTheTimeInWhichTheAccelerationBuildsUp) {
  machine_.cycle.acceleration_law = machine::AccelerationLaw::bell;
  machine_.cycle.bell_time_s = 0.08;
  record();
  const FitFeedResult fit = fit_feed({}, {{"zigzags", run_.program, timed_}}, {}, {});
  EXPECT_EQ(fit.law, "speed change by angle and bell ramps");
  EXPECT_EQ(fit.machine.cycle.acceleration_law, machine::AccelerationLaw::bell);
  EXPECT_NEAR(fit.machine.cycle.bell_time_s, 0.08, 0.02);
}

/// Errors of two kinds cancel each other over all parts, not in a program that has a few.
TEST(TimePromise, HasRoomForProgramsOfFewKinds) {
  std::vector<double> predicted_s(100, 1.02);
  std::fill(predicted_s.begin(), predicted_s.begin() + 50, 0.98);
  const auto promise = time_promise(std::vector<double>(100, 1.0), predicted_s);
  ASSERT_TRUE(promise);
  EXPECT_LT(promise->low_percent, -1);
  EXPECT_GT(promise->high_percent, 1);
}

}  // namespace
}  // namespace camber::calib
