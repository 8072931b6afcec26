#include "removal/profile.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "base/units.h"
#include "removal/cutter.h"
#include "tests/support/cutting.h"

namespace camber::removal {
namespace {

using machine::ToolType;
using testing::make_tool;

machine::Tool tapered_ball() {
  auto tool = make_tool(ToolType::tapered_ball, 4, 2, 30);
  tool.taper_rad = rad_from_deg(7);
  tool.flute_length_mm = 12;
  return tool;
}
machine::Tool chamfer() {
  auto tool = make_tool(ToolType::chamfer, 10, 4, 0);
  tool.tip_diameter_mm = 2;
  tool.point_angle_rad = rad_from_deg(90);
  return tool;
}
machine::Tool drill() {
  auto tool = make_tool(ToolType::drill, 8, 2, 30);
  tool.point_angle_rad = rad_from_deg(118);
  return tool;
}
/// Cone bottom, an arc that meets both lines at an edge, tapered wall.
machine::Tool general() {
  auto tool = make_tool(ToolType::general, 12, 4, 30);
  tool.bottom_angle_rad = rad_from_deg(6);
  tool.taper_rad = rad_from_deg(4);
  tool.corner_radius_mm = 2;
  tool.corner_centre_r_mm = 4.2;
  tool.corner_centre_z_mm = 2.3;
  tool.flute_length_mm = 14;
  return tool;
}
/// Circle segments, docs/cutters.md: a lens of radius 40 and diameter 10, and a barrel of radius 85 whose thickest
/// place lies 10 mm above the tip.
machine::Tool lens() {
  auto tool = make_tool(ToolType::general, 10, 3, 30);
  tool.corner_radius_mm = tool.corner_centre_z_mm = 40;
  return tool;
}
machine::Tool barrel() {
  auto tool = make_tool(ToolType::general, 10, 4, 30);
  tool.corner_radius_mm = 85;
  tool.corner_centre_r_mm = 5 - 85;
  tool.corner_centre_z_mm = 10;
  return tool;
}
std::vector<machine::Tool> all_tools() {
  auto bull = make_tool(ToolType::bull, 10, 3, 30);
  bull.corner_radius_mm = 1.5;
  return {make_tool(ToolType::ball, 6, 2, 30),
          make_tool(ToolType::flat, 10, 2, 30),
          bull,
          tapered_ball(),
          chamfer(),
          drill(),
          general(),
          lens(),
          barrel()};
}

/// Lowest height of the cutter at a radius, from the meaning of its parameters alone: the solid is what lies above the
/// bottom, above the corner's arc (inside of it beyond its centre) and inside the wall, and below H.
bool in_cutter(const machine::CutterParameters& p, double largest_radius, double r, double z) {
  if (r > largest_radius || z < r * std::tan(p.bottom_angle_rad)) return false;
  const double u = p.diameter_mm / 2 * (1 - std::tan(p.bottom_angle_rad) * std::tan(p.taper_rad));
  if (r > u + z * std::tan(p.taper_rad)) return false;
  if (p.corner_radius_mm <= 0) return true;
  const double dr = r - p.corner_centre_r_mm, dz = z - p.corner_centre_z_mm;
  // Outside the arc counts only where the corner is: between the directions to its two ends.
  const auto ends = machine::corner_ends(p);
  const double k = std::atan2(dr, -dz);
  const bool at_corner = k > ends.bottom_normal_rad && k < ends.wall_normal_rad;
  return !at_corner || std::hypot(dr, dz) <= p.corner_radius_mm;
}

TEST(Profile, DistanceIsThatToDensePointsOfTheProfile) {
  std::mt19937 random(7);
  for (const auto& tool : all_tools()) {
    const Profile profile(machine::parameters_of(tool));
    std::vector<Vec2> dense;
    constexpr double kStep = 0.0005;
    for (double s = 0; s < profile.length_to_height_mm(25); s += kStep) {
      const auto p = profile.at(s);
      dense.emplace_back(p.radius_mm, p.height_mm);
    }
    std::uniform_real_distribution<double> radius(0, tool.diameter_mm), height(-3, 16);
    for (int i = 0; i < 300; ++i) {
      const Vec2 point(radius(random), height(random));
      double least = 1e9;
      for (const auto& d : dense) least = std::min(least, (d - point).norm());
      const double d = profile.distance_mm(point);
      EXPECT_NEAR(std::abs(d), least, 2e-4) << static_cast<int>(tool.type) << " at " << point.transpose();
      if (least < 1e-3) continue;
      EXPECT_EQ(d < 0, in_cutter(machine::parameters_of(tool), profile.largest_radius_mm(), point.x(), point.y()))
          << static_cast<int>(tool.type) << " at " << point.transpose();
    }
  }
}

TEST(Profile, BallFlatAndBullAgreeWithTheirClosedForm) {
  std::mt19937 random(3);
  for (const auto& tool : all_tools()) {
    const CutterShape shape = shape_of(tool);
    if (shape.general) continue;
    std::uniform_real_distribution<double> place(-8, 8);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 p(place(random), place(random), place(random) + 4);
      const double closed = shape.distance_mm(p);
      // Inside, the closed form is only meant where bottom or wall are nearest.
      if (closed < -shape.corner_radius_mm * 0.29) continue;
      EXPECT_NEAR(shape.profile.distance_mm({std::hypot(p.x(), p.y()), p.z()}), closed, 1e-9);
    }
  }
}

TEST(Profile, NormalIsTheGradient) {
  std::mt19937 random(11);
  for (const auto& tool : all_tools()) {
    const CutterShape shape = shape_of(tool);
    std::uniform_real_distribution<double> place(-7, 7);
    for (int i = 0; i < 200; ++i) {
      const Vec3 p(place(random), place(random), place(random) + 4);
      if (shape.distance_mm(p) < 0.01) continue;
      constexpr double kStep = 1e-6;
      Vec3 g;
      for (int a = 0; a < 3; ++a) {
        Vec3 step = Vec3::Zero();
        step[a] = kStep;
        g[a] = (shape.distance_mm(p + step) - shape.distance_mm(p - step)) / (2 * kStep);
      }
      EXPECT_NEAR((g - shape.gradient(p)).norm(), 0, 1e-5) << static_cast<int>(tool.type);
    }
  }
}

TEST(Profile, NormalsOfTheProfileAreThoseOfItsDirection) {
  for (const auto& tool : all_tools()) {
    const Profile profile(machine::parameters_of(tool));
    constexpr double kStep = 1e-6;
    for (double s = 0.0137; s < profile.length_to_height_mm(10); s += 0.31) {
      const auto a = profile.at(s - kStep), b = profile.at(s + kStep), p = profile.at(s);
      const Vec2 along = Vec2(b.radius_mm - a.radius_mm, b.height_mm - a.height_mm) / (2 * kStep);
      EXPECT_NEAR(along.x(), std::cos(p.normal_angle_rad), 1e-5);
      EXPECT_NEAR(along.y(), std::sin(p.normal_angle_rad), 1e-5);
      EXPECT_NEAR((b.normal_angle_rad - a.normal_angle_rad) / (2 * kStep), p.meridian_curvature_per_mm, 1e-5);
    }
  }
}

TEST(Profile, TaperedBallHasItsTangentPointWhereTheTradeHasIt) {
  const auto tool = tapered_ball();
  const auto ends = machine::corner_ends(machine::parameters_of(tool));
  EXPECT_NEAR(ends.wall.x(), 2 * std::cos(tool.taper_rad), 1e-9);
  EXPECT_NEAR(ends.wall.y(), 2 * (1 - std::sin(tool.taper_rad)), 1e-9);
  EXPECT_NEAR(shape_of(tool).radius_mm, ends.wall.x() + (12 - ends.wall.y()) * std::tan(tool.taper_rad), 1e-9);
}

/// A lens cutter leaves cusps of a_e^2 / (8 R) between its rows: the height of its profile at half the distance.
TEST(Profile, OfALensLeavesTheCuspsOfItsRadius) {
  const Profile profile(machine::parameters_of(lens()));
  constexpr double kRadius_mm = 40;
  for (const double row_mm : {0.5, 1.0, 2.0}) {
    const double cusp_mm = profile.height_at_radius_mm(row_mm / 2);
    EXPECT_NEAR(cusp_mm, kRadius_mm - std::sqrt(kRadius_mm * kRadius_mm - row_mm * row_mm / 4), 1e-12);
    EXPECT_NEAR(cusp_mm, row_mm * row_mm / (8 * kRadius_mm), 1e-3 * cusp_mm);
  }
  EXPECT_DOUBLE_EQ(profile.largest_radius_mm(), 5);
}

/// A barrel's flank: 5 mm from the axis at the thickest place, and by the sagitta of its arc less elsewhere.
TEST(Profile, OfABarrelFollowsItsFlank) {
  const Profile profile(machine::parameters_of(barrel()));
  for (const double below_mm : {0.0, 1.0, 4.0, 9.0}) {
    const double s = profile.length_to_height_mm(10 - below_mm);
    EXPECT_NEAR(profile.at(s).radius_mm, 5 - (85 - std::sqrt(85.0 * 85 - below_mm * below_mm)), 1e-9) << below_mm;
    EXPECT_NEAR(profile.at(s).meridian_curvature_per_mm,
                below_mm > 0 ? 1.0 / 85 : profile.at(s).meridian_curvature_per_mm, 1e-12);
  }
}

TEST(Profile, SaysWhatDoesNotClose) {
  auto tool = general();
  tool.corner_centre_z_mm = 5;
  EXPECT_EQ(machine::profile_fault(machine::parameters_of(tool)), "the corner's arc does not reach the bottom");
  tool = general();
  tool.corner_centre_r_mm = 3.2;
  EXPECT_EQ(machine::profile_fault(machine::parameters_of(tool)), "the corner's arc does not reach the wall");
  tool = tapered_ball();
  tool.flute_length_mm = 1;
  EXPECT_EQ(machine::profile_fault(machine::parameters_of(tool)),
            "the flutes end 1 mm above the tip, below the corner's upper end at 1.756 mm");
  for (const auto& good : all_tools()) EXPECT_EQ(machine::profile_fault(machine::parameters_of(good)), "");
}

}  // namespace
}  // namespace camber::removal
