#include "copymill/levels.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "test_paths.h"

namespace camber::copymill {
namespace {

/// The sample's pocket, 5 to 55 by 5 to 40, with an island, 24 to 36 by 17 to 27, 8 mm deep.
struct Island {
  explicit Island(double radius, double allowance = 0)
      : part(read_stl(CAMBER_SOURCE_DIR "/samples/14-copy-milling/island.stl")),
        field(part, {radius, 0, false, {}}, allowance),
        region({}, {0, 0}, {60, 45}),
        tips(field, region, 0.25) {}
  TriangleMesh part;
  TipField field;
  AxisRegion region;
  SampledTips tips;
};

double nearest_mm(const std::vector<FlatPass>& passes, const Vec2& p) {
  double out = 1e9;
  for (const FlatPass& pass : passes)
    for (std::size_t k = 0; k + (pass.closed ? 0 : 1) < pass.points.size(); ++k) {
      const Vec2 &a = pass.points[k], &b = pass.points[(k + 1) % pass.points.size()];
      const double t = std::clamp((p - a).dot(b - a) / std::max(1e-12, (b - a).squaredNorm()), 0.0, 1.0);
      out = std::min(out, (a + t * (b - a) - p).norm());
    }
  return out;
}

TEST(LevelRegion, OutlineOfAPocketIsARadiusFromItsWallsWithSharpCorners) {
  const Island at(4, 0.3);
  const LevelRegion level(at.tips, -3);
  EXPECT_TRUE(level.walled());
  EXPECT_EQ(level.components(), 1);
  const auto loops = level.loops(0);
  ASSERT_EQ(loops.size(), 2u);
  for (const Vec2& corner : {Vec2(9.3, 9.3), Vec2(50.7, 9.3), Vec2(50.7, 35.7), Vec2(9.3, 35.7)})
    EXPECT_LT(nearest_mm(loops, corner), 0.002);
  // Around the island's corner: a circle.
  for (const double a : {0.1, 0.8, 1.5})
    EXPECT_LT(nearest_mm(loops, Vec2(36, 27) + 4.3 * Vec2(std::cos(a), std::sin(a))), 0.002);
}

TEST(LevelRegion, LoopsLieAtTheirDistanceFromTheWalls) {
  const Island at(4);
  const LevelRegion level(at.tips, -3);
  constexpr double kGrid_mm = 0.05;  // a fifth of the step: at corners distances are not even between grid points
  for (const FlatPass& loop : level.loops(1.5))
    for (const Vec2& p : loop.points) EXPECT_NEAR(nearest_mm(level.loops(0), p), 1.5, kGrid_mm);
}

TEST(LevelRegion, AboveThePartTheRegionsBorderCounts) {
  const Island at(4);
  const LevelRegion level(at.tips, 1);
  EXPECT_FALSE(level.walled());
  EXPECT_NEAR(level.depth_mm(0), 22.5, 0.3);
}

TEST(LevelRegion, StretchesOfALineEndAtTheWalls) {
  const Island at(4);
  const LevelRegion level(at.tips, -3);
  const auto found = level.stretches({0, 22}, {60, 22});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].points[0].x(), 9, 0.001);
  EXPECT_NEAR(found[0].points[1].x(), 20, 0.001);
  EXPECT_NEAR(found[1].points[0].x(), 40, 0.001);
  EXPECT_NEAR(found[1].points[1].x(), 51, 0.001);
  EXPECT_FALSE(level.holds_line({12, 22}, {45, 22}));
  EXPECT_TRUE(level.holds_line({12, 10}, {45, 10}));
}

TEST(LevelRegion, IsEmptyBelowTheFloorAndForACutterThatDoesNotFit) {
  EXPECT_TRUE(LevelRegion(Island(4).tips, -8.5).empty());
  EXPECT_TRUE(LevelRegion(Island(18).tips, -3).empty());
}

TEST(LevelRegion, PiecesOfALoopEndWhereTheRegionDoes) {
  const Island whole(4);
  machine::CopyRegion half;
  half.box_mm = {Vec2(0, 0), Vec2(18, 45)};
  const AxisRegion region(half, {0, 0}, {60, 45});
  const SampledTips tips(whole.field, region, 0.25);
  const auto loops = LevelRegion(tips, -3).loops(0);
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_FALSE(loops[0].closed);
  EXPECT_NEAR(std::max(loops[0].points.front().x(), loops[0].points.back().x()), 18, 0.3);
}

}  // namespace
}  // namespace camber::copymill
