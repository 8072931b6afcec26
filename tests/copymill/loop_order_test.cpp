#include "copymill/levels.h"

#include <cmath>

#include <gtest/gtest.h>

namespace camber::copymill {
namespace {

Pass circle(const Vec2& middle, double radius) {
  Pass out{.points = {}, .closed = true};
  for (int k = 0; k < 72; ++k) {
    const double a = 2 * kPi * k / 72;
    out.points.emplace_back(middle.x() + radius * std::cos(a), middle.y() + radius * std::sin(a), -1);
  }
  return out;
}

double radius_mm(const Pass& pass, const Vec2& middle) { return (pass.points.front().head<2>() - middle).norm(); }

TEST(LoopOrder, EndsAtOneBossBeforeItGoesToTheNext) {
  const Vec2 left(0, 0), right(100, 0);
  LoopOrder order;
  for (const double r : {14.0, 12.0, 10.0}) order.add({circle(left, r), circle(right, r)}, 2, false);
  std::optional<Vec3> tip = Vec3(90, 0, -1);
  std::vector<double> at_right, at_left;
  while (const auto pass = order.next(tip)) {
    tip = pass->points.front();
    EXPECT_TRUE(tip->x() > 50 || at_right.size() == 3);
    (tip->x() < 50 ? at_left : at_right).push_back(radius_mm(*pass, tip->x() < 50 ? left : right));
  }
  ASSERT_EQ(at_right.size(), 3U);
  ASSERT_EQ(at_left.size(), 3U);
  for (const auto& radii : {at_right, at_left})
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(radii[k], 14 - 2.0 * static_cast<double>(k), 1e-9);
}

TEST(LoopOrder, WaitsForEveryLoopBeside) {
  // Two loops of the first distance lie beside the one of the second: it is the last, although it is the nearest.
  LoopOrder order;
  order.add({circle({0, 0}, 9), circle({20, 0}, 9)}, 2, false);
  Pass around{.points = {{-2, 11, -1}, {22, 11, -1}}, .closed = false};
  order.add({around}, 2, false);
  std::vector<std::size_t> sizes;
  const Vec3 tip(-2, 11, -1);
  while (const auto pass = order.next(tip)) sizes.push_back(pass->points.size());
  EXPECT_EQ(sizes, (std::vector<std::size_t>{72, 72, 2}));
}

TEST(LoopOrder, TurnsOpenLoopsWhereItMay) {
  for (const bool may_turn : {false, true}) {
    LoopOrder order;
    order.add({{.points = {{0, 0, -1}, {50, 0, -1}}, .closed = false}}, 2, may_turn);
    order.add({{.points = {{0, 2, -1}, {50, 2, -1}}, .closed = false}}, 2, may_turn);
    std::optional<Vec3> tip = Vec3(-5, 0, -1);
    double way = 0;
    while (const auto pass = order.next(tip)) way += (pass->points.front() - *tip).norm(), tip = pass->points.back();
    EXPECT_NEAR(way, may_turn ? 5 + 2 : 5 + std::hypot(50, 2), 1e-9);
  }
}

TEST(LoopOrder, IsEmptyWithoutLoops) {
  LoopOrder order;
  order.add({}, 2, false);
  EXPECT_FALSE(order.next(std::nullopt).has_value());
}

}  // namespace
}  // namespace camber::copymill
