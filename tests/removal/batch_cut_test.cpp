// BatchCut, and the distances that it asks for, against every stamp evaluated at every voxel.
#include "removal/field/upright/batch_cut.h"

#include <algorithm>
#include <memory>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "removal/simd/upright_distances.h"

namespace camber::removal {

using namespace upright;

namespace {

constexpr double kVoxel = 0.1, kBand = 0.5;
const Index3 kTile{-1, 2, 0};

struct Drawn {
  std::vector<Stamp> stamps;
  std::vector<std::int32_t> batch;
};

/// Rows that pass over the tile on a wavy floor, their stamps out of order or not.
Drawn rows(std::mt19937& random, double radius_mm) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double slope = 1.5 * (unit(random) - 0.5), step = 0.1 + 0.3 * unit(random), floor = 1.5 * unit(random) - 0.2;
  const Vec3 middle((kTile[0] + 0.5) * Tile::kCore * kVoxel, (kTile[1] + 0.5) * Tile::kCore * kVoxel, floor);
  Drawn d;
  for (double y = -radius_mm - 1; y < radius_mm + 1; y += 0.45)
    for (double x = -radius_mm - 1; x < radius_mm + 1; x += step) {
      Stamp s;
      s.pose.tip_mm = middle + Vec3(x, y, slope * x + 0.3 * std::sin(2 * y));
      d.batch.push_back(static_cast<std::int32_t>(d.stamps.size()));
      d.stamps.push_back(s);
    }
  if (unit(random) < 0.5) std::shuffle(d.stamps.begin(), d.stamps.end(), random);
  return d;
}

double left_by(const CutterShape& shape, const Stamp& stamp, double shrink_mm, const Vec3& voxel) {
  return std::min(-shape.distance_mm(voxel - stamp.pose.tip_mm) - shrink_mm, kBand);
}

void expect_every_voxel_as_the_deepest_leaves_it(machine::ToolType type, double corner_mm, double diameter_mm = 4,
                                                 double shrink_mm = 0) {
  machine::Tool tool;
  tool.type = type;
  tool.diameter_mm = diameter_mm;
  tool.corner_radius_mm = corner_mm;
  tool.flutes = 2;
  tool.overhang_mm = 20;
  const CutterShape shape = shape_of(tool);
  std::mt19937 random(7);
  for (int round = 0; round < 8; ++round) {
    const Drawn d = rows(random, diameter_mm / 2);
    auto tile = std::make_unique<Tile>();
    tile->distance.fill(static_cast<float>(-kBand));
    tile->stamp.fill(Stock::kUncut);
    ColumnCover cover(
        *tile, kTile, kVoxel, kBand, shape, [](std::int32_t, Vec3&, double&) { return false; }, shrink_mm);
    BatchCut batch_cut(shape, kVoxel, kBand, shrink_mm);
    // In two batches: the second meets columns that remember the first.
    const std::size_t half = d.batch.size() / 2;
    const std::span<const std::int32_t> all(d.batch);
    batch_cut.cut(*tile, cover, d.stamps, all.first(half), 100);
    batch_cut.cut(*tile, cover, d.stamps, all.subspan(half), 100);
    std::size_t cut = 0;
    for (int i = 0; i < Tile::kSide; ++i)
      for (int j = 0; j < Tile::kSide; ++j)
        for (int k = 0; k < Tile::kSide; ++k) {
          const Vec3 voxel =
              kVoxel * Vec3(kTile[0] * Tile::kCore + i, kTile[1] * Tile::kCore + j, kTile[2] * Tile::kCore + k);
          double wanted = -kBand;
          for (const Stamp& s : d.stamps) wanted = std::max(wanted, left_by(shape, s, shrink_mm, voxel));
          const auto at = static_cast<std::size_t>(Tile::offset(i, j, k));
          ASSERT_NEAR(static_cast<double>(tile->distance[at]), wanted, 2e-6) << round << ' ' << voxel.transpose();
          if (tile->stamp[at] == Stock::kUncut) {
            EXPECT_NEAR(wanted, -kBand, 2e-6);
            continue;
          }
          ++cut;
          EXPECT_NEAR(left_by(shape, d.stamps[static_cast<std::size_t>(tile->stamp[at] - 100)], shrink_mm, voxel),
                      wanted, 2e-6);
        }
    EXPECT_GT(cut, 500u);
  }
}

TEST(BatchCut, LeavesEveryVoxelAsTheDeepestBallDoes) {
  expect_every_voxel_as_the_deepest_leaves_it(machine::ToolType::ball, 0);
}

TEST(BatchCut, LeavesEveryVoxelAsTheDeepestFlatOrBullNoseDoes) {
  expect_every_voxel_as_the_deepest_leaves_it(machine::ToolType::flat, 0);
  expect_every_voxel_as_the_deepest_leaves_it(machine::ToolType::bull, 0.8);
}

TEST(BatchCut, LeavesEveryVoxelAsTheDeepestDoesUnderAWideBottom) {
  expect_every_voxel_as_the_deepest_leaves_it(machine::ToolType::flat, 0, 9);
  expect_every_voxel_as_the_deepest_leaves_it(machine::ToolType::flat, 0, 9, 0.3);
  expect_every_voxel_as_the_deepest_leaves_it(machine::ToolType::bull, 1.2, 9);
  expect_every_voxel_as_the_deepest_leaves_it(machine::ToolType::bull, 0.2, 9, 0.3);
}

}  // namespace
TEST(RoundedDistance, NoPlaceOfADiscIsNearerThanTold) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> fraction(-1, 1);
  for (const auto& [flat, corner] : {std::pair{0.0f, 5.0f}, std::pair{3.0f, 0.5f}, std::pair{5.0f, 0.0f}}) {
    float closest = 1e9f;
    for (int round = 0; round < 2000; ++round) {
      const float tip[3] = {6 * fraction(random), 6 * fraction(random), 6 * fraction(random)};
      const Eigen::Vector3f normal = Eigen::Vector3f(fraction(random), fraction(random), fraction(random)).normalized();
      const Eigen::Vector3f along = normal.unitOrthogonal(), aside = normal.cross(along);
      const Disc disc{{0, 0, 0}, {normal.x(), normal.y(), normal.z()}, 0.8f, 0.1f};
      float least = 0, at_centre = 0;
      rounded_distances_to(&tip[0], &tip[1], &tip[2], 1, disc, flat, corner, &least);
      rounded_distances(&tip[0], &tip[1], &tip[2], 1, 0, 0, 0, flat, corner, &at_centre);
      ASSERT_GE(least, at_centre - std::hypot(0.8f, 0.1f) - 1e-5f);
      for (int place = 0; place < 50; ++place) {
        const float angle = 3.2f * fraction(random);
        const Eigen::Vector3f p =
            0.8f * (std::cos(angle) * along + std::sin(angle) * aside) + 0.1f * fraction(random) * normal;
        float there = 0;
        rounded_distances(&tip[0], &tip[1], &tip[2], 1, p.x(), p.y(), p.z(), flat, corner, &there);
        ASSERT_GE(there, least - 1e-5f);
        closest = std::min(closest, there - least);
      }
    }
    EXPECT_LT(closest, 0.01f);  // and no wider than it need be
  }
}

}  // namespace camber::removal
