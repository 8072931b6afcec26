#include "adapt/load.h"

#include <cmath>

#include <gtest/gtest.h>

namespace camber::adapt {
namespace {

TEST(LoadCurve, IsTheEdgePartAndTheShearPartTimesThePowerOfTheFeed) {
  const LoadCurve affine{20, 80};
  EXPECT_NEAR(affine.at(1, 1), 100, 1e-9);
  EXPECT_NEAR(affine.at(2, 1), 180, 1e-9);
  EXPECT_NEAR(affine.at(4, 0.75), 20 + 80 * std::pow(4, 0.75), 1e-9);
  // A form error of the other sign: excess material by the deflection, a gouge by the contour.
  EXPECT_NEAR((LoadCurve{-5, 3}).at(1, 1), 2, 1e-9);
}

TEST(LoadCurve, MaxRatioIsTheInverse) {
  for (const double p : {1.0, 0.75, 0.6})
    for (const LoadCurve curve : {LoadCurve{20, 80}, LoadCurve{0, 50}, LoadCurve{3, -20}, LoadCurve{-2, 30}})
      for (const double limit : {25.0, 100.0, 300.0}) EXPECT_NEAR(curve.at(curve.max_ratio(limit, p), p), limit, 1e-6);
}

TEST(LoadCurve, NoFeedKeepsALimitBelowTheEdgePart) {
  EXPECT_EQ((LoadCurve{20, 80}).max_ratio(19, 1), 0);
  EXPECT_TRUE(std::isinf((LoadCurve{20, 0}).max_ratio(21, 1)));
  EXPECT_TRUE(std::isinf((LoadCurve{0, 0}).max_ratio(1, 1)));
}

TEST(LoadPoint, TheChipIsProportionalToTheFeedWhateverTheForceLaw) {
  LoadPoint p{.feed_mm_per_s = 10, .exponent = 0.7f};
  p.curve[index_of(Load::chip)] = {0, 0.05f};
  EXPECT_NEAR(p.at(Load::chip, 20), 0.1, 1e-7);
  EXPECT_NEAR(p.max_feed_mm_per_s({Load::chip, 0.2}), 40, 1e-5);
  EXPECT_NEAR(p.max_feed_mm_per_s({Load::chip_min, 0.2}), 40, 1e-5);
}

TEST(Limits, AreThoseThatAreGiven) {
  machine::AdaptLimits given;
  given.torque_Nmm = 1200;
  given.chip_min_mm = 0.02;
  const auto limits = limits_of(given);
  ASSERT_EQ(limits.size(), 2u);
  EXPECT_EQ(text_of(limits[0].load).key, "torque_Nm");
  EXPECT_NEAR(text_of(limits[0].load).scale * limits[0].value, 1.2, 1e-12);
  EXPECT_EQ(text_of(limits[1].load).key, "chip_min_mm");
}

}  // namespace
}  // namespace camber::adapt
