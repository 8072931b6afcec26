#include "adapt/feed_chooser.h"

#include <gtest/gtest.h>

#include "nc/interpreter.h"

namespace camber::adapt {
namespace {

/// Ten cells of 1 mm.
FeedCells ten_cells() {
  Diagnostics diagnostics;
  simulate::SimulatedProgram program{kinematics::open_program(
      SourceText("p.nc", "G21 G90 G94\nT1 M6\nS1000 M3\nG0 X0 Y0 Z0\nG1 X10 F600\nM30\n"), {}, {}, diagnostics)};
  program.selected.assign(program.moves_in_part().moves.size(), true);
  program.holes.assign(program.moves_in_part().moves.size(), removal::HoleMove::none);
  return {program, machine::Machine{}, std::vector<double>(program.moves_in_part().moves.size(), 1.0)};
}

struct Predictions {
  FeedCells cells = ten_cells();
  FeedBrackets brackets{cells};
  /// The whole path at one speed; a load is observed in cell 5 alone.
  void add(double speed, double load) {
    std::vector<double> loads(cells.size(), 0.0);
    loads[5] = load;
    brackets.add(std::vector<double>(cells.size(), speed), loads);
  }
};

TEST(FeedBrackets, TheModelStandsWhereNothingWasSeen) {
  Predictions run;
  run.add(10, 0.3);
  EXPECT_EQ(run.brackets.speed_mm_per_s(0, 12, 0.97), 12);
  EXPECT_EQ(run.brackets.speed_mm_per_s(5, 12, 0.97), 12) << "too far from the limit to extrapolate";
}

TEST(FeedBrackets, ALoadNearTheLimitGrowsNoFasterThanTheFeed) {
  Predictions run;
  run.add(10, 0.8);
  EXPECT_DOUBLE_EQ(run.brackets.speed_mm_per_s(5, 9, 0.96), 12);
  EXPECT_EQ(run.brackets.speed_mm_per_s(5, 13, 0.96), 13) << "the model allows more";
}

TEST(FeedBrackets, BetweenTwoPredictionsTheFeedIsInterpolated) {
  Predictions run;
  run.add(10, 0.5);
  run.add(30, 1.5);
  run.add(40, 3);  // farther away
  run.add(5, 0.2);
  EXPECT_DOUBLE_EQ(run.brackets.speed_mm_per_s(5, 100, 0.9), 18);
  EXPECT_DOUBLE_EQ(run.brackets.speed_mm_per_s(3, 100, 0.9), 18) << "passings fall elsewhere at another feed";
  EXPECT_EQ(run.brackets.speed_mm_per_s(8, 100, 0.9), 100);
}

TEST(FeedBrackets, NeverAboveASpeedThatExceededTheLimit) {
  Predictions run;
  run.add(30, 1.2);
  EXPECT_EQ(run.brackets.speed_mm_per_s(5, 100, 0.9), 30);
  EXPECT_EQ(run.brackets.speed_mm_per_s(5, 20, 0.9), 20);
}

}  // namespace
}  // namespace camber::adapt
