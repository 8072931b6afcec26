// Every cutter in a straight pass: the stock's loss, the chips' volume and the area that the profile sweeps.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.h"
#include "removal/engagement.h"
#include "tests/support/cutting.h"
#include "tests/support/engage_all.h"

namespace camber::removal {
namespace {

using machine::ToolType;
using testing::add_row;
using testing::AllChips;
using testing::engage_all;
using testing::make_box;
using testing::make_tool;

constexpr double kLength = 8, kDepth = 2;
constexpr double kFeed = 0.1, kStockFraction = 0.0005;

/// A chip's thickness is right to the order of c / R; the volume of a slot's chips falls short by about a quarter of
/// it.
double balance_fraction(const machine::Tool& tool) { return 0.008 + 0.15 * kFeed / (tool.diameter_mm / 2); }

struct Volumes {
  double stock_mm3, chips_mm3;
};

/// A slot of kDepth along X through a block kLength long, the path running in and out.
Volumes slot(const machine::Tool& tool, double rise) {
  Stock stock = make_box({0, -9, -4}, {kLength, 9, 0}, 0.1);
  const Stock blank(stock);
  EnvelopeGrid envelope = make_envelope(tool, kDepth + 1.5, 0.05, rad_from_deg(2));
  make_patches(envelope, 0.24);
  std::vector<Stamp> stamps;
  add_row(stamps, {-8, 0.013, -kDepth}, {kLength + 8, 0.013, -kDepth + rise * (kLength + 16)}, kFeed);
  const AllChips e = engage_all(stock, blank, envelope, stamps);
  double chips = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k) chips += chip_volume_mm3(envelope, e.of(k));
  return {e.removed_mm3, chips};
}

void expect_volume(const machine::Tool& tool, double area_mm2, const char* what) {
  const Volumes v = slot(tool, 0);
  ::testing::Test::RecordProperty(
      what, fmt::format("{:.5f} {:.5f}", v.stock_mm3 / (area_mm2 * kLength), v.chips_mm3 / v.stock_mm3));
  EXPECT_NEAR(v.stock_mm3 / (area_mm2 * kLength), 1, kStockFraction) << what;
  EXPECT_NEAR(v.chips_mm3 / v.stock_mm3, 1, balance_fraction(tool)) << what;
}

double ball_area(double r, double depth) {
  const double half = std::acos(1 - depth / r);
  return r * r * (half - std::sin(2 * half) / 2);
}

TEST(CutterVolume, Flat) { expect_volume(make_tool(ToolType::flat, 10, 2, 30), 10 * kDepth, "flat"); }

TEST(CutterVolume, Ball) { expect_volume(make_tool(ToolType::ball, 10, 2, 30), ball_area(5, kDepth), "ball"); }

TEST(CutterVolume, Bull) {
  auto tool = make_tool(ToolType::bull, 10, 2, 30);
  tool.corner_radius_mm = 1.5;
  expect_volume(tool, 10 * kDepth - 2 * 1.5 * 1.5 * (1 - kPi / 4), "bull");
}

TEST(CutterVolume, TaperedBall) {
  auto tool = make_tool(ToolType::tapered_ball, 3, 2, 30);
  const double b = tool.taper_rad = rad_from_deg(10), r = 1.5;
  tool.flute_length_mm = 10;
  // Circular segment up to the tangent's height, then a trapezium.
  const double h = r * (1 - std::sin(b)), w = r * std::cos(b), rise = kDepth - h;
  expect_volume(tool, ball_area(r, h) + rise * (2 * w + rise * std::tan(b)), "tapered_ball");
}

TEST(CutterVolume, Chamfer) {
  auto tool = make_tool(ToolType::chamfer, 6, 2, 0);
  tool.tip_diameter_mm = 3;
  tool.point_angle_rad = rad_from_deg(90);
  // 45 degrees up to the full diameter at 1.5 mm, then a wall of 0.5 mm.
  expect_volume(tool, 1.5 * (3 + 1.5) + 0.5 * 6, "chamfer");
}

TEST(CutterVolume, Drill) {
  auto tool = make_tool(ToolType::drill, 8, 2, 0);
  tool.point_angle_rad = rad_from_deg(140);
  const double point = 4 / std::tan(rad_from_deg(70));
  expect_volume(tool, 4 * point + 8 * (kDepth - point), "drill");
}

TEST(CutterVolume, GeneralWithConeBottomArcAndTaper) {
  auto tool = make_tool(ToolType::general, 10, 2, 30);
  tool.taper_rad = rad_from_deg(5);
  tool.corner_radius_mm = 1;
  tool.corner_centre_z_mm = 1;
  tool.corner_centre_r_mm = 5 + std::tan(tool.taper_rad) - 1 / std::cos(tool.taper_rad);
  tool.flute_length_mm = 10;
  // Area under the parameters' meaning, by Simpson's rule over the height: half width at z.
  const auto p = machine::parameters_of(tool);
  ASSERT_EQ(machine::profile_fault(p), "");
  const auto ends = machine::corner_ends(p);
  const auto half_width = [&](double z) {
    if (z >= ends.wall.y()) return p.diameter_mm / 2 + z * std::tan(p.taper_rad);
    return p.corner_centre_r_mm + std::sqrt(std::max(0.0, 1 - (1 - z) * (1 - z)));
  };
  double area = 0;
  constexpr int kSlices = 20000;
  for (int i = 0; i < kSlices; ++i) area += 2 * half_width((i + 0.5) * kDepth / kSlices) * kDepth / kSlices;
  expect_volume(tool, area, "general");
}

TEST(CutterVolume, Lens) {
  auto tool = make_tool(ToolType::general, 10, 2, 30);
  const double r = tool.corner_radius_mm = tool.corner_centre_z_mm = 20;
  // The segment of the circle up to where it reaches the diameter, then the wall.
  const double h = r - std::sqrt(r * r - 25);
  expect_volume(tool, ball_area(r, h) + 10 * (kDepth - h), "lens");
}

TEST(CutterVolume, Barrel) {
  auto tool = make_tool(ToolType::general, 10, 2, 30);
  const double r = tool.corner_radius_mm = 85, top = tool.corner_centre_z_mm = 10;
  tool.corner_centre_r_mm = 5 - r;
  // Twice the half width from the axis, the flank's arc, over the depth.
  const auto integral = [r](double below) {
    return (below * std::sqrt(r * r - below * below) + r * r * std::asin(below / r)) / 2;
  };
  expect_volume(tool, 2 * ((5 - r) * kDepth + integral(top) - integral(top - kDepth)), "barrel");
}

TEST(CutterVolume, ChipsAreTheStocksLossOnARampDownAndUp) {
  auto tapered = make_tool(ToolType::tapered_ball, 3, 2, 30);
  tapered.taper_rad = rad_from_deg(10);
  tapered.flute_length_mm = 10;
  auto chamfer = make_tool(ToolType::chamfer, 6, 2, 0);
  chamfer.tip_diameter_mm = 1;
  chamfer.point_angle_rad = rad_from_deg(90);
  for (const auto& tool : {tapered, chamfer})
    for (const double rise : {0.04, -0.04}) {
      const Volumes v = slot(tool, rise);
      EXPECT_NEAR(v.chips_mm3 / v.stock_mm3, 1, balance_fraction(tool)) << rise;
    }
}

/// A flat cutter's second pass, `deeper` below one that has made a floor (or below the block's top): what a layer that
/// is no multiple of the rings' width holds, over its exact volume.
double layer_fraction(double deeper, bool below_top) {
  const auto tool = make_tool(ToolType::flat, 10, 2, 30);
  Stock stock = make_box({0, -9, -4}, {kLength, 9, 0}, 0.1);
  const Stock blank(stock);
  EnvelopeGrid envelope = make_envelope(tool, kDepth + 1.5, 0.06, rad_from_deg(2));
  make_patches(envelope, 0.24);
  const double floor = below_top ? 0 : -1.013;
  std::vector<Stamp> stamps;
  if (!below_top) add_row(stamps, {-8, 0.013, floor}, {kLength + 8, 0.013, floor}, kFeed);
  const std::size_t second = stamps.size();
  add_row(stamps, {-8, 0.013, floor - deeper}, {kLength + 8, 0.013, floor - deeper}, kFeed);
  const AllChips e = engage_all(stock, blank, envelope, stamps);
  double chips = 0;
  for (std::size_t k = second; k < stamps.size(); ++k) chips += chip_volume_mm3(envelope, e.of(k));
  return chips / (10 * deeper * kLength);
}

TEST(CutterVolume, LevelFacesCutRingsInTwo) {
  for (const bool below_top : {true, false})
    for (const double deeper : {0.1, 0.13, 0.15, 0.17, 0.2, 0.21})
      EXPECT_NEAR(layer_fraction(deeper, below_top), 1, 0.006) << deeper << (below_top ? " below the top" : "");
}

TEST(CutterVolume, PlungingDrillTakesItsPointAndItsCylinder) {
  auto tool = make_tool(ToolType::drill, 6, 2, 30);
  tool.point_angle_rad = rad_from_deg(118);
  Stock stock = make_box({-6, -6, -6}, {6, 6, 0}, 0.1);
  const Stock blank(stock);
  EnvelopeGrid envelope = make_envelope(tool, 5, 0.05, rad_from_deg(2));
  make_patches(envelope, 0.24);
  std::vector<Stamp> stamps;
  add_row(stamps, {0.02, 0.03, 0.5}, {0.02, 0.03, -4}, 0.05);
  const AllChips e = engage_all(stock, blank, envelope, stamps);
  double chips = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k) chips += chip_volume_mm3(envelope, e.of(k));
  const double stock_mm3 = e.removed_mm3;
  const double point = 3 / std::tan(rad_from_deg(59)), exact = kPi * 9 * (4 - point) + kPi * 9 * point / 3;
  EXPECT_NEAR(stock_mm3 / exact, 1, 0.004);
  EXPECT_NEAR(chips / stock_mm3, 1, balance_fraction(tool));
}

}  // namespace
}  // namespace camber::removal
