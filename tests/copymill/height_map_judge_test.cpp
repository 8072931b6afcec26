// The judge of emitted programs against shapes whose answers are known.
#include "tests/support/height_map_judge.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace judge {
namespace {

constexpr double kPi = 3.14159265358979323846;

void add_quad(std::vector<Triangle>& out, const Point& a, const Point& b, const Point& c, const Point& d) {
  out.push_back({a, b, c}), out.push_back({a, c, d});
}

void add_box(std::vector<Triangle>& out, const Point& lo, const Point& hi) {
  const auto corner = [&](int i) { return Point{i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z}; };
  for (const auto& f : {std::array{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}})
    add_quad(out, corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3]));
}

/// A plate of 40 x 30 x 5 with a wall of 10 on it, from x = 30 on.
PartMesh stepped_part() {
  std::vector<Triangle> t;
  add_box(t, {0, 0, 0}, {30, 30, 5});
  add_box(t, {30, 0, 0}, {40, 30, 10});
  return PartMesh(t);
}

Question question(const Cutter& cutter) {
  Question q{{0, 0, 0}, {40, 30, 10}};
  q.cell = 0.25;
  q.cutters[1] = cutter;
  return q;
}

std::vector<Piece> read(const std::string& text) { return ProgramReader().read("T1 M6\nG0 X-10 Y-10 Z20\n" + text); }

/// Clears the plate with a cutter of 8 mm, up to the wall less what is said.
std::string clearing(double wall_less_mm, double z) {
  std::string text;
  for (int y = -2; y <= 32; y += 3) {
    const std::string to = std::to_string(26 - wall_less_mm);
    text += "G0 X-10 Y" + std::to_string(y) + "\nG0 Z" + std::to_string(z) + "\nG1 X" + to + " F500\nG1 Y" +
            std::to_string(y + 3) + "\nG0 Z20\n";
  }
  return text;
}

}  // namespace

TEST(HeightMapJudge, LinesAndArcsAreReadAsTheyRun) {
  const auto pieces =
      read("G1 X0 Y0 Z1 F100 (to the start)\nG3 X-10 Y10 I-10 J0 ; quarter\nG91 G1 X1\nG90 G2 X-9 Y10 I5\n");
  double quarter = 0, circle = 0;
  for (const Piece& p : pieces) {
    if (p.line == 4) quarter += length(p.to - p.from);
    if (p.line == 6) circle += length(p.to - p.from);
  }
  EXPECT_NEAR(quarter, 5 * kPi, 1e-3);
  EXPECT_NEAR(circle, 10 * kPi, 1e-3);
  EXPECT_NEAR(pieces.back().to.x, -9, 1e-12);
  EXPECT_TRUE(pieces[0].rapid);
  EXPECT_FALSE(pieces[1].rapid);
  EXPECT_THROW(read("G81 X1 Y1 Z-3 R1\n"), std::runtime_error);
  EXPECT_THROW(read("G1 Xa\n"), std::runtime_error);
}

TEST(HeightMapJudge, ABallLeavesTheCuspsOfItsRowsAndFollowsSlopes) {
  const Cutter ball{6, 3};
  HeightMap map({0, 0, 0}, {20, 20, 10}, 0.05);
  Verdict v;
  // Two rows 2 mm apart up a slope of 30 degrees; across it cusps are as high as on the level.
  const double s = std::tan(kPi / 6);
  for (const double y : {9.0, 11.0}) map.cut({{-5, y, 2 - 5 * s}, {25, y, 2 + 25 * s}, 1, 1, false}, ball, v);
  // The lowest of a sphere on a slope: its centre is R up, and the tangent plane R along the normal from that.
  const double down = 3 - 3 / std::cos(kPi / 6), cusp = 3 - std::sqrt(9.0 - 1);
  EXPECT_NEAR(map.height_at(6, 9), 2 + 6 * s + down, 1e-6);
  EXPECT_NEAR(map.height_at(6, 10), 2 + 6 * s + down + cusp / std::cos(kPi / 6), 1e-6);
}

TEST(HeightMapJudge, AFlatEndMillTakesTheVolumeOfItsSlot) {
  HeightMap map({0, 0, 0}, {20, 20, 10}, 0.05);
  Verdict v;
  map.cut({{-5, 10, 8}, {25, 10, 8}, 1, 1, false}, {6, 0}, v);
  EXPECT_NEAR(v.removed / (6 * 20 * 2), 1, 0.02);
  EXPECT_EQ(map.height_at(10, 12.9), 8);
  EXPECT_EQ(map.height_at(10, 13.1), 10);
}

TEST(HeightMapJudge, WhatIsRightIsFoundRight) {
  const Verdict v = judge(read(clearing(0, 5)), stepped_part(), question({8, 0}));
  EXPECT_LT(v.gouge.depth, 1e-9);
  EXPECT_LT(v.left.depth, 1e-6);
  EXPECT_EQ(v.rapid.depth, 0);
  EXPECT_EQ(v.shank.depth, 0);
}

TEST(HeightMapJudge, DepthsIntoFloorAndWallAreAlongTheirNormals) {
  const Verdict floor = judge(read(clearing(0, 4.9)), stepped_part(), question({8, 0}));
  EXPECT_NEAR(floor.gouge.depth, 0.1, 1e-6);
  const Verdict wall = judge(read(clearing(-0.3, 5)), stepped_part(), question({8, 0}));
  // Points of the grid are 0.25 mm apart: the deepest in the wall is at 30.25 mm.
  EXPECT_NEAR(wall.gouge.depth, 0.25, 1e-6);
  EXPECT_EQ(wall.gouge.place.x, 30.25);
}

TEST(HeightMapJudge, WhatIsLeftIsAlongTheNormalToo) {
  const Verdict v = judge(read(clearing(0.6, 5)), stepped_part(), question({8, 0}));
  EXPECT_NEAR(v.left.depth, 0.5, 0.03);  // of 0.6 at the wall; points stand at 0.25 and 0.5
  EXPECT_NEAR(v.left_reachable.depth, 0.5, 0.03);
  Question allowed = question({8, 0});
  allowed.allowance = 0.6;
  EXPECT_EQ(judge(read(clearing(0.6, 5)), stepped_part(), allowed).left_area, 0);
}

TEST(HeightMapJudge, ACornerThatTheCutterCannotReachIsNamedSo) {
  const Verdict v = judge(read(clearing(0, 5)), stepped_part(), question({8, 2}));  // a bull-nose at the wall's foot
  EXPECT_GT(v.left.depth, 0.3);
  EXPECT_LT(v.left_reachable.depth, 0.15);  // rows 3 mm apart are within the flat bottom: the grid's own step
}

TEST(HeightMapJudge, RapidsShanksAndHoldersInMaterialAreFound) {
  const Verdict rapid = judge(read("G0 Z8\nG0 X20 Y15\n"), stepped_part(), question({8, 0}));
  EXPECT_NEAR(rapid.rapid.depth, 2, 1e-9);
  EXPECT_EQ(rapid.rapid.line, 4);
  Cutter stub{8, 0};
  stub.flutes = 3;
  const Verdict shank = judge(read("G1 Z5 F100\nG1 X5 Y15\n"), stepped_part(), question(stub));
  EXPECT_NEAR(shank.shank.depth, 2, 1e-9);
  Cutter held{8, 0};
  held.bodies = {{10, 4}};
  const Verdict holder = judge(read("G1 Z5 F100\nG1 X5 Y15\n"), stepped_part(), question(held));
  EXPECT_NEAR(holder.body.depth, 1, 1e-9);
  EXPECT_EQ(holder.shank.depth, 0);
}

}  // namespace judge
