#include "report/summary.h"

#include <gtest/gtest.h>

namespace camber::report {
namespace {

TEST(LeftOverSentence, NamesTheGuardOnlyWhereItLeavesMost) {
  compensate::ErrorSplit left;
  left.correctable_p95_um = 24.181;
  left.correctable_um = 2;
  left.guard_um = 1;
  machine::CompensationSettings asked;
  asked.tolerance_um = 0.5;
  EXPECT_EQ(left_over_sentence(left, asked),
            "of what a shift can correct 24.18 um (95th percentile) are left; tolerance_um = 0.5");
  left.guard_um = 10.9;
  EXPECT_EQ(
      left_over_sentence(left, asked),
      "of what a shift can correct 24.18 um (95th percentile) are left; tolerance_um = 0.5, most of it left so as "
      "to cut no more than 0.5 um into the part");
  asked.max_overcut_um = 20;
  EXPECT_TRUE(left_over_sentence(left, asked).ends_with("no more than 20 um into the part"));
}

TEST(CompensateText, TellsWhichPartOfAnOperationWasCompensated) {
  compensate::CompensationResult c;
  c.rounds.emplace_back();
  c.finishing.operations = {{1, 4, 9, 0.07, 3, 0}, {2, 12, 30, 0.9, 4, 3}, {3, 33, 40, 0.03, 2, 2}};
  const std::string text = compensate_text(c, 1);
  EXPECT_NE(text.find("T1, lines 4 to 9: simulated only, 7 % of the surface\n"
                      "T2, lines 12 to 30: compensated in 3 of 4 moves, 90 % of the surface\n"
                      "T3, lines 33 to 40: compensated, 3 % of the surface\n"),
            std::string::npos)
      << text;
}

}  // namespace
}  // namespace camber::report
