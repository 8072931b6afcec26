#include "simulate/job_stock.h"

#include <random>

#include <gtest/gtest.h>

namespace camber::simulate {
namespace {

constexpr double kBand = 4;

removal::Stock stock_of(const machine::Job& job, const removal::Region* within) {
  return job_stock(
      job, kBand, [](const Vec3&, const Vec3&) {}, within);
}

/// Equal in the region; elsewhere material or air without a surface.
void expect_field_within(const machine::Job& job, const removal::Region& region) {
  const removal::Stock whole = stock_of(job, nullptr), part = stock_of(job, &region);
  EXPECT_EQ(part.min_mm(), whole.min_mm());
  EXPECT_EQ(part.max_mm(), whole.max_mm());
  EXPECT_LT(static_cast<double>(part.memory_bytes()), 0.4 * static_cast<double>(whole.memory_bytes()));
  std::mt19937 random(7);
  const auto any = [&](int a) {
    return std::uniform_real_distribution(whole.min_mm()[a] - 3, whole.max_mm()[a] + 3)(random);
  };
  int inside = 0, at_surface = 0, far = 0;
  const double tile_mm = removal::kTileVoxels * whole.voxel_mm();
  for (int n = 0; n < 200000; ++n) {
    const Vec3 p(any(0), any(1), any(2));
    if (region.contains(p)) {
      ASSERT_EQ(part.distance_mm(p), whole.distance_mm(p)) << p.transpose();
      ++inside;
      at_surface += std::abs(whole.distance_mm(p)) < 0.9 * whole.band_mm() ? 1 : 0;
    } else if (!region.wider(3 * tile_mm).contains(p)) {
      const Vec3 v = p / part.voxel_mm();
      const removal::Index3 nearest{static_cast<int>(v.x()), static_cast<int>(v.y()), static_cast<int>(v.z())};
      ASSERT_EQ(std::abs(part.voxel(nearest)), static_cast<float>(part.band_mm())) << p.transpose();
      ++far;
    }
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(at_surface, 100);
  EXPECT_GT(far, 1000);
}

removal::Region corner_region() {
  removal::Region out;
  out.add(Vec3(-10, -10, -8));
  out.add(Vec3(20, 25, 1e9));
  return out;
}

TEST(JobStock, OfABoxHasAFieldInTheRegionAlone) {
  machine::Job job;
  job.simulation.voxel_mm = 0.5;
  job.stock.box = machine::Box{{0, 0, -30}, {100, 90, 0}};
  expect_field_within(job, corner_region());
}

TEST(JobStock, OfACylinderHasAFieldInTheRegionAlone) {
  machine::Job job;
  job.simulation.voxel_mm = 0.5;
  job.stock.cylinder = machine::Cylinder{{50, 50, -30}, 100, 30};
  removal::Region region = corner_region();
  region.add(Vec3(40, 40, 0));
  expect_field_within(job, region);
}

TEST(JobStock, WithoutARegionIsSolidAndAir) {
  machine::Job job;
  job.simulation.voxel_mm = 0.5;
  job.stock.box = machine::Box{{0, 0, -30}, {100, 90, 0}};
  const removal::Region nothing;
  const removal::Stock part = stock_of(job, &nothing);
  EXPECT_TRUE(part.surface_tiles().empty());
  EXPECT_EQ(part.distance_mm({50, 50, -10}), -part.band_mm());
  EXPECT_EQ(part.distance_mm({50, 50, 10}), part.band_mm());
}

}  // namespace
}  // namespace camber::simulate
