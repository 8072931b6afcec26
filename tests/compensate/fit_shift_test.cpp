#include "compensate/fit_shift.h"

#include <cmath>

#include <gtest/gtest.h>

namespace camber::compensate {
namespace {

/// A straight line of n blocks of 1 mm along X.
nc::Interpretation line_program(int n) {
  nc::Interpretation p;
  p.states.emplace_back();
  for (int i = 0; i < n; ++i) {
    nc::Move m;
    m.kind = nc::MoveKind::linear;
    m.start_mm = {static_cast<double>(i), 0, 0};
    m.end_mm = {i + 1.0, 0, 0};
    m.feed_mm_per_s = 10;
    m.block = static_cast<std::uint32_t>(i);
    p.moves.push_back(m);
  }
  return p;
}

std::vector<Observation> observe(const ShiftPath& path, int moves, auto error_of_x) {
  std::vector<Observation> out;
  for (int i = 0; i < moves; ++i)
    for (double u = 0.05; u < 1; u += 0.1)
      out.push_back({path.find(static_cast<std::uint32_t>(i), u), Vec3(0, 0, 1), error_of_x(i + u), 0.03});
  return out;
}

TEST(FitShift, APlungeGetsNoShiftAcross) {
  // Down, along X, down again, along X, up: 4 mm each.
  nc::Interpretation program = line_program(5);
  const std::vector<Vec3> places{{0, 0, 9}, {0, 0, 5}, {4, 0, 5}, {4, 0, 1}, {8, 0, 1}, {8, 0, 5}};
  for (std::size_t i = 0; i < 5; ++i) {
    program.moves[i].start_mm = places[i];
    program.moves[i].end_mm = places[i + 1];
  }
  ShiftPath path(program, std::vector<bool>(5, true), 1.0);
  std::vector<Observation> seen;
  for (const std::uint32_t move : {1u, 3u})
    for (double u = 0.05; u < 1; u += 0.1)
      for (const Vec3& normal : {Vec3(0, 1, 0), Vec3(0, 0, 1)})
        seen.push_back({path.find(move, u), normal, 0.02, 0.03});
  fit_shift(path, seen, {});
  const auto& points = path.points();
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (points[i].move == 0) {
      EXPECT_EQ(points[i].shift_mm.head<2>().norm(), 0);  // a rapid ends where it starts
    }
    if (points[i].move % 2 == 0) {
      EXPECT_EQ(points[i].shift_mm.head<2>(), points[i - 1].shift_mm.head<2>());
    }
  }
  EXPECT_NEAR(path.shift_at(path.find(3, 0.5)).y(), -0.02, 0.002);
  EXPECT_NEAR(points[points.size() - 5].shift_mm.z(), -0.02, 0.002);  // at the end of the second cut
}

/// Walls on both sides of a plunge with errors of opposite sign: its one shift is the mean, as the least squares have
/// it, and not that of one side, which would leave the other wall a step.
TEST(FitShift, APlungeTakesTheMeanOfItsTwoSidesInXAndInY) {
  for (const int across : {0, 1}) {
    const Vec3 along = Vec3::Unit(1 - across) * 12;
    nc::Interpretation program = line_program(3);
    const std::vector<Vec3> places{{0, 0, 5}, along + Vec3(0, 0, 5), along + Vec3(0, 0, 1), 2 * along + Vec3(0, 0, 1)};
    for (std::size_t i = 0; i < 3; ++i) {
      program.moves[i].start_mm = places[i];
      program.moves[i].end_mm = places[i + 1];
    }
    ShiftPath path(program, std::vector<bool>(3, true), 1.0);
    std::vector<Observation> seen;
    for (const std::uint32_t move : {0u, 2u})
      for (double u = 0.01; u < 1; u += 0.02)
        seen.push_back({path.find(move, u), Vec3::Unit(across), move == 0 ? 0.02 : -0.02, 0.03});
    fit_shift(path, seen, {});
    EXPECT_NEAR(path.shift_at(path.find(1, 0.5))[across], 0, 0.005) << across;
    EXPECT_NEAR(path.shift_at(path.find(0, 0.6))[across], -0.02, 0.004) << across;
    EXPECT_NEAR(path.shift_at(path.find(2, 0.6))[across], 0.02, 0.004) << across;
  }
}

TEST(FitShift, MovesThePathAgainstASmoothError) {
  const auto program = line_program(20);
  ShiftPath path(program, std::vector<bool>(20, true), 1.0);
  const auto error = [](double x) { return 0.02 + 0.005 * std::sin(x / 4); };
  fit_shift(path, observe(path, 20, error), {});
  for (const auto& p : path.points()) {
    if (p.place_mm.x() < 3) continue;  // the first point is fixed
    EXPECT_NEAR(p.shift_mm.z(), -error(p.place_mm.x()), 0.0004);
    EXPECT_NEAR(p.shift_mm.x(), 0, 1e-9);
    EXPECT_NEAR(p.shift_mm.y(), 0, 1e-9);
  }
}

/// At each place errors of 20 and 4 um: the least squares take their mean, which would leave the second one -8.
TEST(FitShift, KeepsBoundsThatTheLeastSquaresWouldExceed) {
  const auto program = line_program(20);
  std::vector<Observation> seen;
  ShiftPath path(program, std::vector<bool>(20, true), 1.0);
  for (const double error_mm : {0.020, 0.004})
    for (Observation o : observe(path, 20, [&](double) { return error_mm; })) {
      o.bound_mm = error_mm + 0.001;
      seen.push_back(o);
    }
  const auto middle = [&] { return path.shift_at(path.find(10, 0.5)).z(); };
  fit_shift(path, seen, {});
  EXPECT_NEAR(middle(), -0.012, 1e-4);
  path.set_shifts(std::vector<Vec3>(path.points().size(), Vec3::Zero()));
  fit_shift(path, seen, {.bounded = true});
  EXPECT_NEAR(middle(), -0.009, 2.5e-4) << "4 - 9 = -5 um";
}

TEST(FitShift, LeavesTheChainsFirstPointWhereTheRapidEnds) {
  const auto program = line_program(5);
  ShiftPath path(program, std::vector<bool>(5, true), 1.0);
  fit_shift(path, observe(path, 5, [](double) { return 0.02; }), {});
  EXPECT_TRUE(path.points().front().shift_mm.isZero());
}

TEST(FitShift, DiesAwayWhereNoSurfaceIsMade) {
  const auto program = line_program(60);
  ShiftPath path(program, std::vector<bool>(60, true), 1.0);
  fit_shift(path, observe(path, 10, [](double) { return 0.02; }), {.decay_mm = 5});
  EXPECT_LT(std::abs(path.points().back().shift_mm.z()), 1e-5);
  EXPECT_LT(std::abs(path.points()[30].shift_mm.z()), std::abs(path.points()[15].shift_mm.z()));
}

TEST(FitShift, IsHeldToTheLargestShift) {
  const auto program = line_program(10);
  ShiftPath path(program, std::vector<bool>(10, true), 1.0);
  EXPECT_GT(fit_shift(path, observe(path, 10, [](double) { return 0.5; }), {.max_shift_mm = 0.1}), 0u);
  EXPECT_NEAR(path.largest_shift_mm(), 0.1, 1e-12);
}

TEST(ShiftPath, SplitsALineOnlyWhereTheShiftChangesAlongIt) {
  nc::Interpretation program = line_program(1);
  program.moves[0].end_mm = {20, 0, 0};
  ShiftPath path(program, {true}, 1.0);
  for (auto& p : path.points()) p.shift_mm.z() = 0.001 * p.place_mm.x();
  ASSERT_EQ(path.edits(0.0005).size(), 1u);
  EXPECT_TRUE(path.edits(0.0005)[0].via.empty()) << "a shift that grows evenly needs no split";
  path.points()[10].shift_mm.z() = 0.02;
  EXPECT_FALSE(path.edits(0.0005)[0].via.empty());
}

TEST(ShiftPath, DoesNotTouchMovesThatAreNotSelected) {
  auto program = line_program(4);
  ShiftPath path(program, {true, false, true, true}, 1.0);
  ASSERT_EQ(path.chains().size(), 2u);
  EXPECT_TRUE(path.points()[path.chains()[1].from].fixed);
}

}  // namespace
}  // namespace camber::compensate
