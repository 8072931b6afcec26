// The round that is written is the best one that keeps the limits, and never one that is worse than the given program.
#include "compensate/judge.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace camber::compensate {
namespace {

TEST(ChooseRound, TakesTheLeastRmsWithinTheLimit) {
  constexpr std::array<RoundFigures, 4> kRounds{{{15, 30, 0}, {3, 6, 9}, {5, 10, 4}, {4, 9, 4.5}}};
  EXPECT_EQ(choose_round(kRounds, 5), 3u) << "round 1 is too deep";
  EXPECT_EQ(choose_round(kRounds, 10), 1u);
}

TEST(ChooseRound, TakesNoneThatIsWorseThanTheGivenProgram) {
  // A guard that made 24.1 um of 20.1 um where the round before it had 10.8 um, too deep.
  constexpr std::array<RoundFigures, 3> kRounds{{{9, 20.1, 0}, {5, 10.8, 12}, {11, 24.1, 3}}};
  EXPECT_EQ(choose_round(kRounds, 5), 0u);
  constexpr std::array<RoundFigures, 2> kPercentile{{{9, 20.1, 0}, {8, 24.1, 3}}};
  EXPECT_EQ(choose_round(kPercentile, 5), 0u) << "less rms, but a worse 95th percentile";
  EXPECT_EQ(choose_round(std::span(kRounds).first(1), 5), 0u);
}

TEST(ChooseRound, MayLieAsDeepAsTheGivenProgramWhereNoneKeepsTheLimit) {
  constexpr std::array<RoundFigures, 3> kRounds{{{9, 20, 12}, {5, 10, 11}, {6, 12, 14}}};
  EXPECT_EQ(choose_round(kRounds, 5), 1u);
  constexpr std::array<RoundFigures, 3> kWithin{{{9, 20, 12}, {5, 10, 11}, {8, 18, 4}}};
  EXPECT_EQ(choose_round(kWithin, 5), 2u) << "within the limit comes first";
}

TEST(ChooseRound, OfTwoRoundsAlikeTheOneThatMakesLessWorseIsTaken) {
  const RoundFigures given{20, 40, 5};
  EXPECT_EQ(choose_round(std::vector<RoundFigures>{given, {5, 10, 2, false, 3}, {5.2, 10.4, 2, false, 1}}, 8), 2u);
  EXPECT_EQ(choose_round(std::vector<RoundFigures>{given, {5, 10, 2, false, 3}, {6, 12, 2, false, 1}}, 8), 1u);
  EXPECT_EQ(choose_round(std::vector<RoundFigures>{given, {6, 12, 2, false, 1}, {5, 10, 2, false, 3}}, 8), 2u);
  // By more than 0.1 um.
  EXPECT_EQ(choose_round(std::vector<RoundFigures>{given, {5, 10, 2, false, 3.101}, {5.2, 10.4, 2, false, 3}}, 8), 2u);
  EXPECT_EQ(choose_round(std::vector<RoundFigures>{given, {5, 10, 2, false, 3.099}, {5.2, 10.4, 2, false, 3}}, 8), 1u);
}

}  // namespace
}  // namespace camber::compensate
