#include "report/figures_json.h"
#include "report/verdict_text.h"

#include <gtest/gtest.h>

namespace camber::report {
namespace {

TEST(VerdictText, JudgesTheEmittedProgramAndNamesTheCauses) {
  compensate::CompensationResult c;
  machine::CompensationSettings asked;
  asked.tolerance_um = 5;
  c.verdict.within_tolerance = true;
  c.figures.after_um.p95 = 2.3;
  VerdictText v = verdict_text(c, asked);
  EXPECT_TRUE(v.success);
  EXPECT_EQ(v.headline,
            "within the tolerance: the form error of the emitted program is 2.30 um (95th percentile), tolerance_um = "
            "5");
  EXPECT_TRUE(v.reasons.empty());
  c.verdict.within_tolerance = false;
  c.figures.after_um.p95 = 11.3;
  c.verdict.causes = {
      {.cause = compensate::Cause::bow, .rms_um = 4.1, .lines = {{12, 12}, {14, 15}}, .remedies = {"a shorter tool"}}};
  v = verdict_text(c, asked);
  EXPECT_FALSE(v.success);
  EXPECT_EQ(v.headline,
            "over the tolerance: the form error of the emitted program is 11.30 um (95th percentile), tolerance_um = "
            "5");
  EXPECT_EQ(v.reasons, (std::vector<std::string>{
                           "4.10 um rms differs along the cutter (helix bow), most in lines 12, 14 (15 as emitted); "
                           "a shorter tool would remove it"}));
  c.figures.outlook = {37.55, 9.9};
  EXPECT_EQ(verdict_text(c, asked).reasons.front(),
            "before the rounds, shifts alone were expected to leave 9.90 um (95th percentile)");
  c.figures.outlook.achievable_p95_um = 4.9;
  EXPECT_EQ(verdict_text(c, asked).reasons.size(), 1u) << "within reach of a shift: nothing to say";
}

TEST(VerdictText, IsOnTheBandOrTheDeflectionWhereTheJobAsksForIt) {
  compensate::CompensationResult c;
  machine::CompensationSettings asked;
  asked.profile_um = {-5, 10};
  c.figures.plain_after.in_band_fraction = 0.9;
  EXPECT_EQ(verdict_text(c, asked).headline,
            "over the tolerance: 90.0 % of the area is within profile_um = [-5, 10]; 95 % was expected");
  asked.profile_um.reset();
  asked.reference = machine::Reference::machine;
  EXPECT_EQ(verdict_text(c, asked).headline,
            "over the tolerance: the deflection of the emitted program is 0.00 um (95th percentile), tolerance_um = 1");
}

TEST(VerdictText, NothingBetterTooDeepOrDoubtfulIsNoSuccess) {
  const machine::CompensationSettings asked;
  compensate::CompensationResult c;
  c.verdict.within_tolerance = true;
  c.safety.within_part = false;
  c.safety.depth_limit_um = 5;
  c.safety.after.gouge_depth_p999_um = 7;
  VerdictText v = verdict_text(c, asked);
  EXPECT_FALSE(v.success);
  EXPECT_EQ(v.headline, "gouge too deep");
  ASSERT_EQ(v.reasons.size(), 1u);
  EXPECT_TRUE(v.reasons[0].ends_with("no more than 5 um were expected")) << v.reasons[0];
  c.verdict.better = false;
  EXPECT_EQ(verdict_text(c, asked).headline, "no better program was found");
  c.verdict.doubts = {"chips and stock differ by 4 %"};
  v = verdict_text(c, asked);
  EXPECT_EQ(v.headline, "the figures are not reliable");
  EXPECT_EQ(v.reasons.front(), c.verdict.doubts[0]);
}

TEST(CompensateText, TellsWhichPartOfAnOperationWasCompensated) {
  compensate::CompensationResult c;
  c.rounds.emplace_back();
  c.scope.finishing.operations = {{1, 4, 9, 0.07, 3, 0}, {2, 12, 30, 0.9, 4, 3}, {3, 33, 40, 0.03, 2, 2}};
  const std::string text = compensate_text(c, 1);
  EXPECT_NE(text.find("T1, lines 4 to 9: simulated only, 7 % of the surface\n"
                      "T2, lines 12 to 30: compensated in 3 of 4 moves, 90 % of the surface\n"
                      "T3, lines 33 to 40: compensated, 3 % of the surface\n"),
            std::string::npos)
      << text;
}

}  // namespace
}  // namespace camber::report
