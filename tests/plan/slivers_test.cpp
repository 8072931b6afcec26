// Short walls, rounded corners and thin layers do not divide.
#include <random>

#include <gtest/gtest.h>

#include "plan/order.h"
#include "plan/part_of_stock.h"
#include "tests/support/block_part.h"

namespace camber::plan {
namespace {

using tests::box;
using Loop = std::vector<Vec2>;

Loop rectangle(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

/// Counter-clockwise, with corners of `radius` in `facets` chords each.
Loop rounded(double x0, double y0, double x1, double y1, double radius, int facets) {
  const std::array<Vec2, 4> middles{Vec2(x1 - radius, y0 + radius), Vec2(x1 - radius, y1 - radius),
                                    Vec2(x0 + radius, y1 - radius), Vec2(x0 + radius, y0 + radius)};
  Loop out;
  for (int corner = 0; corner < 4; ++corner)
    for (int k = 0; k <= facets; ++k) {
      const double a = kPi / 2 * (corner - 1 + static_cast<double>(k) / facets);
      out.push_back(middles[static_cast<std::size_t>(corner)] + radius * Vec2(std::cos(a), std::sin(a)));
    }
  return out;
}

Loop circle(double x, double y, double radius, int facets) {
  Loop out;
  for (int k = 0; k < facets; ++k)
    out.emplace_back(x + radius * std::cos(2 * kPi * k / facets), y + radius * std::sin(2 * kPi * k / facets));
  return out;
}

Loop turned_round(Loop loop) { return {loop.rbegin(), loop.rend()}; }

double area_of(const Loop& loop) {
  double sum = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec2 &a = loop[k], &b = loop[(k + 1) % loop.size()];
    sum += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  return sum;
}

bool closed(const TriangleSolid& solid) {
  TriangleMesh mesh;
  for (const Vec3& p : solid.points) mesh.points.push_back(p.cast<float>());
  mesh.triangles = solid.triangles;
  return mesh.closed();
}

RemovalVolume removal_of(const TriangleSolid& part, const machine::Box& blank, double narrowest_mm) {
  return removal_volume({.blank = solid_of(blank), .part = part, .narrowest_mm = narrowest_mm});
}

TEST(PolygonTriangles, FillARegionWithHolesAndIslands) {
  const std::vector<Loop> loops{rectangle(0, 0, 60, 40), turned_round(rounded(5, 5, 40, 35, 4, 5)),
                                circle(25, 20, 6, 24), turned_round(circle(50, 20, 4, 16)),
                                turned_round(circle(50, 30, 4, 16))};
  double wanted = 0, sum = 0;
  Loop all;
  for (const Loop& loop : loops) wanted += area_of(loop), all.insert(all.end(), loop.begin(), loop.end());
  for (const auto& [a, b, c] : triangles_of(loops)) {
    const double area = area_of({all[a], all[b], all[c]});
    EXPECT_GT(area, -1e-9);
    sum += area;
  }
  EXPECT_NEAR(sum, wanted, 1e-6);
  TriangleSolid solid;
  add_layer(solid, loops, -1, 2);
  EXPECT_TRUE(closed(solid));
  EXPECT_NEAR(volume_mm3(solid), 3 * wanted, 1e-6);
  const Loop ring = turned_round(circle(50, 10, 2, 12));
  for (const double bottom : {1.5, -1.0}) {
    TriangleSolid drilled;
    add_layer(drilled, loops, -1, 2, {{ring, bottom}});
    EXPECT_TRUE(closed(drilled));
    EXPECT_NEAR(volume_mm3(drilled), 3 * wanted + area_of(ring) * (2 - bottom), 1e-6);
  }
}

TEST(PolygonTriangles, FillStarsAtRandom) {
  std::mt19937 random(7);
  for (int star = 0; star < 200; ++star) {
    Loop loop, hole;
    const int points = std::uniform_int_distribution(5, 40)(random);
    for (int k = 0; k < points; ++k) {
      const double a = 2 * kPi * k / points, r = std::uniform_real_distribution(8.0, 30.0)(random);
      loop.emplace_back(std::round(1000 * r * std::cos(a)) / 1000, std::round(1000 * r * std::sin(a)) / 1000);
      hole.emplace_back(0.2 * loop.back());
    }
    const double wanted = area_of(loop) - area_of(hole);
    Loop all = loop;
    const Loop back = turned_round(hole);
    all.insert(all.end(), back.begin(), back.end());
    double sum = 0;
    for (const auto& [a, b, c] : triangles_of({loop, back})) {
      const double area = area_of({all[a], all[b], all[c]});
      EXPECT_GT(area, -1e-9);
      sum += area;
    }
    EXPECT_NEAR(sum, wanted, 1e-3) << star;
  }
}

TEST(Room, LeavesTheCornersOfASquareToARoundCutter) {
  TriangleSolid stays;
  add_layer(stays, {rectangle(0, 0, 60, 60), turned_round(rectangle(10, 10, 50, 50))}, 0, 10);
  const auto inside = [](double x, double y) { return x > 10 && x < 50 && y > 10 && y < 50; };
  for (const double r : {3.0, 8.0, 15.0}) {
    const double left = Room(stays, {10, 50, 10, 50}, r, 1).unreached_mm2(inside);
    EXPECT_LT(left, sharp_corners_mm2(r));
    EXPECT_GT(left, 0.45 * sharp_corners_mm2(r));  // outlines are within a step
  }
  EXPECT_EQ(Room(stays, {10, 50, 10, 50}, 8, 10).unreached_mm2(inside), 0);  // nothing is higher
}

TEST(Primitives, OfAPocketWithRoundedCornersAreOne) {
  for (const int facets : {2, 4, 9}) {
    TriangleSolid part;
    const Loop pocket = rounded(20, 15, 80, 45, 4, facets);
    add_layer(part, {rectangle(0, 0, 100, 60)}, 0, 10);
    add_layer(part, {rectangle(0, 0, 100, 60), turned_round(pocket)}, 10, 20);
    const RemovalVolume removal = removal_of(part, box(0, 0, 0, 100, 60, 20), 6);
    for (const DivisionPlan plan : kDivisionPlans) {
      const auto primitives = divide(removal, plan);
      ASSERT_EQ(primitives.size(), 1U) << facets;
      EXPECT_NEAR(primitives[0].volume_mm3, 10 * area_of(pocket), 0.1);
      EXPECT_NEAR(primitives[0].max_mm.x() - primitives[0].min_mm.x(), 60, 1e-6);
    }
    double least = 1e9;
    for (const InnerCorner& c : removal.corners)
      if (c.radius_mm > 0) least = std::min(least, c.radius_mm);
    EXPECT_NEAR(least, 4, 0.04) << facets;
  }
}

TEST(Primitives, OfAnObroundSlotAreOne) {
  TriangleSolid part;
  const Loop slot = rounded(20, 25, 80, 37, 6, 8);
  add_layer(part, {rectangle(0, 0, 100, 60)}, 0, 10);
  add_layer(part, {rectangle(0, 0, 100, 60), turned_round(slot)}, 10, 20);
  const auto primitives = divide(removal_of(part, box(0, 0, 0, 100, 60, 20), 6), DivisionPlan::largest);
  ASSERT_EQ(primitives.size(), 1U);
  EXPECT_NEAR(primitives[0].min_mm.x(), 20, 1e-6);
  EXPECT_NEAR(primitives[0].max_mm.y(), 37, 1e-6);
}

TEST(Primitives, TakeSliversBesideThemWithThem) {
  // Half a millimetre beside a pocket, as long as half of its side and a little more.
  const tests::BlockPart part{
      box(0, 0, 0, 100, 60, 20), {box(20, 10, 10, 80, 50, 20), box(80, 10, 10, 80.5, 32, 20)}, {}};
  const TriangleSolid solid = solid_of(part.mesh());
  for (const DivisionPlan plan : {DivisionPlan::yz, DivisionPlan::largest}) {
    EXPECT_EQ(divide(removal_of(solid, part.block, 0), plan).size(), 2U);
    const RemovalVolume removal = removal_of(solid, part.block, 3);
    const auto primitives = divide(removal, plan);
    ASSERT_EQ(primitives.size(), 1U);
    EXPECT_NEAR(primitives[0].volume_mm3, removal.removal_mm3(), 1e-3);
    const Order order = put_in_order(removal, primitives);
    ASSERT_EQ(order.steps.size(), 1U);
    EXPECT_EQ(order.steps[0].feature, Feature::closed_pocket);
  }
}

TEST(Primitives, LeaveASlotThatNoMillEntersByItself) {
  // Two millimetres wide, it opens into the pocket with its end: to be told, not to be hidden in the pocket.
  const tests::BlockPart part{
      box(0, 0, 0, 100, 60, 20), {box(20, 10, 10, 60, 50, 20), box(60, 30, 10, 90, 32, 20)}, {}};
  EXPECT_EQ(divide(removal_of(solid_of(part.mesh()), part.block, 3), DivisionPlan::largest).size(), 2U);
}

TEST(Primitives, TakeAThinLayerToTheOneBelow) {
  // A pocket in a pocket whose floors differ by 0.1 mm.
  const tests::BlockPart part{box(0, 0, 0, 100, 60, 20),
                              {box(10, 10, 12.1, 90, 50, 20), box(30, 10, 12, 60, 50, 20), box(30, 10, 8, 60, 50, 20)},
                              {}};
  const TriangleSolid solid = solid_of(part.mesh());
  EXPECT_EQ(divide(removal_of(solid, part.block, 0), DivisionPlan::largest).size(), 2U);
  const tests::BlockPart three{box(0, 0, 0, 100, 60, 20),
                               {box(10, 10, 12.1, 90, 50, 20), box(10, 10, 12, 60, 50, 20), box(30, 10, 8, 60, 50, 20)},
                               {}};
  const TriangleSolid of_three = solid_of(three.mesh());
  EXPECT_EQ(divide(removal_of(of_three, three.block, 0), DivisionPlan::largest).size(), 3U);
  const RemovalVolume removal = removal_of(of_three, three.block, 6);
  auto primitives = divide(removal, DivisionPlan::largest);
  ASSERT_EQ(primitives.size(), 3U);
  // The deep one reaches up through the thin layer; the rest of that is by itself.
  EXPECT_NEAR(primitives[0].max_mm.z(), 12.1, 1e-6);
  EXPECT_NEAR(primitives[1].max_mm.x() - primitives[1].min_mm.x(), 20, 1e-6);
  double sum = 0;
  for (const VolumePrimitive& p : primitives) sum += p.volume_mm3;
  EXPECT_NEAR(sum, removal.removal_mm3(), 1e-3);
}

TEST(Primitives, RoundBossesDoNotCutALayerFromTheOneWithoutThem) {
  // A boss narrower than the mill has no planes of its own: the layer above it is still another primitive.
  TriangleSolid part;
  add_layer(part, {rectangle(0, 0, 100, 60)}, 0, 10);
  add_layer(part, {circle(30, 30, 2.5, 32)}, 10, 14);
  const RemovalVolume removal = removal_of(part, box(0, 0, 0, 100, 60, 18), 6);
  const auto primitives = divide(removal, DivisionPlan::largest);
  ASSERT_EQ(primitives.size(), 2U);
  EXPECT_TRUE(primitives[0].contoured);
  EXPECT_FALSE(primitives[1].contoured);
  const Order order = put_in_order(removal, primitives);
  EXPECT_TRUE(order.unreachable.empty());
}

}  // namespace
}  // namespace camber::plan
