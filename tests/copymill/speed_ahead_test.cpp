// Speeds tick by tick: limits ahead are kept, and a stop at any tick is within the acceleration.
#include "copymill/runner.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace camber::copymill {

TEST(SpeedAhead, LimitsOnAPathAreKeptAndTheEndIsReachedAtRest) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int path = 0; path < 200; ++path) {
    const double a = 200 + 3000 * unit(random), tick = 0.001 + 0.007 * unit(random), end = 20 + 20 * unit(random);
    std::vector<SpeedLimit> places{{end, 0}};
    for (int i = 0; i < 6; ++i) places.push_back({end * unit(random), 5 + 80 * unit(random)});
    double at = 0, v = 0;
    int ticks = 0;
    while (at < end - 1e-6) {
      ASSERT_LT(++ticks, 100000);
      std::vector<SpeedLimit> ahead;
      for (const SpeedLimit& p : places)
        if (p.distance_mm >= at) ahead.push_back({p.distance_mm - at, p.speed_mm_per_s});
      const TickMotion m = next_tick(v, 60, ahead, a, tick);
      ASSERT_LE(std::abs(m.speed_mm_per_s - v), a * tick * (1 + 1e-9));
      ASSERT_LE(at + m.distance_mm, end + 1e-6);
      for (const SpeedLimit& p : places) {
        if (p.distance_mm < at || p.distance_mm > at + m.distance_mm || p.speed_mm_per_s == 0) continue;
        // The speed where the limit stands, with even acceleration in the tick, or to rest.
        const double slope = m.speed_mm_per_s > 0 ? (m.speed_mm_per_s - v) / tick : -v * v / (2 * m.distance_mm);
        ASSERT_LE(-slope, a * (1 + 1e-9));
        const double there = std::sqrt(std::max(0.0, v * v + 2 * slope * (p.distance_mm - at)));
        ASSERT_LE(there, p.speed_mm_per_s + 1e-6) << path;
      }
      at += m.distance_mm, v = m.speed_mm_per_s;
    }
    EXPECT_LT(v, a * tick + 1e-9);
  }
}

TEST(SpeedAhead, AStopAtAnyTickBrakesWithinTheAcceleration) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int stop = 0; stop < 200; ++stop) {
    const double a = 200 + 3000 * unit(random), tick = 0.001 + 0.007 * unit(random), v0 = 100 * unit(random);
    double v = v0, way = 0;
    while (v > 0) {
      const TickMotion m = next_tick(v, 0, {}, a, tick);
      ASSERT_LT(m.speed_mm_per_s, v);
      ASSERT_LE(v - m.speed_mm_per_s, a * tick * (1 + 1e-9));
      way += m.distance_mm, v = m.speed_mm_per_s;
    }
    EXPECT_NEAR(way, stopping_distance_mm(v0, a), 1e-9);
  }
}

TEST(SpeedAhead, ALimitNearerThanBrakingAllowsIsBrakedForWithAllThereIs) {
  const std::vector<SpeedLimit> ahead{{1, 0}};
  const TickMotion m = next_tick(100, 100, ahead, 1000, 0.004);
  EXPECT_NEAR(m.speed_mm_per_s, 96, 1e-12);
  EXPECT_NEAR(m.distance_mm, 0.392, 1e-12);
}

TEST(SpeedAhead, NoAxisIsAskedForMoreThanItsOwnAcceleration) {
  machine::Machine machine;
  machine.axis[0].acceleration_mm_per_s2 = 1000, machine.axis[1].acceleration_mm_per_s2 = 500;
  machine.axis[2].acceleration_mm_per_s2 = 300;
  EXPECT_NEAR(acceleration_along(machine, {1, 0, 0}), 1000, 1e-9);
  EXPECT_NEAR(acceleration_along(machine, {3, 4, 0}), 625, 1e-9);
  EXPECT_NEAR(acceleration_along(machine, {0, 0, -2}), 300, 1e-9);
  machine.control.path_acceleration_mm_per_s2 = 250;
  EXPECT_NEAR(acceleration_along(machine, {0, 0, -2}), 250, 1e-9);
}

}  // namespace camber::copymill
