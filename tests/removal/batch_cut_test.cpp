// BatchCut against every stamp evaluated at every voxel.
#include "removal/batch_cut.h"

#include <algorithm>
#include <memory>
#include <random>

#include <gtest/gtest.h>

namespace camber::removal {
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
      s.tip_mm = middle + Vec3(x, y, slope * x + 0.3 * std::sin(2 * y));
      d.batch.push_back(static_cast<std::int32_t>(d.stamps.size()));
      d.stamps.push_back(s);
    }
  if (unit(random) < 0.5) std::shuffle(d.stamps.begin(), d.stamps.end(), random);
  return d;
}

double left_by(const CutterShape& shape, const Stamp& stamp, const Vec3& voxel) {
  return std::min(-shape.distance_mm(voxel - stamp.tip_mm), kBand);
}

void expect_every_voxel_as_the_deepest_leaves_it(machine::ToolType type, double corner_mm) {
  machine::Tool tool;
  tool.type = type;
  tool.diameter_mm = 4;
  tool.corner_radius_mm = corner_mm;
  tool.flutes = 2;
  tool.overhang_mm = 20;
  const CutterShape shape = shape_of(tool);
  std::mt19937 random(7);
  for (int round = 0; round < 8; ++round) {
    const Drawn d = rows(random, 2);
    auto tile = std::make_unique<Tile>();
    tile->distance.fill(static_cast<float>(-kBand));
    tile->stamp.fill(Stock::kUncut);
    ColumnCover cover(*tile, kTile, kVoxel, kBand, shape, [](std::int32_t, Vec3&, double&) { return false; });
    BatchCut batch_cut(shape, kVoxel, kBand, 0);
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
          for (const Stamp& s : d.stamps) wanted = std::max(wanted, left_by(shape, s, voxel));
          const auto at = static_cast<std::size_t>(Tile::offset(i, j, k));
          ASSERT_NEAR(static_cast<double>(tile->distance[at]), wanted, 2e-6) << round << ' ' << voxel.transpose();
          if (tile->stamp[at] == Stock::kUncut) {
            EXPECT_NEAR(wanted, -kBand, 2e-6);
            continue;
          }
          ++cut;
          EXPECT_NEAR(left_by(shape, d.stamps[static_cast<std::size_t>(tile->stamp[at] - 100)], voxel), wanted, 2e-6);
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

}  // namespace
}  // namespace camber::removal
