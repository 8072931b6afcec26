#include "plan/order.h"

#include <gtest/gtest.h>

#include "tests/support/block_part.h"

namespace camber::plan {
namespace {

using tests::BlockPart;
using tests::box;

struct Ordered {
  RemovalVolume removal;
  std::vector<VolumePrimitive> primitives;
  Order order;
  Ordered(const BlockPart& part, const machine::Box& blank, DivisionPlan plan = DivisionPlan::largest)
      : removal(removal_volume({.blank = solid_of(blank), .part = solid_of(part.mesh())})),
        primitives(divide(removal, plan)),
        order(put_in_order(removal, primitives)) {}
  const VolumePrimitive& of(std::size_t i) const { return primitives[order.steps[i].primitive]; }
};

// Each rule decides where those before it are tied.
TEST(ComesBefore, GreaterHeightOfTheTop) {
  EXPECT_TRUE(comes_before({false, 10, 5, 1, 9}, {false, 9, 500, 5, 0}));
  EXPECT_FALSE(comes_before({false, 9, 500, 5, 0}, {false, 10, 5, 1, 9}));
}
TEST(ComesBefore, GreaterVolumeAtEqualHeight) {
  EXPECT_TRUE(comes_before({false, 10, 500, 1, 9}, {false, 10, 400, 5, 0}));
}
TEST(ComesBefore, MoreOpenFacesAtEqualVolume) {
  EXPECT_TRUE(comes_before({false, 10, 500, 3, 9}, {false, 10, 500, 2, 0}));
}
TEST(ComesBefore, LessDistanceFromTheMiddleAtEqualFaces) {
  EXPECT_TRUE(comes_before({false, 10, 500, 3, 4}, {false, 10, 500, 3, 5}));
  EXPECT_FALSE(comes_before({false, 10, 500, 3, 5}, {false, 10, 500, 3, 5}));
}
TEST(ComesBefore, HolesLastWhateverTheOthersSay) {
  EXPECT_TRUE(comes_before({false, 1, 1, 1, 99}, {true, 10, 500, 5, 0}));
  EXPECT_FALSE(comes_before({true, 10, 500, 5, 0}, {false, 1, 1, 1, 99}));
}

TEST(Order, OpensFacesAsItGoes) {
  // A deep pocket under a shallow one: the deep one's top is not open before the shallow one is gone.
  const BlockPart part{
      box(0, 0, 0, 60, 60, 30), {box(10, 10, 20, 50, 50, 30), box(20, 20, 5, 40, 40, 20)}, {{5, 5, 4, 0}}};
  const Ordered o(part, box(0, 0, 0, 60, 60, 32));
  ASSERT_EQ(o.order.steps.size(), 4U);
  EXPECT_TRUE(o.order.unreachable.empty());
  EXPECT_EQ(o.order.steps[0].feature, Feature::face);
  EXPECT_EQ(o.order.steps[1].feature, Feature::closed_pocket);
  EXPECT_NEAR(o.of(1).min_mm.z(), 20, 1e-4);
  EXPECT_EQ(o.order.steps[2].feature, Feature::closed_pocket);
  EXPECT_NEAR(o.of(2).min_mm.z(), 5, 1e-4);
  EXPECT_TRUE(o.of(3).is_hole);
}

TEST(Order, SecondHalfOfAPocketIsASlot) {
  // Divided in two, the first half has one open face, the second also the side to the first.
  const BlockPart part{box(0, 0, 0, 100, 60, 20), {box(10, 10, 10, 60, 50, 20), box(60, 20, 10, 90, 40, 20)}, {}};
  const Ordered o(part, part.block, DivisionPlan::yz);
  ASSERT_EQ(o.order.steps.size(), 2U);
  EXPECT_EQ(o.order.steps[0].feature, Feature::closed_pocket);
  EXPECT_EQ(o.order.steps[1].feature, Feature::closed_slot);
  EXPECT_NEAR(o.order.steps[1].width_mm, 20, 1e-4);
}

TEST(Order, NamesWhatIsNotReachedFromAbove) {
  // A tunnel below the top.
  const BlockPart part{box(0, 0, 0, 60, 40, 20), {box(-1, 10, 5, 61, 30, 12)}, {}};
  const Ordered o(part, part.block);
  EXPECT_TRUE(o.order.steps.empty());
  ASSERT_EQ(o.order.unreachable.size(), 1U);
  EXPECT_EQ(o.order.unreachable[0].reason, "the part is above it");
}

TEST(Order, FixturesBlockWhatIsUnderThem) {
  const BlockPart part{box(0, 0, 0, 60, 40, 20), {}, {}};
  const RemovalVolume removal = removal_volume({.blank = solid_of(box(0, 0, 0, 60, 40, 25)),
                                                .part = solid_of(part.mesh()),
                                                .fixtures = {solid_of(box(-5, 10, 25, 10, 30, 30))}});
  const std::vector<VolumePrimitive> primitives = divide(removal, DivisionPlan::largest);
  const Order order = put_in_order(removal, primitives);
  ASSERT_FALSE(order.unreachable.empty());
  EXPECT_EQ(order.unreachable[0].reason, "a fixture is above it");
}

/// A part with one feature in a block of 60 x 40 x 20.
Feature feature_of_cut(const machine::Box& cut) {
  const BlockPart part{box(0, 0, 0, 60, 40, 20), {cut}, {}};
  const Ordered o(part, part.block);
  EXPECT_EQ(o.order.steps.size(), 1U);
  return o.order.steps.at(0).feature;
}

TEST(Features, OfPartsWithOneEach) {
  EXPECT_EQ(feature_of_cut(box(10, 10, 12, 40, 30, 20)), Feature::closed_pocket);
  EXPECT_EQ(feature_of_cut(box(30, 20, 12, 61, 41, 20)), Feature::open_pocket);
  EXPECT_EQ(feature_of_cut(box(10, 15, 12, 61, 25, 20)), Feature::closed_slot);
  EXPECT_EQ(feature_of_cut(box(-1, 15, 12, 61, 25, 20)), Feature::open_slot);
  EXPECT_EQ(feature_of_cut(box(-1, -1, 15, 61, 41, 21)), Feature::face);
  EXPECT_EQ(feature_of_cut(box(-1, -1, 12, 61, 15, 21)), Feature::step);
}

TEST(Features, OfHoles) {
  const BlockPart part{box(0, 0, 0, 60, 40, 20), {}, {{15, 20, 8, 0}, {45, 20, 8, 6}}};
  const Ordered o(part, part.block);
  ASSERT_EQ(o.order.steps.size(), 2U);
  EXPECT_EQ(o.order.steps[0].feature, Feature::through_hole);
  EXPECT_EQ(o.order.steps[0].open.count(), 2);
  EXPECT_EQ(o.order.steps[1].feature, Feature::blind_hole);
  EXPECT_EQ(o.order.steps[1].open.count(), 1);
}

TEST(Features, OfAFreeFormFace) {
  // A wedge: two triangles of the top go down along x.
  TriangleSolid part = solid_of(box(0, 0, 0, 60, 40, 20));
  for (Vec3& p : part.points)
    if (p.z() > 10 && p.x() > 30) p.z() = 12;
  const RemovalVolume removal = removal_volume({.blank = solid_of(box(0, 0, 0, 60, 40, 20)), .part = part});
  EXPECT_NEAR(removal.balance(), 0, 1e-6);
  const auto primitives = divide(removal, DivisionPlan::yz);
  ASSERT_EQ(primitives.size(), 1U);
  EXPECT_NEAR(primitives[0].volume_mm3, 60 * 40 * 8 / 2.0, 1e-6);
  EXPECT_EQ(put_in_order(removal, primitives).steps.at(0).feature, Feature::free_form);
}

TEST(MachinedSpace, TellsWhatStandsNearAndHasRoom) {
  const BlockPart part{box(0, 0, 0, 60, 40, 20), {box(10, 10, 12, 40, 30, 20)}, {}};
  const Ordered o(part, part.block);
  const MachinedSpace work(o.removal, o.primitives);
  EXPECT_NEAR(work.highest_near_mm(0, 5), 20, 1e-4);
  const OpenFaces open = work.open_faces(0);
  EXPECT_TRUE(work.has_room(0, open, 5));
  EXPECT_FALSE(work.has_room(0, open, 11));
  EXPECT_NEAR(work.wall_mm2(0), 2 * (30 + 20) * 8, 1e-2);
  EXPECT_NEAR(work.floor_mm2(0), 600, 1e-2);
}

}  // namespace
}  // namespace camber::plan
