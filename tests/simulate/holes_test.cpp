// Holes against closed forms: volume, chips, thrust and torque.
#include "simulate/holes.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.h"
#include "tests/support/cutting.h"

namespace camber::simulate {
namespace {

using machine::ToolType;
using removal::Stamp;
using removal::Stock;
using testing::add_row;
using testing::make_box;
using testing::make_tool;

constexpr double kVoxel = 0.1;

machine::Tool drill_8_140() {
  auto tool = make_tool(ToolType::drill, 8, 2, 30);
  tool.point_angle_rad = rad_from_deg(140);
  return tool;
}

machine::Material linear_law() {
  machine::Material m;
  m.ktc_MPa = 1900;
  m.krc_MPa = 900;
  m.kac_MPa = 150;
  m.kte_N_per_mm = 20;
  m.kre_N_per_mm = 25;
  m.kae_N_per_mm = 3;
  return m;
}

/// A blind or through hole off the grid's lines, from 0.5 mm above the plate on.
std::vector<Stamp> hole(double bottom_z, double feed_per_tooth = 0.06) {
  std::vector<Stamp> stamps;
  add_row(stamps, {0.023, 0.041, 0.5}, {0.023, 0.041, bottom_z}, feed_per_tooth);
  Stamp last = stamps.back();
  last.feed_per_tooth_mm = Vec3(0.023, 0.041, bottom_z) - last.pose.tip_mm;
  last.pose.tip_mm.z() = bottom_z;
  if (last.feed_per_tooth_mm.norm() > 1e-9) stamps.push_back(last);
  return stamps;
}

Stock plate(double thickness) { return make_box({-6, -6, -thickness}, {6, 6, 0}, kVoxel); }

CutOptions fine() {
  CutOptions options;
  options.envelope_step_mm = 0.08;
  return options;
}

void expect_volume(const machine::Tool& tool, double bottom_z, double thickness, double exact, const char* what) {
  Stock stock = plate(thickness);
  const double before = stock.volume_mm3();
  const CutResult cut = drill(stock, tool, linear_law(), hole(bottom_z), 0, fine());
  ::testing::Test::RecordProperty(what,
                                  fmt::format("{:.5f} {:.5f}", cut.stock_mm3 / exact, cut.chip_mm3 / cut.stock_mm3));
  EXPECT_NEAR(cut.stock_mm3 / exact, 1, 0.005) << what;
  EXPECT_NEAR((before - stock.volume_mm3()) / exact, 1, 0.005) << what;
  EXPECT_NEAR(cut.chip_mm3 / cut.stock_mm3, 1, 0.01) << what;
}

TEST(Holes, ADrillTakesCylinderAndCone) {
  const double point = 4 / std::tan(rad_from_deg(70)), area = kPi * 16;
  expect_volume(drill_8_140(), -7, 12, area * (7 - point) + area * point / 3, "blind");
  expect_volume(drill_8_140(), -9, 6, area * 6, "through");
}

TEST(Holes, AFlatEndMillTakesACylinder) {
  expect_volume(make_tool(ToolType::flat, 6, 3, 30), -5, 8, kPi * 9 * 5, "flat");
}

TEST(Holes, ABallTakesCylinderAndHalfBall) {
  expect_volume(make_tool(ToolType::ball, 6, 2, 30), -5, 8, kPi * 9 * 2 + 2 * kPi * 27 / 3, "ball");
}

TEST(Holes, ASpotDrillTakesACone) {
  auto tool = make_tool(ToolType::chamfer, 8, 2, 0);
  tool.point_angle_rad = rad_from_deg(90);
  expect_volume(tool, -3, 8, kPi * 27 / 3, "spot");
}

/// Full engagement of the point: textbook sums over the straight lips of the linear edge model.
TEST(Holes, ThrustAndTorqueAreTheClosedForms) {
  const machine::Tool tool = drill_8_140();
  const machine::Material m = linear_law();
  const double f = 0.06, p = rad_from_deg(70), d = 8, z = 2;
  const double h = f * std::sin(p), lip = d / 2 / std::sin(p);
  const double torque = (m.ktc_MPa * h + m.kte_N_per_mm) * z * lip * d / 4;
  const double thrust =
      z * lip * ((m.krc_MPa * h + m.kre_N_per_mm) * std::sin(p) - (m.kac_MPa * h + m.kae_N_per_mm) * std::cos(p));
  Stock stock = plate(12);
  const auto stamps = hole(-7, f);
  const CutResult cut = drill(stock, tool, m, stamps, 0, fine());
  std::size_t full = 0;
  for (std::size_t k = 0; k + 1 < stamps.size(); ++k) {
    if (stamps[k].pose.tip_mm.z() > -2) continue;
    ++full;
    EXPECT_NEAR(cut.loads[k].force_mean_N.z() / thrust, 1, 0.01);
    EXPECT_NEAR(cut.loads[k].torque_mean_Nmm / torque, 1, 0.01);
    EXPECT_LT(cut.loads[k].lateral_max_N, 0.02 * thrust);
  }
  EXPECT_GT(full, 50u);
}

/// Tables: M = kc f D^2 / 8, thrust = kr f D sin(p) / 2, with f the feed a turn.
TEST(Holes, WithoutEdgeForcesTheTablesFormulasCome) {
  machine::Material m;
  m.ktc_MPa = 2000;
  m.krc_MPa = 1000;
  const double f = 0.12, p = rad_from_deg(70);
  Stock stock = plate(12);
  const auto stamps = hole(-7, f / 2);
  const CutResult cut = drill(stock, drill_8_140(), m, stamps, 0, fine());
  const auto& load = cut.loads[stamps.size() - 10];
  EXPECT_NEAR(load.torque_mean_Nmm / (2000 * f * 64 / 8), 1, 0.01);
  EXPECT_NEAR(load.force_mean_N.z() / (1000 * f * 8 * std::sin(p) / 2), 1, 0.01);
}

TEST(Holes, APilotHoleLeavesTheRingBeyondIt) {
  Stock stock = plate(12);
  auto pilot = drill_8_140();
  pilot.diameter_mm = 4;
  const double first = drill(stock, pilot, linear_law(), hole(-10), 0, fine()).stock_mm3;
  EXPECT_GT(first, 0);
  const auto stamps = hole(-8);
  const CutResult cut = drill(stock, drill_8_140(), linear_law(), stamps, 1000, fine());
  EXPECT_NEAR(cut.chip_mm3 / cut.stock_mm3, 1, 0.01);
  // Torque falls by the lever arms: (D^2 - d^2) / D^2.
  Stock solid = plate(12);
  const CutResult alone = drill(solid, drill_8_140(), linear_law(), stamps, 0, fine());
  const std::size_t k = stamps.size() - 10;
  EXPECT_NEAR(cut.loads[k].torque_mean_Nmm / alone.loads[k].torque_mean_Nmm, 0.75, 0.01);
}

TEST(Holes, PecksLeaveTheSameHoleAndTheSameChips) {
  Stock once = plate(12), pecked = plate(12);
  const CutResult a = drill(once, drill_8_140(), linear_law(), hole(-7), 0, fine());
  std::vector<Stamp> stamps;
  for (const double to : {-2.0, -4.0, -6.0, -7.0}) {
    const double from = to == -2 ? 0.5 : to == -7 ? -5.75 : to + 2 + 0.25;
    std::vector<Stamp> peck;
    add_row(peck, {0.023, 0.041, from}, {0.023, 0.041, to}, 0.06);
    Stamp last = peck.back();
    last.feed_per_tooth_mm.z() = to - last.pose.tip_mm.z();
    last.pose.tip_mm.z() = to;
    if (last.feed_per_tooth_mm.z() < -1e-9) peck.push_back(last);
    stamps.insert(stamps.end(), peck.begin(), peck.end());
  }
  const CutResult b = drill(pecked, drill_8_140(), linear_law(), stamps, 0, fine());
  EXPECT_NEAR(a.stock_mm3, b.stock_mm3, 1e-3);
  EXPECT_NEAR(b.chip_mm3 / b.stock_mm3, 1, 0.01);
}

TEST(Holes, ATapIsCarvedWithoutChips) {
  Stock stock = plate(12);
  const auto stamps = hole(-5, 0.35);
  const CutResult cut = tap(stock, make_tool(ToolType::flat, 6, 3, 30), stamps, 0, {});
  EXPECT_NEAR(cut.stock_mm3 / (kPi * 9 * 5), 1, 0.005);
  EXPECT_EQ(cut.chip_mm3, 0);
  ASSERT_EQ(cut.loads.size(), stamps.size());
  for (const auto& load : cut.loads) EXPECT_EQ(load.torque_max_Nmm, 0);
}

TEST(Holes, TheirStampsAreKnown) {
  removal::StampPath path;
  path.runs = {{1, 0, 10, removal::RunKind::milling},
               {2, 10, 5, removal::RunKind::drilling},
               {1, 15, 3, removal::RunKind::milling},
               {3, 18, 2, removal::RunKind::tapping}};
  const HoleStamps holes(path);
  for (int k = -1; k < 22; ++k) EXPECT_EQ(holes.contains(k), (k >= 10 && k < 15) || (k >= 18 && k < 20)) << k;
}

}  // namespace
}  // namespace camber::simulate
