#include "copymill/clear_height.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "copymill/standing.h"
#include "machine/tool.h"

namespace camber::copymill {
namespace {

constexpr double kVoxel_mm = 0.5, kTop_mm = 10;
const Vec3 kMin(0, 0, 0), kMax(40, 20, kTop_mm);

removal::Stock block() {
  const auto distance = [](const Vec3& p) {
    const Vec3 out = (kMin - p).cwiseMax(p - kMax);
    const double inside = std::min(0.0, out.maxCoeff());
    return out.cwiseMax(0).norm() + inside;
  };
  return {distance, kMin, kMax, kVoxel_mm, 4};
}

removal::CutterShape cutter(machine::ToolType type, double diameter_mm) {
  machine::Tool tool;
  tool.type = type;
  tool.diameter_mm = diameter_mm;
  if (type == machine::ToolType::drill) tool.point_angle_rad = kPi * 118 / 180;
  return removal::shape_of(tool);
}

TEST(ClearHeight, StaysUpOverAFinThatNoMiddleOfACellIsIn) {
  const removal::Stock stock = block();
  const removal::CutterShape flat = cutter(machine::ToolType::flat, 12);
  ClearHeight clear(stock, 12);
  Standing standing(stock, 0.3, 0);
  // The fin: Y 10.0 to 10.02. Middles of Standing's cells are at 9.75, 10.05 and so on, those of these at 9.9 and 10.5.
  for (const double y : {4.0, 16.02})
    for (int i = 0; i <= 224; ++i) {
      const double x = -8 + 0.25 * i;
      clear.lower(flat, {x, y, 3});
      standing.cut(flat, {x - 0.25, y, 3}, {x, y, 3});
    }
  EXPECT_FALSE(standing.meets(flat, {20, 10, 3}, 0.02)) << "else the fin is not narrow enough for this test";
  EXPECT_NEAR(clear.lowest_clear_tip_mm(flat, {20, 10}), kTop_mm, 1e-5);
  EXPECT_NEAR(clear.over_mm({19, 8}, {21, 12}), kTop_mm, 1e-5);
  EXPECT_NEAR(clear.lowest_clear_tip_mm(flat, {20, 3}), 3, 1e-5);
  EXPECT_NEAR(clear.over_mm({19, 1}, {21, 8}), 3, 1e-5);
}

TEST(ClearHeight, IsNeverBelowWhatStandsAndNotAboveItAwayFromEdges) {
  const removal::Stock stock = block();
  std::mt19937 random(7);
  const auto between = [&](double from, double to) { return std::uniform_real_distribution<>(from, to)(random); };
  for (const auto& [type, diameter] : {std::pair{machine::ToolType::flat, 6.0}, std::pair{machine::ToolType::ball, 6.0},
                                       std::pair{machine::ToolType::drill, 8.0}}) {
    const removal::CutterShape shape = cutter(type, diameter);
    ClearHeight clear(stock, 6);
    std::vector<Vec3> tips;
    for (int k = 0; k < 60; ++k) {
      tips.emplace_back(between(-2, 42), between(-2, 22), between(1, 9));
      clear.lower(shape, tips.back());
    }
    const auto stands = [&](const Vec2& p) {
      double z = kTop_mm;
      for (const Vec3& tip : tips) z = std::min(z, tip.z() + underside_mm(shape, (p - tip.head<2>()).norm()));
      return z;
    };
    const removal::CutterShape needle = cutter(machine::ToolType::flat, 1e-3);
    int tight = 0;
    for (int k = 0; k < 20000; ++k) {
      const Vec2 p(between(0, 40), between(0, 20));
      const double bound = clear.lowest_clear_tip_mm(needle, p);
      EXPECT_GE(bound, stands(p) - 1e-4) << p.transpose();
      if (bound < stands(p) + 0.5) ++tight;
    }
    EXPECT_GT(tight, 12000) << "a bound that is of use";
    for (int k = 0; k < 200; ++k) {
      const Vec2 axis(between(0, 40), between(0, 20));
      const double tip = clear.lowest_clear_tip_mm(shape, axis);
      for (int i = 0; i < 100; ++i) {
        const double r = 0.999 * shape.radius_mm * std::sqrt(between(0, 1)), a = between(0, 2 * kPi);
        const Vec2 p = axis + r * Vec2(std::cos(a), std::sin(a));
        if ((p.array() < 0).any() || p.x() > 40 || p.y() > 20) continue;
        EXPECT_GE(tip + underside_mm(shape, r), stands(p) - 1e-4) << p.transpose();
      }
    }
  }
}

}  // namespace
}  // namespace camber::copymill
