// Blanks that are the part and a thin skin on its slopes: all of it is one free-form volume.
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "plan/order.h"
#include "plan/removal_volume.h"

namespace camber::plan {
namespace {

using Height = std::function<double(double x, double y)>;

/// A block from z = 0 up to a surface, which has facets `step` mm wide.
TriangleSolid block_under(double length_mm, double width_mm, double step_mm, const Height& height) {
  const auto nx = static_cast<std::uint32_t>(std::lround(length_mm / step_mm)),
             ny = static_cast<std::uint32_t>(std::lround(width_mm / step_mm));
  TriangleSolid out;
  const auto number = [&](std::uint32_t i, std::uint32_t j, bool top) {
    return 2 * (i * (ny + 1) + j) + (top ? 1 : 0);
  };
  for (std::uint32_t i = 0; i <= nx; ++i)
    for (std::uint32_t j = 0; j <= ny; ++j) {
      const double x = step_mm * i, y = step_mm * j;
      out.points.emplace_back(x, y, 0);
      out.points.emplace_back(x, y, height(x, y));
    }
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    out.triangles.push_back({a, b, c});
    out.triangles.push_back({a, c, d});
  };
  for (std::uint32_t i = 0; i < nx; ++i)
    for (std::uint32_t j = 0; j < ny; ++j) {
      quad(number(i, j, true), number(i + 1, j, true), number(i + 1, j + 1, true), number(i, j + 1, true));
      quad(number(i, j, false), number(i, j + 1, false), number(i + 1, j + 1, false), number(i + 1, j, false));
    }
  for (std::uint32_t i = 0; i < nx; ++i) {
    quad(number(i, 0, false), number(i + 1, 0, false), number(i + 1, 0, true), number(i, 0, true));
    quad(number(i, ny, true), number(i + 1, ny, true), number(i + 1, ny, false), number(i, ny, false));
  }
  for (std::uint32_t j = 0; j < ny; ++j) {
    quad(number(0, j, true), number(0, j + 1, true), number(0, j + 1, false), number(0, j, false));
    quad(number(nx, j, false), number(nx, j + 1, false), number(nx, j + 1, true), number(nx, j, true));
  }
  return out;
}

struct Skin {
  const char* name;
  double length_mm, width_mm, step_mm, thick_mm;
  Height height;
};

const std::vector<Skin>& skins() {
  static const std::vector<Skin> all{
      {"ramp along x", 60, 40, 20, 0.3, [](double x, double) { return 10 + x / 6; }},
      {"thinner", 50, 30, 10, 0.2, [](double x, double) { return 8 + 0.17 * x; }},
      {"ramp along y", 40, 60, 20, 0.1, [](double, double y) { return 30 - y / 4; }},
      {"ramp along both", 40, 40, 20, 0.3, [](double x, double y) { return 5 + x / 5 + y / 8; }},
      {"roof", 60, 40, 10, 0.25, [](double, double y) { return 20 - 0.4 * std::abs(y - 20); }},
      {"valley", 60, 40, 10, 0.25, [](double, double y) { return 10 + 0.4 * std::abs(y - 20); }},
      {"steep", 40, 40, 10, 0.3, [](double x, double) { return 5 + 1.5 * x; }},
      {"dome", 60, 60, 3, 0.3,
       [](double x, double y) { return 30 - ((x - 30) * (x - 30) + (y - 30) * (y - 30)) / 100; }},
      {"saddle", 60, 60, 3, 0.3,
       [](double x, double y) { return 20 + ((x - 30) * (x - 30) - (y - 30) * (y - 30)) / 100; }},
      {"die with a sharp ridge", 120, 81, 3, 0.3,
       [](double x, double y) {
         return 9.1775 + 14 * (1 + std::cos(x / 19)) * (1 - std::abs(y - 39) / 60) + 0.1 * std::abs(y - 39);
       }},
  };
  return all;
}

TEST(Skins, AreOneFreeFormVolumeThatIsReachedFromAbove) {
  for (const Skin& s : skins()) {
    SCOPED_TRACE(s.name);
    const RemovalVolume removal =
        removal_volume({.blank = block_under(s.length_mm, s.width_mm, s.step_mm,
                                             [&](double x, double y) { return s.height(x, y) + s.thick_mm; }),
                        .part = block_under(s.length_mm, s.width_mm, s.step_mm, s.height)});
    const double volume = s.length_mm * s.width_mm * s.thick_mm;
    EXPECT_NEAR(removal.removal_mm3(), volume, 1e-6 * volume);
    EXPECT_LT(std::abs(removal.balance()), 1e-3);
    for (const DivisionPlan plan : kDivisionPlans) {
      const std::vector<VolumePrimitive> primitives = divide(removal, plan);
      ASSERT_EQ(primitives.size(), 1U);
      EXPECT_TRUE(primitives[0].free_form);
      EXPECT_FALSE(primitives[0].overhang);
      EXPECT_NEAR(primitives[0].volume_mm3, volume, 1e-3 * volume);
      EXPECT_TRUE(put_in_order(removal, primitives).unreachable.empty());
    }
  }
}

TEST(Skins, UnderABoxOfMaterialLeaveTheBoxToRoughing) {
  const Height ramp = [](double x, double) { return 10 + x / 6; };
  const RemovalVolume removal =
      removal_volume({.blank = solid_of(machine::Box{{0, 0, 0}, {60, 40, 30}}), .part = block_under(60, 40, 20, ramp)});
  EXPECT_LT(std::abs(removal.balance()), 1e-3);
  const std::vector<VolumePrimitive> primitives = divide(removal, DivisionPlan::largest);
  ASSERT_EQ(primitives.size(), 2U);
  EXPECT_NE(primitives[0].free_form, primitives[1].free_form);
  EXPECT_TRUE(put_in_order(removal, primitives).unreachable.empty());
}

}  // namespace
}  // namespace camber::plan
