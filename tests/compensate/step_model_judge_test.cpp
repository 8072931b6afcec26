#include "compensate/judge.h"

#include <cmath>

#include <gtest/gtest.h>

namespace camber::compensate {
namespace {

ErrorSplit correctable(double um) {
  ErrorSplit out;
  out.correctable_um = um;
  return out;
}

/// rms after a step of the fraction t where the mean square is m - (2 t - c t^2) R.
double rms_after(double m, double r, double c, double t) { return std::sqrt(m - (2 * t - c * t * t) * r); }

TEST(StepModel, ExpectsAllThatCanBeCorrectedOfTheFirstStep) {
  const StepModel model;
  EXPECT_DOUBLE_EQ(model.expected_rms_um(5, correctable(4), 1), 3);
  EXPECT_DOUBLE_EQ(model.effect(0.5), 0.75);
  EXPECT_DOUBLE_EQ(model.best_fraction(1), 1);
}

TEST(StepModel, OneStepShowsHowFarTheNextOneShouldGo) {
  for (const double c : {1.0, 1.3, 2.5, 8.0})
    for (const double t : {0.25, 1.0}) {
      StepModel model;
      model.learn(std::sqrt(100.0), correctable(3), t, rms_after(100, 9, c, t));
      EXPECT_NEAR(model.best_fraction(1), 1 / c, 1e-9);
      EXPECT_NEAR(model.expected_rms_um(10, correctable(3), 1 / c), rms_after(100, 9, c, 1 / c), 1e-9);
      EXPECT_LE(model.best_fraction(0.1), 0.1);
    }
}

TEST(StepModel, AStepThatWouldMakeItWorseTakesNothingAway) {
  StepModel model;
  model.learn(10, correctable(3), 1, 11);
  EXPECT_EQ(model.effect(1), 0);
  EXPECT_EQ(model.expected_rms_um(10, correctable(3), 1), 10);
  EXPECT_GT(model.effect(model.best_fraction(1)), 0);
}

TEST(StepModel, ABetterStepThanExpectedPromisesNoMore) {
  StepModel model;
  model.learn(10, correctable(3), 1, 2);
  EXPECT_DOUBLE_EQ(model.effect(1), 1);
}

TEST(StepModel, LearnsNothingWhereNothingCanBeCorrected) {
  StepModel model;
  model.learn(10, correctable(0), 1, 12);
  EXPECT_DOUBLE_EQ(model.effect(1), 1);
}

}  // namespace
}  // namespace camber::compensate
