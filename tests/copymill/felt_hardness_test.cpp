#include "copymill/load_follower.h"

#include <gtest/gtest.h>

namespace camber::copymill {
namespace {

TEST(FeltHardness, RemembersPlacesAndThoseBesideThem) {
  FeltHardness felt(1);
  EXPECT_EQ(felt.at({0, 0, 0}), 1);
  felt.feel({10, -20, -2}, 1.4);
  EXPECT_NEAR(felt.at({10.9, -20.9, -5}), 1.4, 1e-6);
  EXPECT_EQ(felt.at({12, -20, -2}), 1);
  EXPECT_EQ(felt.at({-10, -20, -2}), 1);
}

TEST(FeltHardness, RisesAtOnceAndFallsSlowly) {
  FeltHardness felt(1);
  felt.feel({0, 0, 0}, 1.1);
  felt.feel({0, 0, 0}, 1.5);
  EXPECT_NEAR(felt.at({0, 0, 0}), 1.5, 1e-6);
  felt.feel({0, 0, 0}, 1.0);
  EXPECT_NEAR(felt.at({0, 0, 0}), 1.4, 1e-6);
  for (int k = 0; k < 100; ++k) felt.feel({0, 0, 0}, 0.8);
  EXPECT_EQ(felt.at({0, 0, 0}), 1);
}

}  // namespace
}  // namespace camber::copymill
