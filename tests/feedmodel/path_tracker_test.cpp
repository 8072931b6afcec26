#include "feedmodel/path_tracker.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/test_program.h"

namespace camber::feedmodel {
namespace {

machine::Machine lagging_machine() {
  machine::Machine m;
  m.control.corner.law = machine::CornerLaw::blend;
  m.control.corner.tolerance_mm = 0.01;
  for (machine::Axis& axis : m.axis) {
    axis.acceleration_mm_per_s2 = 500;
    axis.position_gain_per_s = 30;
  }
  return m;
}

struct Followed {
  double farthest_mm = 0;
  PathPlace last;
  bool monotone = true, behind = true;
};

Followed follow(const nc::Interpretation& program, const machine::Machine& machine) {
  Followed f;
  PathTracker tracker(program);
  predict_feed(program, machine, [&](std::span<const TimedSample> run) {
    for (const TimedSample& s : run) {
      const PathPlace place = tracker(s);
      f.monotone =
          f.monotone && (place.move > f.last.move || (place.move == f.last.move && place.u >= f.last.u - 1e-12));
      f.behind = f.behind && place.move <= s.move;
      f.farthest_mm = std::max(f.farthest_mm, place.distance_mm);
      f.last = place;
    }
  });
  return f;
}

void expect_whole(const Followed& f, const nc::Interpretation& program, double farthest_mm) {
  EXPECT_TRUE(f.monotone);
  EXPECT_TRUE(f.behind);
  EXPECT_LT(f.farthest_mm, farthest_mm);
  EXPECT_EQ(f.last.move, program.moves.size() - 1);
  EXPECT_NEAR(f.last.u, 1, 1e-3);
}

TEST(PathTracker, IsThreeShortBlocksBehind) {
  tests::TestProgram p;
  for (int i = 1; i <= 200; ++i) p.line(0.1 * i, 0, 0, 540);  // 9 mm/s: 0.3 mm behind
  PathTracker tracker(p.program);
  bool seen = false;
  predict_feed(p.program, lagging_machine(), [&](std::span<const TimedSample> run) {
    for (const TimedSample& s : run) {
      const PathPlace place = tracker(s);
      EXPECT_LT(place.distance_mm, 1e-9);
      if (s.move != 100) continue;
      seen = true;
      EXPECT_GE(place.move, 96u);
      EXPECT_LE(place.move, 98u);
    }
  });
  EXPECT_TRUE(seen);
}

/// The axes may be behind by twice their distance from the command, and no further: not by a whole turn of a square.
TEST(PathTracker, DoesNotJumpOverAClosedFigureFarFromTheOrigin) {
  tests::TestProgram p;
  p.rapid(100, 100, 0).line(101, 100, 0, 600).line(101, 101, 0, 600).line(100, 101, 0, 600).line(100, 100, 0, 600);
  p.line(101, 100.02, 0, 600);
  PathTracker tracker(p.program);
  const TimedSample behind{.command_mm = {100.5, 100.01, 0}, .position_mm = {100.5, 100.008, 0}, .move = 5};
  tracker({.command_mm = {100, 100, 0}, .position_mm = {100, 100, 0}, .move = 0});
  ASSERT_EQ(tracker({.command_mm = {100.49, 100, 0}, .position_mm = {100.49, 100, 0}, .move = 1}).move, 1u);
  EXPECT_EQ(tracker(behind).move, 1u);
}

/// Axes that run past the end of a move are not past it on the path.
TEST(PathTracker, StaysOnItsMove) {
  tests::TestProgram p;
  p.line(10, 0, 0, 600).line(0, 0, 0, 600);
  PathTracker tracker(p.program);
  tracker({.command_mm = {9.9, 0, 0}, .position_mm = {9.9, 0, 0}});
  const PathPlace place = tracker({.command_mm = {10, 0, 0}, .position_mm = {10.15, 0, 0}});
  EXPECT_EQ(place.move, 0u);
  EXPECT_DOUBLE_EQ(place.u, 1);
  EXPECT_NEAR(place.distance_mm, 0.15, 1e-12);
}

TEST(PathTracker, TurnsTheCorner) {
  tests::TestProgram p;
  p.line(20, 0, 0, 2400).line(20, 20, 0, 2400);
  expect_whole(follow(p.program, lagging_machine()), p.program, 0.3);
}

TEST(PathTracker, TurnsASharpCornerWithInstantAcceleration) {
  machine::Machine m = lagging_machine();
  for (machine::Axis& axis : m.axis) axis.acceleration_mm_per_s2 = machine::kNoLimit;
  tests::TestProgram p;
  p.line(20, 0, 0, 2400).line(5, 4, 0, 2400).line(20, 8, 0, 2400);
  const Followed f = follow(p.program, m);
  EXPECT_TRUE(f.monotone);
  EXPECT_EQ(f.last.move, 2u);
  EXPECT_NEAR(f.last.u, 1, 1e-3);
}

TEST(PathTracker, ClosedFigureDoesNotStartAgain) {
  tests::TestProgram p;
  p.line(10, 0, 0, 1200).line(10, 10, 0, 1200).line(0, 10, 0, 1200).line(0, 0, 0, 1200).dwell(0.2).line(10, 0, 0, 1200);
  expect_whole(follow(p.program, lagging_machine()), p.program, 0.3);
}

TEST(PathTracker, KeepsToItsRowOfAZigzag) {
  tests::TestProgram p;
  for (int row = 0; row < 8; ++row) {
    p.line(row % 2 ? 0 : 10, 0.3 * row, 0, 1800);
    p.line(row % 2 ? 0 : 10, 0.3 * (row + 1), 0, 1800);
  }
  const Followed f = follow(p.program, lagging_machine());
  expect_whole(f, p.program, 0.16);
}

TEST(PathTracker, FollowsSeveralTurns) {
  tests::TestProgram p;
  p.line(5, 0, 0, 1200).arc_xy(5, 0, 0, 0, 3 * 2 * kPi, 1200).rapid(0, 0, 5).line(0, 0, 5, 600).line(0, 3, 5, 600);
  expect_whole(follow(p.program, lagging_machine()), p.program, 0.3);
}

}  // namespace
}  // namespace camber::feedmodel
