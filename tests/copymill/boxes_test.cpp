// Regions of several boxes, each with its own levels.
#include <gtest/gtest.h>

#include "copymill/levels.h"
#include "tests/copymill/small_copy.h"
#include "tests/support/block_part.h"

namespace camber::copymill {
namespace {

using tests::read_copy;
using tests::ReadCopy;
using tests::TempFolder;

const char* kKeys =
    "[[copy]]\ntool = 1\nmode = \"contour-line\"\nspindle_rpm = 8000\nfeed_mm_per_min = 3000\nradial_depth_mm = 4\n";

TEST(Boxes, HoldTheirPlacesAtTheirLevels) {
  machine::CopyRegion given;
  given.boxes_mm = {{Vec3(0, 0, -5), Vec3(20, 10, 0)}, {Vec3(0, 0, -9), Vec3(8, 10, -5)}};
  const AxisRegion region(given, {-50, -50}, {50, 50});
  EXPECT_EQ(region.min_mm(), Vec2(0, 0));
  EXPECT_EQ(region.max_mm(), Vec2(20, 10));
  EXPECT_TRUE(region.contains({15, 5}, -5));  // the bottom belongs to a box
  EXPECT_FALSE(region.contains({15, 5}, -5.1));
  EXPECT_TRUE(region.contains({5, 5}, -9));
  EXPECT_FALSE(region.contains({5, 5}, -9.1));
  EXPECT_FALSE(region.contains({5, 5}, 0));  // its top does not
  EXPECT_TRUE(region.contains({15, 5}));
  EXPECT_FALSE(region.contains({25, 5}));
}

TEST(Boxes, FloorsAreCutAfterTheEvenLevelBelow) {
  machine::CopyRegion given;
  given.boxes_mm = {{Vec3(0, 0, -5), Vec3(20, 10, 0)}, {Vec3(0, 0, -9), Vec3(8, 10, -5)}};
  const AxisRegion region(given, {0, 0}, {0, 0});
  const BoxLevels levels = box_levels(0, -8.8, {-5.00001, -2}, region, 0.2);
  double level = 0;
  ASSERT_TRUE(levels.even.next(0, 5, level));
  EXPECT_NEAR(level, -4.4, 1e-12);
  EXPECT_EQ(levels.floors_between(0, level), (std::vector<double>{-1.8}));
  double last = 0;
  ASSERT_TRUE(levels.even.next(level, 5, last));
  EXPECT_NEAR(last, -8.8, 1e-12);
  // Of the mesh's and the table's height of one floor the higher; then the box's own bottom.
  const std::vector<double> between = levels.floors_between(level, last);
  ASSERT_EQ(between.size(), 2U);
  EXPECT_DOUBLE_EQ(between[0], -4.8);
  EXPECT_DOUBLE_EQ(between[1], -5);
  EXPECT_FALSE(levels.even.next(last, 5, level));
}

/// A block whose upper step has a floor at -3.4037 and whose lower one one at -6.2.
tests::BlockPart stepped() {
  return {.block = tests::box(0, 0, -15, 60, 45, 0),
          .pockets = {tests::box(-1, -1, -3.4037, 25, 46, 1), tests::box(25, -1, -6.2, 40, 46, 1)},
          .holes = {}};
}

CopyResult copied(const TempFolder& folder, const std::string& keys) {
  ReadCopy read = read_copy(folder, {.operations = std::string(kKeys) + keys});
  read.job.part.mesh = folder / "part.stl";
  tests::write_stl(stepped().mesh(), read.job.part.mesh);
  Diagnostics diagnostics;
  return copy(read.job, read.operations, {.loads = false}, diagnostics);
}

double closed_form_mm3(double allowance) {
  return (25 * (3.4037 - allowance) + (15 - allowance) * (6.2 - allowance)) * 45;
}

TEST(Boxes, OfAnUpperAndALowerPrimitiveAreCutInOne) {
  const TempFolder folder;
  const CopyResult r = copied(folder,
                              "axial_depth_mm = 4\nallowance_mm = 0.1\nregion = { boxes_mm = [[-5, -5, "
                              "-3.4037, 40, 50, 0], [25, -5, -6.2, 40, 50, -3.4037]] }\n");
  EXPECT_NEAR(r.removed_mm3, closed_form_mm3(0.1), 0.002 * closed_form_mm3(0.1));
  EXPECT_LT(r.path_depth_um, 1);
  // Even ones at -3.05 and -6.1, and the upper step's floor with and without the allowance; heights of the mesh, which
  // has single precision, may come twice.
  EXPECT_GE(r.operations.at(0).levels, 4U);
  EXPECT_LE(r.operations.at(0).levels, 5U);
}

TEST(Boxes, OfTheLowerPrimitiveAloneLeaveTheUpperOne) {
  const TempFolder folder;
  const CopyResult r = copied(folder, "axial_depth_mm = 7\nregion = { boxes_mm = [[29, -5, -6.2, 36, 50, 0]] }\n");
  EXPECT_NEAR(r.removed_mm3, 15 * 6.2 * 45, 0.002 * 15 * 6.2 * 45);
}

/// A floor at a height that is no whole micrometre was not reached: the level went 0.3 um below it, where the tool may
/// not stand.
TEST(Boxes, FloorsBetweenMicrometresAreReached) {
  const TempFolder folder;
  const CopyResult r = copied(folder, "axial_depth_mm = 7\nregion = { box_mm = [[-5, -5], [40, 50]] }\n");
  EXPECT_NEAR(r.removed_mm3, closed_form_mm3(0), 0.002 * closed_form_mm3(0));
  EXPECT_LT(r.left.p95_um, 5);
}

/// Of all distances, that of grid points too: the loop there was lost, and with it what it was to cut.
TEST(Boxes, LoopsAtTheDistanceOfGridPointsAreThere) {
  const TriangleMesh part = stepped().mesh();
  const TipField field(part, {4, 0, false, {}}, 0);
  const AxisRegion region({}, {0, 0}, {60, 45});
  const SampledTips tips(field, region, 0.2);
  const LevelRegion level(tips, static_cast<float>(-3.4037));
  for (const double back : {2.0, 1.0, 1.99}) {
    const auto loops = level.loops(level.depth_mm(0) - back);
    ASSERT_EQ(loops.size(), 1U) << back;
    for (const Vec2& p : loops[0].points) EXPECT_NEAR(p.x(), 36 - level.depth_mm(0) + back, 0.01) << back;
  }
}

TEST(Boxes, AreWrittenAsTheyAreRead) {
  const TempFolder folder;
  const ReadCopy read = read_copy(
      folder, {.operations = std::string(kKeys) + "axial_depth_mm = 4\nregion = { boxes_mm = [[-5, -5, -3.4037, 40, "
                                                  "50, 0], [25, -5, -6.2, 40, 50, -3.4037]] }\n"});
  const machine::CopyRegion& region = read.operations.at(0).region;
  ASSERT_EQ(region.boxes_mm.size(), 2U);
  EXPECT_EQ(*region.z_mm, (std::array{-6.2, 0.0}));
  EXPECT_NE(to_toml(read.operations[0])
                .find("region = { boxes_mm = [[-5, -5, -3.4037, 40, 50, 0], [25, -5, -6.2, 40, 50, -3.4037]] }\n"),
            std::string::npos)
      << to_toml(read.operations[0]);
}

}  // namespace
}  // namespace camber::copymill
