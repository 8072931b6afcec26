#include "adapt/feed_chooser.h"

#include <limits>

#include <gtest/gtest.h>

#include "nc/interpreter.h"

namespace camber::adapt {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

/// A line of 100 mm along X at 10 mm/s, in cells of 1 mm.
FeedCells line_cells() {
  Diagnostics diagnostics;
  simulate::SimulatedProgram program{kinematics::open_program(
      SourceText("p.nc", "G21 G90 G94\nT1 M6\nS1000 M3\nG0 X0 Y0 Z0\nG1 X100 F600\nM30\n"), {}, {}, diagnostics)};
  program.selected.assign(program.moves_in_part().moves.size(), true);
  program.holes.assign(program.moves_in_part().moves.size(), removal::HoleMove::none);
  return {program, machine::Machine{}, std::vector<double>(program.moves_in_part().moves.size(), 1.0)};
}

constexpr FeedBounds kBounds{
    .lowest_mm_per_s = 2, .highest_mm_per_s = 50, .step_fraction = 0.05, .change_s = 0.03, .min_length_mm = 2};

FeedCeiling ceiling_of(const FeedCells& cells, double allowed) {
  return {std::vector<double>(cells.size(), allowed), std::vector<double>(cells.size(), 1000.0)};
}

TEST(FeedPlan, KeepsTheProgrammedFeedWhereItIsNear) {
  const FeedCells cells = line_cells();
  ASSERT_EQ(cells.size(), 100u);
  for (const double feed : plan_feeds(cells, ceiling_of(cells, 10.2), kBounds)) EXPECT_EQ(feed, 10);
  for (const double feed : plan_feeds(cells, ceiling_of(cells, 9.9), kBounds)) EXPECT_NEAR(feed, 9.9, 1e-9);
  for (const double feed : plan_feeds(cells, ceiling_of(cells, kInf), kBounds)) EXPECT_EQ(feed, 50);
  for (const double feed : plan_feeds(cells, ceiling_of(cells, 1), kBounds)) EXPECT_EQ(feed, 2);
  for (const double feed : plan_feeds(cells, ceiling_of(cells, -1), kBounds)) EXPECT_EQ(feed, 10);
}

TEST(FeedPlan, StaysBelowTheCeilingWithFewFeeds) {
  const FeedCells cells = line_cells();
  FeedCeiling ceiling = ceiling_of(cells, 40);
  for (std::size_t i = 0; i < cells.size(); ++i) ceiling.allowed_mm_per_s[i] = 40 - 0.3 * static_cast<double>(i);
  const std::vector<double> feeds = plan_feeds(cells, ceiling, kBounds);
  std::size_t changes = 0;
  double time = 0, best = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    EXPECT_LE(feeds[i], ceiling.allowed_mm_per_s[i] * (1 + 1e-9));
    changes += i > 0 && feeds[i] != feeds[i - 1] ? 1 : 0;
    time += 1 / feeds[i];
    best += 1 / ceiling.allowed_mm_per_s[i];
  }
  EXPECT_LT(changes, 30u);
  EXPECT_LT(time + static_cast<double>(changes) * kBounds.change_s, 1.2 * best);
}

TEST(FeedPlan, AsksForNoFeedThatTheControlDoesNotReach) {
  const FeedCells cells = line_cells();
  FeedCeiling ceiling = ceiling_of(cells, kInf);
  std::ranges::fill(ceiling.reachable_mm_per_s, 17.0);
  for (const double feed : plan_feeds(cells, ceiling, kBounds)) EXPECT_NEAR(feed, 17, 1e-9);
  // Slower than the programmed feed: nothing is gained by another one.
  std::ranges::fill(ceiling.reachable_mm_per_s, 7.0);
  for (const double feed : plan_feeds(cells, ceiling, kBounds)) EXPECT_EQ(feed, 10);
}

TEST(FeedPlan, AShortPassageIsNotWorthTwoFeeds) {
  const FeedCells cells = line_cells();
  FeedCeiling ceiling = ceiling_of(cells, 20);
  ceiling.allowed_mm_per_s[50] = 40;
  const std::vector<double> feeds = plan_feeds(cells, ceiling, kBounds);
  for (const double feed : feeds) EXPECT_NEAR(feed, 20, 1e-9);
}

TEST(LeastWithin, TakesTheLeastOfTheNeighbourhood) {
  const FeedCells cells = line_cells();
  std::vector<double> values(cells.size(), 9.0);
  values[40] = 3;
  values[60] = -1;
  const std::vector<double> least = least_within(cells, values, 2.0);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double expected = i == 60 ? -1 : i >= 38 - 1 && i <= 42 + 1 ? 3 : 9;
    EXPECT_EQ(least[i], expected) << i;
  }
}

}  // namespace
}  // namespace camber::adapt
