// Copy milling for those who want the path alone: no loads are read.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "copymill/copy_milling.h"
#include "tests/copymill/small_copy.h"

namespace camber::copymill {
namespace {

constexpr const char* kSlot =
    "[[copy]]\ntool = 1\nmode = \"contour-line\"\nspindle_rpm = 2000\nfeed_mm_per_min = 3000\nradial_depth_mm = 4\n"
    "axial_depth_mm = 4\n[[copy]]\ntool = 3\nmode = \"drilling\"\nspindle_rpm = 2000\nfeed_mm_per_min = 300\n"
    "axial_depth_mm = 3\nholes_mm = [[30, 15]]\nregion = { z_mm = [-11, -6] }\n";

CopyResult slot(const std::string& operations, const CopyOptions& options) {
  const tests::TempFolder folder;
  const tests::ReadCopy read = tests::read_copy(
      folder, {.part = "slot", .stock = "box_mm = [[0, 0, -12], [60, 30, 0]]", .operations = operations});
  Diagnostics diagnostics;
  return copy(read.job, read.operations, options, diagnostics);
}

TEST(UnreadLoads, LeaveThePathAndTheStockAsTheyAre) {
  std::vector<std::size_t> begun;
  std::vector<double> before;
  const CopyResult with = slot(kSlot, {}),
                   without = slot(kSlot, {.loads = false, .before = [&](std::size_t k, const auto&stock) {
                                            begun.push_back(k);
                                            before.push_back(stock.volume_mm3());
                                          }});
  EXPECT_EQ(with.text, without.text);
  EXPECT_GT(with.operations.at(0).load.max_N, 0);
  EXPECT_EQ(without.operations.at(0).load.max_N, 0);
  EXPECT_NEAR(without.removed_mm3, with.removed_mm3, 2e-4 * with.removed_mm3);
  EXPECT_NEAR(without.operations.at(1).removed_mm3, with.operations.at(1).removed_mm3, 0.2);
  EXPECT_EQ(begun, (std::vector<std::size_t>{0, 1}));
  EXPECT_NEAR(before[0] - before[1], without.operations.at(0).removed_mm3, 0.02 * with.removed_mm3);
  double farthest = 0;
  for (double x = 1; x < 60; x += 0.7)
    for (double y = 1; y < 30; y += 0.7)
      for (double z = -11.9; z < 0; z += 0.45)
        farthest =
            std::max(farthest, std::abs(with.stock->distance_mm({x, y, z}) - without.stock->distance_mm({x, y, z})));
  EXPECT_LT(farthest, 0.002);
}

TEST(UnreadLoads, AreReadAllTheSameWhereTheFeedFollowsThem) {
  const std::string followed =
      "[[copy]]\ntool = 1\nmode = \"contour-line\"\nspindle_rpm = 2000\nfeed_mm_per_min = 3000\nradial_depth_mm = 4\n"
      "axial_depth_mm = 6\nforce_N = 120\n";
  const CopyResult r = slot(followed, {.loads = false});
  EXPECT_GT(r.operations.at(0).load.max_N, 0);
  EXPECT_GT(r.operations.at(0).changes.size(), 0u);
}

}  // namespace
}  // namespace camber::copymill
