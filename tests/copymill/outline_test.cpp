#include "copymill/outline.h"

#include <cmath>

#include <gtest/gtest.h>

namespace camber::copymill {
namespace {

constexpr double kStep = 0.25;

std::vector<Outline> outlines_of(const Inside& inside, double half_mm) {
  const Grid grid = Grid::over({-half_mm, -half_mm}, {half_mm, half_mm}, 2.37 * kStep, kStep);
  std::vector<char> mask(grid.size());
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) mask[grid.index(i, j)] = inside(grid.at(i, j)) ? 1 : 0;
  std::vector<Outline> out;
  for (const Outline& loop :
       outlines(grid, mask, [&](const Vec2&in, const Vec2&outside) { return last_inside(inside, in, outside, 1e-5); }))
    out.push_back(refined(loop, inside, 0.001, kStep));
  return out;
}

double area_mm2(const Outline& loop) {
  double out = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec2 &a = loop[k], &b = loop[(k + 1) % loop.size()];
    out += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return out;
}

TEST(Outline, OfADiscLiesWithinTheToleranceAndRunsAroundItOnItsLeft) {
  const auto found = outlines_of([](const Vec2& p) { return p.norm() <= 4; }, 5);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(area_mm2(found[0]), kPi * 16, 0.03);
  for (std::size_t k = 0; k < found[0].size(); ++k) {
    const Vec2 middle = 0.5 * (found[0][k] + found[0][(k + 1) % found[0].size()]);
    EXPECT_LE(found[0][k].norm(), 4 + 1e-12);
    EXPECT_NEAR(middle.norm(), 4, 0.00101);
  }
}

TEST(Outline, OfATurnedRectangleHasItsCorners) {
  const double c = std::cos(0.3), s = std::sin(0.3);
  const auto inside = [&](const Vec2& p) {
    return std::abs(c * p.x() + s * p.y()) <= 3 && std::abs(-s * p.x() + c * p.y()) <= 2;
  };
  const auto found = outlines_of(inside, 5);
  ASSERT_EQ(found.size(), 1u);
  for (const Vec2& q : {Vec2(3, 2), Vec2(3, -2), Vec2(-3, 2), Vec2(-3, -2)}) {
    const Vec2 corner(c * q.x() - s * q.y(), s * q.x() + c * q.y());
    double nearest = 1;
    for (const Vec2& p : found[0]) nearest = std::min(nearest, (p - corner).norm());
    EXPECT_LT(nearest, 0.003);
  }
}

TEST(Outline, OfARingHasAClockwiseHole) {
  const auto found = outlines_of([](const Vec2& p) { return p.norm() <= 4 && p.norm() >= 2; }, 5);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(std::min(area_mm2(found[0]), area_mm2(found[1])), -kPi * 4, 0.03);
  EXPECT_NEAR(std::max(area_mm2(found[0]), area_mm2(found[1])), kPi * 16, 0.03);
}

TEST(Outline, DoesNotJoinOppositeCornersOfACell) {
  const Grid grid{{0, 0}, 1, 4, 4};
  std::vector<char> mask(grid.size(), 0);
  mask[grid.index(1, 1)] = mask[grid.index(2, 2)] = 1;
  EXPECT_EQ(outlines(grid, mask, [](const Vec2& a, const Vec2& b) -> Vec2 { return 0.5 * (a + b); }).size(), 2u);
}

}  // namespace
}  // namespace camber::copymill
