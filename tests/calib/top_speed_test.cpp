// Top speeds of axes: what a held speed says, and what it does not.
#include "calib/line_speeds.h"

#include <gtest/gtest.h>

namespace camber::calib {
namespace {

HeldSpeed held(JointSpeeds speed, double duration_s, double asked = machine::kNoLimit) {
  HeldSpeed h;
  h.speed = speed;
  h.duration_s = duration_s;
  h.asked.counts = true;
  for (std::size_t i = 0; i < kJoints; ++i) h.asked.per_s[i] = speed[i] > 0 ? asked : 0;
  return h;
}

TEST(TopSpeed, OfAnAxisThatMovesAlone) {
  const auto top = top_speeds({held({130, 0, 0, 0, 0, 0}, 0.5)});
  ASSERT_TRUE(top[0].limit);
  EXPECT_DOUBLE_EQ(top[0].limit->value, 130);
  EXPECT_LT(top[0].limit->std_error, 0.1);
  EXPECT_FALSE(top[1].limit);
}

/// C is at its limit in each of these rapids; Z never where nothing else is.
TEST(TopSpeed, BelongsToTheAxisThatEveryOtherOneStaysBehind) {
  const auto top = top_speeds({held({0, 0, 9.6, 0, 0, 80}, 0.5), held({12, 0, 4, 10.7, 0, 80}, 0.5),
                               held({6, 0, 0, 16, 0, 80}, 0.5), held({3, 0, 2, 5, 0, 80}, 0.5)});
  ASSERT_TRUE(top[5].limit);
  EXPECT_DOUBLE_EQ(top[5].limit->value, 80);
  EXPECT_FALSE(top[2].limit);
  EXPECT_FALSE(top[0].limit);
  EXPECT_FALSE(top[3].limit);
  EXPECT_DOUBLE_EQ(top[2].highest, 9.6);
}

TEST(TopSpeed, IsNoneWhereTheProgramAsksForNoMore) {
  EXPECT_FALSE(top_speeds({held({50, 0, 0, 0, 0, 0}, 0.5, 50)})[0].limit);
  EXPECT_FALSE(top_speeds({held({50, 0, 0, 0, 0, 0}, 0.5), held({70, 0, 0, 0, 0, 0}, 0.5, 70)})[0].limit);
}

/// Each axis of a dog leg has its own profile.
TEST(TopSpeed, OfEveryAxisInADogLeg) {
  HeldSpeed both = held({100, 80, 0, 0, 0, 0}, 0.2);
  EXPECT_FALSE(top_speeds({both})[0].limit);
  both.asked.axes_apart = true;
  const auto top = top_speeds({both});
  ASSERT_TRUE(top[0].limit && top[1].limit);
  EXPECT_DOUBLE_EQ(top[1].limit->value, 80);
}

}  // namespace
}  // namespace camber::calib
