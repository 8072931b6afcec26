#include "report/summary.h"

#include <gtest/gtest.h>

namespace camber::report {
namespace {

TEST(LeftOverSentence, NamesTheGuardOnlyWhereItLeavesMost) {
  compensate::ErrorSplit left;
  left.correctable_p95_um = 24.181;
  left.correctable_um = 2;
  left.guard_um = 1;
  machine::Compensation asked;
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

}  // namespace
}  // namespace camber::report
