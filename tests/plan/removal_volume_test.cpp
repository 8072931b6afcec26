#include "plan/removal_volume.h"

#include <random>

#include <gtest/gtest.h>

#include "plan/order.h"
#include "tests/support/block_part.h"

namespace camber::plan {
namespace {

using tests::BlockHole;
using tests::BlockPart;
using tests::box;

RemovalVolume removal_of(const BlockPart& part, const machine::Box& blank) {
  return removal_volume({.blank = solid_of(blank), .part = solid_of(part.mesh()), .fixtures = {}, .faces = {}});
}

TEST(TriangleSolid, HasTheVolumeOfItsCells) {
  const BlockPart part{box(0, 0, 0, 60, 40, 20), {box(10, 10, 12, 30, 30, 20)}, {{45, 20, 10, 0}}};
  ASSERT_TRUE(part.mesh().closed());
  EXPECT_NEAR(volume_mm3(solid_of(part.mesh())), part.volume_mm3(), 0.02);
}

TEST(TriangleSolid, TellsWhereMaterialIsAlongALine) {
  const BlockPart part{box(0, 0, 0, 60, 40, 20), {box(10, -1, 5, 30, 41, 12)}, {}};
  const auto z = material_along_z(solid_of(part.mesh()), 20, 20);
  ASSERT_EQ(z.size(), 4U);
  EXPECT_NEAR(z[1], 5, 1e-6);
  EXPECT_NEAR(z[2], 12, 1e-6);
  EXPECT_TRUE(contains(solid_of(part.mesh()), {20, 20, 15}));
  EXPECT_FALSE(contains(solid_of(part.mesh()), {20, 20, 8}));
}

TEST(TriangleSolid, TellsWhereMaterialIsBesideAnUprightFacet) {
  // A micrometre outside the chord of a hole's facet, which rounding leaves an area as seen from above.
  const BlockPart part{box(0, 0, 0, 90.5, 65.5, 31.5), {}, {{46, 55.5, 10, 2}}};
  const TriangleSolid solid = solid_of(part.mesh());
  for (const double x : {43.490262187744143, 43.490262188, 43.4903})
    for (int i = 0; i < 200; ++i) {
      const auto z = material_along_z(solid, x - 1e-5 * i, 51.174874222457255);
      ASSERT_EQ(z.size(), 2U);
      EXPECT_NEAR(z[1], 31.5, 1e-6) << x - 1e-5 * i;
    }
}

TEST(Holes, HaveCentreDiameterAndDepth) {
  const BlockPart part{box(0, 0, 0, 60, 40, 20), {box(5, 5, 15, 55, 35, 20)}, {{45, 20, 10, 0}, {15, 20, 6.5, 4, 36}}};
  const Faces faces = find_faces(solid_of(part.mesh()), {});
  ASSERT_EQ(faces.holes.size(), 2U);
  EXPECT_NEAR(faces.holes[0].centre_mm.x(), 15, 1e-4);
  EXPECT_NEAR(faces.holes[0].diameter_mm, 6.5, 1e-4);
  EXPECT_NEAR(faces.holes[0].top_mm, 15, 1e-5);
  EXPECT_NEAR(faces.holes[0].bottom_mm, 4, 1e-5);
  EXPECT_NEAR(faces.holes[1].diameter_mm, 10, 1e-4);
  EXPECT_NEAR(faces.holes[1].volume_mm3, tests::block_part::polygon_mm2({0, 0, 10, 0}) * 15, 0.01);
  BlockPart filled = part;
  filled.holes.clear();
  EXPECT_NEAR(volume_mm3(faces.plugged), filled.volume_mm3(), 0.05);
}

TEST(RemovalVolume, IsBlankMinusPart) {
  const BlockPart part{
      box(0, 0, 0, 60, 40, 20), {box(10, 10, 12, 30, 30, 20), box(40, 0, 8, 60, 15, 20)}, {{45, 27, 10, 0}}};
  const auto blank = box(-2, -2, 0, 62, 42, 23);
  const RemovalVolume removal = removal_of(part, blank);
  const double wanted = (blank.max_mm - blank.min_mm).prod() - part.volume_mm3();
  EXPECT_NEAR(removal.removal_mm3(), wanted, 1e-3 * wanted);
  EXPECT_NEAR(removal.balance(), 0, 1e-3);
  EXPECT_EQ(removal.outside_mm3, 0);
  EXPECT_EQ(removal.grid.count(2), 4);  // 0, 8, 12, 20, 23
}

TEST(RemovalVolume, KnowsAPartThatSticksOut) {
  const BlockPart part{box(0, 0, 0, 60, 40, 20), {}, {}};
  const RemovalVolume removal = removal_of(part, box(5, 0, 0, 70, 40, 20));
  EXPECT_NEAR(removal.outside_mm3, 5 * 40 * 20, 1e-6);
}

TEST(RemovalVolume, LeavesOutHolesThatTheBlankHas) {
  const BlockPart cored{box(0, 0, 0, 60, 40, 20), {}, {{45, 20, 10, 0}}};
  const BlockPart part{box(0, 0, 0, 60, 40, 20), {box(10, 10, 12, 30, 30, 20)}, {{45, 20, 10, 0}}};
  const RemovalVolume removal =
      removal_volume({.blank = solid_of(cored.mesh()), .part = solid_of(part.mesh()), .fixtures = {}, .faces = {}});
  EXPECT_TRUE(removal.holes.empty());
  EXPECT_NEAR(removal.cells_mm3, 20 * 20 * 8, 1);
  EXPECT_NEAR(removal.outside_mm3, 0, 1e-6);
}

/// Points at random: in the removal volume where the blank has them and the part has not, and then in one primitive.
void expect_disjoint_union(const BlockPart& part, const machine::Box& blank, int points, unsigned seed) {
  const RemovalVolume removal = removal_of(part, blank);
  const TriangleSolid solid = solid_of(part.mesh());
  std::mt19937 random(seed);
  for (const DivisionPlan plan : kDivisionPlans) {
    const std::vector<VolumePrimitive> primitives = divide(removal, plan);
    double sum = 0;
    for (const VolumePrimitive& p : primitives) sum += p.volume_mm3;
    EXPECT_NEAR(sum, removal.removal_mm3(), 1e-3 * removal.removal_mm3());
    for (int i = 0; i < points; ++i) {
      Vec3 at;
      for (int a = 0; a < 3; ++a) at[a] = std::uniform_real_distribution(blank.min_mm[a], blank.max_mm[a])(random);
      int in = 0;
      for (const VolumePrimitive& p : primitives) {
        const bool within = (at.array() > p.min_mm.array()).all() && (at.array() < p.max_mm.array()).all();
        if (!within) continue;
        if (p.is_hole) {
          const Hole& h = removal.holes[p.hole];
          // Between the facets and the circle either answer is right.
          const double r = (Vec2(at.x(), at.y()) - h.centre_mm).norm() / h.diameter_mm * 2;
          if (r > 0.99 && r < 1.0) in = -99;
          in += r < 1;
        } else {
          ++in;
        }
      }
      if (in < 0) continue;
      EXPECT_EQ(in, contains(solid, at) ? 0 : 1) << at.transpose();
    }
  }
}

TEST(Primitives, FillTheRemovalVolumeWithoutOverlap) {
  const BlockPart part{box(0, 0, 0, 60, 40, 20),
                       {box(10, 10, 12, 30, 30, 20), box(25, 15, 6, 45, 20, 20), box(40, 0, 8, 60, 15, 20)},
                       {{50, 30, 6, 0}, {5, 35, 4, 10}}};
  expect_disjoint_union(part, box(-2, -2, 0, 62, 42, 23), 2000, 1);
}

TEST(Primitives, OfALDifferByPlan) {
  // An L in one layer: long along x below, short along y.
  const BlockPart part{box(0, 0, 0, 100, 60, 20), {box(10, 10, 10, 90, 30, 20), box(10, 30, 10, 40, 50, 20)}, {}};
  const RemovalVolume removal = removal_of(part, part.block);
  const auto yz = divide(removal, DivisionPlan::yz), zx = divide(removal, DivisionPlan::zx);
  const auto largest = divide(removal, DivisionPlan::largest);
  ASSERT_EQ(yz.size(), 2U);
  EXPECT_NEAR(yz[0].volume_mm3, 30 * 40 * 10, 1);
  EXPECT_NEAR(yz[1].volume_mm3, 50 * 20 * 10, 1);
  ASSERT_EQ(zx.size(), 2U);
  EXPECT_NEAR(zx[0].volume_mm3, 80 * 20 * 10, 1);
  ASSERT_EQ(largest.size(), 2U);
  EXPECT_NEAR(largest[0].volume_mm3, 80 * 20 * 10, 1);
}

TEST(Primitives, OfAPocketAreNotCutByThePlanesOfAnother) {
  const BlockPart part{box(0, 0, 0, 100, 60, 20), {box(10, 10, 10, 40, 50, 20), box(50, 20, 10, 90, 30, 20)}, {}};
  for (const DivisionPlan plan : kDivisionPlans) EXPECT_EQ(divide(removal_of(part, part.block), plan).size(), 2U);
}

}  // namespace
}  // namespace camber::plan
