#include "feedmodel/segment_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "feedmodel/axes.h"

namespace camber::feedmodel {
namespace {

constexpr ExponentialRamp kBlock{.start_mm_per_s = 5, .command_mm_per_s = 40, .t1_s = 0.05, .t2_s = 0.02};

TEST(Exponential, DistanceIsTheIntegralOfSpeed) {
  double sum = 0;
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 20000; ++i) sum += kStep * kBlock.speed_at((i + 0.5) * kStep);
  EXPECT_NEAR(kBlock.distance_at(20000 * kStep), sum, 1e-7);
  EXPECT_NEAR(kBlock.speed_at(0), 5, 1e-12);
  EXPECT_NEAR(kBlock.distance_at(0), 0, 1e-12);
}

TEST(Exponential, ExactTimeGoesTheDistanceAndTheApproximateOneIsItsLimit) {
  for (double d : {0.001, 0.1, 1.0, 10.0}) EXPECT_NEAR(kBlock.distance_at(kBlock.time_of(d)), d, 1e-9) << d;
  EXPECT_NEAR(kBlock.time_of(50), kBlock.approximate_time_of(50), 1e-9);
  EXPECT_LT(kBlock.time_of(0.1), 0.5 * kBlock.approximate_time_of(0.1));  // short blocks: the approximation is far off
}

TEST(Exponential, EqualConstantsAreTheLimit) {
  const ExponentialRamp e{.start_mm_per_s = 0, .command_mm_per_s = 10, .t1_s = 0.03, .t2_s = 0.03};
  EXPECT_NEAR(e.speed_at(0.03), 10 * (1 - 2 * std::exp(-1.0)), 1e-4);
}

TEST(Exponential, TheAxisFilterDoesTheSameToARampOfPosition) {
  machine::Machine m;
  m.axis[0].exponential_1_s = 0.05;
  m.axis[0].exponential_2_s = 0.02;
  Axes axes(m, Vec3::Zero());
  const ExponentialRamp e{.start_mm_per_s = 0, .command_mm_per_s = 40, .t1_s = 0.05, .t2_s = 0.02};
  Vec3 position;
  for (int k = 1; k <= 100; ++k) position = axes(Vec3(40 * 0.001 * k, 0, 0));
  EXPECT_NEAR(position.x(), e.distance_at(0.1), 2e-4);  // the second lag takes the first one's output as straight
}

}  // namespace
}  // namespace camber::feedmodel
