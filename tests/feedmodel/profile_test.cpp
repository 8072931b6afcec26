#include "feedmodel/segment_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "feedmodel/lookahead.h"
#include "machine/machine_model.h"

namespace camber::feedmodel {
namespace {

constexpr double kTime = 1e-9;  // s; closed forms

TEST(Trapezoid, LongBlockCruises) {  // Yan & Shirase eqs. 6-7: a 750, F 75, d 10
  const Trapezoid p = make_trapezoid(10, 0, 0, 75, 750);
  EXPECT_NEAR(p.duration_s(), 0.233333333333, 1e-9);
  EXPECT_DOUBLE_EQ(p.peak, 75);
}

TEST(Trapezoid, ShortBlockIsATriangle) {  // eqs. 8-10: d 4
  const Trapezoid p = make_trapezoid(4, 0, 0, 75, 750);
  EXPECT_NEAR(p.peak, 54.772, 1e-3);
  EXPECT_NEAR(p.duration_s(), 0.14606, 1e-5);
}

TEST(Trapezoid, AcceleratesFromASpeed) {  // eq. 11: f_s 30, d 1
  const double exit = 48.98979485566356;
  const Trapezoid p = make_trapezoid(1, 30, exit, 75, 750);
  EXPECT_NEAR(p.duration_s(), 0.025320, 1e-6);
  EXPECT_NEAR(p.distance_at(p.duration_s()), 1, kTime);
}

TEST(Trapezoid, DistanceIsTheIntegralOfTheSpeed) {
  const Trapezoid p = make_trapezoid(10, 20, 5, 60, 400);
  double s = 0;
  const int steps = 200000;
  const double dt = p.duration_s() / steps;
  for (int i = 0; i < steps; ++i) s += p.speed_at((i + 0.5) * dt) * dt;
  EXPECT_NEAR(s, 10, 1e-6);
}

TEST(Trapezoid, InstantAccelerationTakesLengthOverSpeed) {
  const Trapezoid p = make_trapezoid(10, 0, 0, 50, machine::kNoLimit);
  EXPECT_DOUBLE_EQ(p.duration_s(), 0.2);
  EXPECT_DOUBLE_EQ(p.distance_at(0.1), 5);
}

TEST(LookAhead, BrakesOverSeveralBlocks) {
  std::vector<PlanRow> rows(
      10,
      PlanRow{
          .length_mm = 0.1, .speed_limit_mm_per_s = 100, .acceleration_mm_per_s2 = 500, .entry_speed_mm_per_s = 100});
  plan_speeds(rows, 0);
  EXPECT_DOUBLE_EQ(rows[0].entry_speed_mm_per_s, 0);
  EXPECT_NEAR(rows[5].entry_speed_mm_per_s, std::sqrt(2 * 500 * 0.5), 1e-12);
  EXPECT_NEAR(rows[9].entry_speed_mm_per_s, std::sqrt(2 * 500 * 0.1), 1e-12);
}

TEST(LookAhead, HorizonLimitsTheSpeedToWhatItCanStopFrom) {
  std::vector<PlanRow> rows(
      1000,
      PlanRow{
          .length_mm = 0.1, .speed_limit_mm_per_s = 1000, .acceleration_mm_per_s2 = 250, .entry_speed_mm_per_s = 1000});
  plan_speeds(rows, 50);
  EXPECT_NEAR(rows[500].entry_speed_mm_per_s, std::sqrt(2 * 250 * 50 * 0.1), 1e-9);
}

TEST(LookAhead, WideHorizonIsTheWholePath) {
  std::vector<PlanRow> a;
  unsigned seed = 1;
  const auto random = [&] { return static_cast<double>((seed = seed * 1664525u + 1013904223u) >> 8) / (1 << 24); };
  for (int i = 0; i < 300; ++i)
    a.push_back({.length_mm = 0.01 + random(),
                 .speed_limit_mm_per_s = 5 + 50 * random(),
                 .acceleration_mm_per_s2 = 100 + 500 * random(),
                 .entry_speed_mm_per_s = 80 * random()});
  std::vector<PlanRow> b = a;
  plan_speeds(a, 0);
  plan_speeds(b, 299);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a[i].entry_speed_mm_per_s, b[i].entry_speed_mm_per_s, 1e-6);
    const double exit = i + 1 < a.size() ? a[i + 1].entry_speed_mm_per_s : 0;
    EXPECT_LE(std::abs(exit * exit - a[i].entry_speed_mm_per_s * a[i].entry_speed_mm_per_s),
              2 * a[i].acceleration_mm_per_s2 * a[i].length_mm + 1e-6);
  }
}

}  // namespace
}  // namespace camber::feedmodel
