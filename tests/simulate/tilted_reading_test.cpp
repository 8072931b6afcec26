// A rigid tilted tool: stamps that are left out between two readings, against reading every one.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "tests/support/tilted_scene.h"

namespace camber::simulate {
namespace {

CutResult cut_leaning(const testing::TiltedScene& upright, std::size_t longest_gap) {
  const machine::Material material{2000, 700, 0, 15, 15, 0};
  const Mat3 turn =
      (Eigen::AngleAxisd(-0.7, Vec3::UnitY()) * Eigen::AngleAxisd(-0.7, Vec3::UnitX())).toRotationMatrix();
  const testing::TiltedScene scene = testing::turned(upright, turn);
  auto stock = testing::stock_of(upright, turn);
  sweep(stock, scene.tool, scene.stamps, 0, testing::kTiltedAllowance_mm);
  stock.clear_stamps();
  CutOptions options;
  options.coupling = machine::Coupling::rigid;
  options.envelope_step_mm = 0.06;
  options.rotation_step_rad = kPi / 90;
  options.longest_gap = longest_gap;
  return cut(stock, scene.tool, material, scene.stamps, {}, 0, options);
}

}  // namespace

TEST(TiltedReading, StampsThatAreLeftOutHaveTheLoadsOfReadOnes) {
  for (const testing::TiltedScene& scene : testing::scenes()) {
    SCOPED_TRACE(static_cast<int>(scene.tool.type));
    const CutResult all = cut_leaning(scene, 1), some = cut_leaning(scene, 8);
    EXPECT_EQ(all.read, scene.stamps.size());
    EXPECT_LT(some.read, 0.95 * static_cast<double>(all.read));
    double largest_N = 0, difference_N = 0;
    for (std::size_t k = 0; k < all.loads.size(); ++k) {
      largest_N = std::max(largest_N, all.loads[k].lateral_max_N);
      difference_N = std::max(difference_N, std::abs(all.loads[k].lateral_max_N - some.loads[k].lateral_max_N));
    }
    EXPECT_GT(largest_N, 40);
    EXPECT_LT(difference_N, 0.03 * largest_N);
    EXPECT_NEAR(some.chip_mm3, all.chip_mm3, 1e-3 * all.chip_mm3);
    // What is carved does not depend on it.
    EXPECT_EQ(some.stock_mm3, all.stock_mm3);
  }
}

}  // namespace camber::simulate
