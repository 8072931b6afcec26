// Which stamps of a batch count: against every stamp, point by point.
#include "removal/field/upright/stamp_order.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace camber::removal {

using namespace upright;

namespace {

CutterShape cutter(machine::ToolType type, double diameter_mm, double corner_radius_mm = 0) {
  machine::Tool tool;
  tool.type = type;
  tool.diameter_mm = diameter_mm;
  tool.corner_radius_mm = corner_radius_mm;
  return shape_of(tool);
}

/// Steps of `step_mm` in a heading that wanders, with a sharp corner every 25 stamps.
std::vector<Stamp> wandering_path(std::mt19937& random, double step_mm, bool level) {
  std::normal_distribution<double> wander(0, 0.03);
  std::uniform_real_distribution<double> corner(-2.5, 2.5);
  std::vector<Stamp> out;
  Vec3 at = Vec3::Zero();
  double heading = 0, climb = 0;
  for (int i = 0; i < 300; ++i) {
    heading += i % 25 == 24 ? corner(random) : wander(random);
    climb = level ? 0 : std::clamp(climb + wander(random), -0.8, 0.8);
    const Vec3 f =
        step_mm * Vec3(std::cos(climb) * std::cos(heading), std::cos(climb) * std::sin(heading), std::sin(climb));
    Stamp s;
    at += f;
    s.pose.tip_mm = at;
    s.feed_per_tooth_mm = f;
    s.first = i == 0;
    out.push_back(s);
  }
  return out;
}

/// Points of the envelope that move into material since the stamp before must be nearer to that stamp, or to one that
/// is named, than to any other of their batch.
void expect_that_nobody_else_counts(const CutterShape& shape, double step_mm, bool level) {
  std::mt19937 random(7);
  const double length = shape.bottom_length_mm() + shape.arc_length_mm() + 2;
  std::size_t points = 0, named = 0;
  for (int path = 0; path < 5; ++path) {
    const auto stamps = wandering_path(random, step_mm, level);
    const StampOrder order = StampOrder::of_path(stamps, shape);
    for (std::int32_t k = 1; k < static_cast<std::int32_t>(stamps.size()); ++k) {
      const auto at = [&](std::int32_t i) -> const Vec3& { return stamps[static_cast<std::size_t>(i)].pose.tip_mm; };
      named += order.earlier(k).size();
      for (int r = 0; r < 12; ++r)
        for (int a = 0; a < 36; ++a) {
          const ProfilePoint p = shape.profile.at((r + 0.5) * length / 12);
          const double phi = 2 * kPi * a / 36;
          const Vec3 point = at(k) + Vec3(p.radius_mm * std::cos(phi), p.radius_mm * std::sin(phi), p.height_mm);
          const double since_before = shape.distance_mm(point - at(k - 1));
          if (since_before <= 0) continue;
          ++points;
          double left = since_before;
          if (order.batch(k - 1) != order.batch(k)) continue;
          for (const std::int32_t j : order.earlier(k)) left = std::min(left, shape.distance_mm(point - at(j)));
          for (std::int32_t j = k - 2; j >= 0 && order.batch(j) == order.batch(k); --j)
            ASSERT_GE(shape.distance_mm(point - at(j)), left - 2e-3 * step_mm) << "stamps " << k << " and " << j;
        }
    }
  }
  EXPECT_GT(points, 100000u);
  EXPECT_GT(named, 0u);  // corners
}

TEST(StampOrder, NamesEveryStampThatCountsOfABall) {
  expect_that_nobody_else_counts(cutter(machine::ToolType::ball, 10), 0.2, false);
}
TEST(StampOrder, NamesEveryStampThatCountsOfAFlatCutter) {
  expect_that_nobody_else_counts(cutter(machine::ToolType::flat, 10), 0.2, true);
}
TEST(StampOrder, NamesEveryStampThatCountsOfAFlatCutterThatClimbsAndDescends) {
  expect_that_nobody_else_counts(cutter(machine::ToolType::flat, 10), 0.2, false);
}
TEST(StampOrder, NamesEveryStampThatCountsOfABullNose) {
  expect_that_nobody_else_counts(cutter(machine::ToolType::bull, 12, 2), 0.1, false);
}

TEST(StampOrder, StraightPathsHaveLongBatchesInWhichNobodyElseCounts) {
  std::vector<Stamp> stamps(200);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    stamps[i].pose.tip_mm = {0.1 * static_cast<double>(i), 0.05 * static_cast<double>(i), 0};
    stamps[i].first = i == 0;
  }
  const StampOrder order = StampOrder::of_path(stamps, cutter(machine::ToolType::bull, 10, 1));
  for (std::int32_t k = 0; k < 200; ++k) EXPECT_TRUE(order.earlier(k).empty());
  EXPECT_LE(order.batch(199), 3);
}

TEST(StampOrder, AHelixOfAFlatCutterHasLongBatches) {
  std::vector<Stamp> stamps(300);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const double angle = 0.02 * static_cast<double>(i);
    stamps[i].pose.tip_mm = {10 * std::cos(angle), 10 * std::sin(angle), -0.005 * static_cast<double>(i)};
    stamps[i].first = i == 0;
  }
  const StampOrder order = StampOrder::of_path(stamps, cutter(machine::ToolType::flat, 12));
  EXPECT_LE(order.batch(299), 5);
}

TEST(CoarseToFine, VisitsEachOnceBetweenNeighboursThatWereVisited) {
  for (const std::int32_t count : {0, 1, 2, 3, 7, 8, 9, 100}) {
    std::vector<bool> seen(static_cast<std::size_t>(count), false);
    for_each_coarse_to_fine(count, [&](std::int32_t i, std::int32_t left, std::int32_t right) {
      ASSERT_FALSE(seen[static_cast<std::size_t>(i)]);
      EXPECT_TRUE(left < 0 || (seen[static_cast<std::size_t>(left)] && left < i));
      EXPECT_TRUE(right < 0 || (seen[static_cast<std::size_t>(right)] && right > i));
      seen[static_cast<std::size_t>(i)] = true;
    });
    EXPECT_EQ(std::count(seen.begin(), seen.end(), true), count);
  }
}

}  // namespace
}  // namespace camber::removal
