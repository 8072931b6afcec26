// Traces without lines, and pieces of runs, on the path of their program.
#include "calib/place_trace.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/feed_accuracy.h"
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
  const auto pieces = placed_stretches(log, run_.program, *placed, 4.0);
  ASSERT_GT(pieces.size(), 3u);
  for (const TimedStretch& piece : pieces) {
    EXPECT_TRUE(piece.stretch.begins_in_motion());
    // True: from the first to the last sample of the lines.
    double first = -1, last = 0;
    for (std::size_t k = 0; k < run_.trace.size(); ++k)
      if (run_.trace.line[k] >= piece.stretch.line_first && run_.trace.line[k] <= piece.stretch.line_last) {
        if (first < 0) first = run_.trace.t_s[k];
        last = run_.trace.t_s[k];
      }
    EXPECT_NEAR(piece.time_s, last - first, 3 * std::sqrt(2.0) * piece.sigma_s) << piece.stretch.line_first;
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

}  // namespace
}  // namespace camber::calib
