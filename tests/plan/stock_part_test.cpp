// A stock as a part: layers between its floors, holes apart.
#include "plan/part_of_stock.h"

#include <gtest/gtest.h>

#include "plan/order.h"

namespace camber::plan {
namespace {

TriangleMesh mesh_of(const TriangleSolid& solid) {
  TriangleMesh out;
  for (const Vec3& p : solid.points) out.points.push_back(p.cast<float>());
  out.triangles = solid.triangles;
  return out;
}

TEST(LayeredSolid, IsAClosedPrismOverARegionWithAHole) {
  TriangleSolid solid;
  // An L with a triangular hole; one side of the L is inclined.
  const std::vector<std::vector<Vec2>> loops{{{0, 0}, {30, 0}, {30, 10}, {12, 14}, {12, 25}, {0, 25}},
                                             {{2, 3}, {5, 8}, {8, 3}}};
  add_layer(solid, loops, -2, 3);
  const double l = 30 * 10 + 12 * 15 + 0.5 * 18 * 4, hole = 0.5 * 6 * 5;
  EXPECT_NEAR(volume_mm3(solid), (l - hole) * 5, 1e-9);
  EXPECT_TRUE(mesh_of(solid).closed());
  EXPECT_TRUE(contains(solid, {1, 1, 0}));
  EXPECT_TRUE(contains(solid, {20, 11, 0}));
  EXPECT_FALSE(contains(solid, {20, 13, 0}));
  EXPECT_FALSE(contains(solid, {5, 5, 0}));
  EXPECT_FALSE(contains(solid, {1, 1, 3.1}));
}

TEST(LayeredSolid, StacksOfLayersAreClosedToo) {
  TriangleSolid solid;
  add_layer(solid, {{{0, 0}, {20, 0}, {20, 20}, {0, 20}}}, 0, 5);
  add_layer(solid, {{{4, 4}, {16, 5}, {15, 16}, {5, 15}}}, 5, 9);
  EXPECT_TRUE(mesh_of(solid).closed());
  const std::vector<double> z = material_along_z(solid, 10, 10);
  ASSERT_EQ(z.size(), 2U);
  EXPECT_NEAR(z[1], 9, 1e-12);
}

/// A block of 50 x 40 x 20 whose top is cut down to 12 but for a round boss; a blind hole by a drill in the boss, a
/// through hole beside it, a pocket 5 mm deep.
double carved_mm(const Vec3& p) {
  const auto drilled = [&](double x, double y, double r, double top, double bottom) {
    const double cone = 0.5 * 118 * kPi / 180, out = std::hypot(p.x() - x, p.y() - y);
    const double wall = out - r, tip = bottom - r / std::tan(cone);
    const double point = out * std::cos(cone) - (p.z() - tip) * std::sin(cone);
    return std::max({wall, point, p.z() - top});
  };
  double d = removal::box_distance_mm(p, {0, 0, 0}, {50, 40, 20});
  d = std::max(d, std::min(p.z() - 12, std::max(p.z() - 20, std::hypot(p.x() - 12, p.y() - 12) - 6)));
  d = std::max(d, -removal::box_distance_mm(p, {22, 8, 7}, {46, 24, 30}));
  d = std::max(d, -drilled(12, 12, 2.5, 30, 9));
  return std::max(d, -drilled(14, 31, 3.5, 30, -5));
}

TEST(PartOfStock, HasTheWallsFloorsAndHolesOfTheStock) {
  const removal::Stock stock(carved_mm, {0, 0, 0}, {50, 40, 20}, 0.25, 3);
  const PartOfStock part = part_of(stock, solid_of(machine::Box{{0, 0, 0}, {50, 40, 22}}).bounds(), {});
  ASSERT_EQ(part.holes.size(), 2U);
  EXPECT_NEAR(part.holes[0].centre_mm.y(), 12, 0.005);
  EXPECT_NEAR(part.holes[0].diameter_mm, 5, 0.02);
  EXPECT_NEAR(part.holes[0].top_mm, 20, 0.01);
  EXPECT_NEAR(part.holes[0].bottom_mm, 9, 0.5);  // two slices
  EXPECT_NEAR(part.holes[0].tip_mm, 9 - 2.5 / std::tan(59 * kPi / 180), 0.05);
  EXPECT_NEAR(part.holes[1].diameter_mm, 7, 0.02);
  EXPECT_NEAR(part.holes[1].top_mm, 12, 0.01);
  EXPECT_NEAR(part.holes[1].bottom_mm, 0, 0.01);
  EXPECT_NEAR(part.holes[1].tip_mm, 0, 0.01);
  EXPECT_TRUE(mesh_of(part.solid).closed());
  const double filled = 50 * 40 * 12 + kPi * 36 * 8 - 24 * 16 * 5;
  EXPECT_NEAR(volume_mm3(part.solid), filled, 2e-3 * filled);
  EXPECT_TRUE(mesh_of(part.drilled).closed());
  const double tip = 9 - 2.5 / std::tan(59 * kPi / 180);
  EXPECT_NEAR(volume_mm3(part.solid) - volume_mm3(part.drilled), kPi * (2.5 * 2.5 * (20 - tip) + 3.5 * 3.5 * 12), 10);

  const RemovalVolume removal = removal_volume(
      {.blank = solid_of(machine::Box{{0, 0, 0}, {50, 40, 22}}), .part = part.solid, .part_holes = part.holes});
  EXPECT_NEAR(removal.balance(), 0, 1e-3);
  ASSERT_EQ(removal.holes.size(), 2U);
  const auto primitives = divide(removal, DivisionPlan::largest);
  const Order order = put_in_order(removal, primitives);
  EXPECT_TRUE(order.unreachable.empty());
  std::vector<std::string_view> features;
  for (const Step& s : order.steps) features.push_back(to_string(s.feature));
  EXPECT_EQ(features.front(), "face");
  EXPECT_NE(std::ranges::find(features, "closed pocket"), features.end());
  EXPECT_EQ(features[features.size() - 2], "blind hole");
  EXPECT_EQ(features.back(), "through hole");
}

TEST(MachinedSpace, HasNoRoomBetweenWallsAndARoundIsland) {
  std::vector<Vec2> pocket{{10, 10}, {10, 50}, {50, 50}, {50, 10}}, island;
  for (int i = 0; i < 48; ++i)
    island.emplace_back(30 + 14 * std::cos(2 * kPi * i / 48), 30 + 14 * std::sin(2 * kPi * i / 48));
  const std::vector<Vec2> block{{0, 0}, {60, 0}, {60, 60}, {0, 60}};
  TriangleSolid part;
  add_layer(part, {block}, 0, 5);
  add_layer(part, {block, pocket, island}, 5, 15);
  const RemovalVolume removal =
      removal_volume({.blank = solid_of(machine::Box{{0, 0, 0}, {60, 60, 15}}), .part = part});
  const auto primitives = divide(removal, DivisionPlan::largest);
  ASSERT_EQ(primitives.size(), 1U);
  const MachinedSpace work(removal, primitives);
  // 6 mm are between them. A cutter of 12 mm gets into the corners only, one of 6 mm everywhere but into their ends.
  EXPECT_TRUE(work.has_room(0, work.open_faces(0), 2.9));
  EXPECT_FALSE(work.has_room(0, work.open_faces(0), 6));
}

}  // namespace
}  // namespace camber::plan
