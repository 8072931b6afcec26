#include "copymill/runner.h"

#include <cmath>

#include <gtest/gtest.h>

namespace camber::copymill {
namespace {

constexpr double kNone = 1e30;

machine::Machine machine_with(double acceleration) {
  machine::Machine out;
  out.control.period_s = 0.001;
  for (auto& axis : out.axis) axis.acceleration_mm_per_s2 = acceleration, axis.max_velocity_mm_per_s = 150;
  return out;
}

/// A square with a quarter circle, a spike that turns back, and a slope.
std::vector<PathPiece> path() {
  std::vector<PathPiece> out{line_piece({0, 0, 0}, {10, 0, 0})};
  PathPiece arc = line_piece({10, 0, 0}, {15, 5, 0});
  arc.arc = true, arc.centre = {10, 5}, arc.sweep_rad = kPi / 2, arc.length_mm = 5 * kPi / 2;
  out.push_back(arc);
  out.push_back(line_piece({15, 5, 0}, {15, 12, 0}));
  out.push_back(line_piece({15, 12, 0}, {15, 8, 0}));
  out.push_back(line_piece({15, 8, 0}, {5, 8, 3}));
  return out;
}

double away_from(const std::vector<PathPiece>& pieces, const Vec3& p) {
  double out = 1e9;
  for (const PathPiece& piece : pieces)
    for (double s = 0; s <= piece.length_mm; s += 0.001) out = std::min(out, (piece.at(s) - p).norm());
  return out;
}

TEST(FeedMotion, KeepsAccelerationsOfTheAxesAndStaysOnThePath) {
  FeedMotion motion(machine_with(600));
  motion.place({0, 0, 0});
  motion.start(path(), false);
  Vec3 before = motion.tip(), speed = Vec3::Zero();
  double worst = 0, off = 0;
  int ticks = 0;
  for (; !motion.finished() && ticks < 20000; ++ticks) {
    motion.tick(40, {0, kNone});
    const Vec3 now = (motion.tip() - before) / 0.001;
    worst = std::max(worst, (now - speed).cwiseAbs().maxCoeff() / 0.001);
    if (ticks % 16 == 0) off = std::max(off, away_from(path(), motion.tip()));
    before = motion.tip(), speed = now;
  }
  EXPECT_LT(ticks, 20000);
  EXPECT_LT(worst, 600 * 1.001);
  EXPECT_GT(worst, 200);
  EXPECT_LT(off, FeedMotion::kSmoothing_mm + 0.0006);  // half a step of the measurement
  EXPECT_NEAR((motion.tip() - Vec3(5, 8, 3)).norm(), 0, 1e-9);
}

TEST(FeedMotion, StopsAtAnyTickWithinTheLimitsAndOnThePath) {
  for (const int stop : {50, 300, 333, 700, 901, 1400}) {
    FeedMotion motion(machine_with(600));
    motion.place({0, 0, 0});
    motion.start(path(), false);
    Vec3 before = motion.tip(), speed = Vec3::Zero();
    int ticks = 0;
    double worst = 0;
    for (; ticks < 20000 && !(ticks > stop && motion.at_rest()) && !motion.finished(); ++ticks) {
      motion.tick(ticks >= stop ? 0 : 40, {0, kNone});
      const Vec3 now = (motion.tip() - before) / 0.001;
      worst = std::max(worst, (now - speed).cwiseAbs().maxCoeff() / 0.001);
      before = motion.tip(), speed = now;
    }
    EXPECT_LT(worst, 600 * 1.001) << stop;
    EXPECT_LT(away_from(path(), motion.tip()), FeedMotion::kSmoothing_mm + 0.0006) << stop;
    // From 40 mm/s at half of 600 mm/s^2: 133 ms and the average.
    EXPECT_LT(ticks - stop, 150) << stop;
  }
}

TEST(FeedMotion, KeepsAFurtherLimitAhead) {
  FeedMotion motion(machine_with(600));
  motion.place({0, 0, 0});
  motion.start({line_piece({0, 0, 0}, {50, 0, 0})}, false);
  while (motion.along_piece_mm() < 25 && motion.piece() == 0) motion.tick(40, {25 - motion.along_piece_mm(), 5});
  EXPECT_LT(motion.speed_mm_per_s(), 5.5);
}

}  // namespace
}  // namespace camber::copymill
