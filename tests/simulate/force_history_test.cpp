// Forces, torque, power and single teeth of cut paths against closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "deflection/edge_force.h"
#include "deflection/steady_cut.h"
#include "simulate/cut.h"
#include "tests/support/cutting.h"

namespace camber::simulate {
namespace {

using deflection::edge_force;
using deflection::edge_force_slope;
using deflection::EdgeForce;
using deflection::Milling;
using deflection::SteadyCutModel;
using deflection::TurnForces;

using testing::add_row;
using testing::make_box;
using testing::make_tool;

constexpr machine::Material kSteel{2000, 700, 300, 15, 12, 5};

machine::Material kienzle_steel() {
  machine::Material m;
  m.law = machine::ForceLaw::kienzle;
  m.kc1_1_MPa = 1500, m.mc = 0.25, m.kr1_1_MPa = 500, m.mr = 0.35, m.ka1_1_MPa = 200, m.ma = 0.25;
  return m;
}

struct Row {
  double y_min = -7, y_max = 7, depth = 1, feed = 0.05;
  machine::Coupling coupling = machine::Coupling::rigid;
  bool turn = false;
};

struct Steady {
  StampLoad load;  ///< of a stamp in the middle; mean force and torque averaged over many
  CutResult all;
};

/// A row along +X through the middle of a box.
Steady steady(const machine::Tool& tool, const machine::Material& material, const Row& row) {
  const double deep = row.depth + 1;
  auto stock = make_box({0, row.y_min, -deep}, {14, row.y_max, 0}, 0.1);
  std::vector<removal::Stamp> stamps;
  add_row(stamps, {-1, 0, -row.depth}, {9, 0, -row.depth}, row.feed);
  CutOptions options;
  options.coupling = row.coupling;
  const auto middle = static_cast<std::size_t>(8.5 / row.feed);
  if (row.turn) options.turn_from = middle;
  Steady out;
  out.all = cut(stock, tool, material, stamps, {}, 0, options);
  const std::size_t from = static_cast<std::size_t>(7.0 / row.feed), to = static_cast<std::size_t>(9.5 / row.feed);
  out.load = out.all.loads[middle];
  out.load.force_mean_N.setZero();
  out.load.torque_mean_Nmm = out.load.work_Nmm = out.load.chip_mm3 = 0;
  for (std::size_t k = from; k < to; ++k) {
    const double fraction = 1.0 / static_cast<double>(to - from);
    out.load.force_mean_N += fraction * out.all.loads[k].force_mean_N;
    out.load.torque_mean_Nmm += fraction * out.all.loads[k].torque_mean_Nmm;
    out.load.work_Nmm += fraction * out.all.loads[k].work_Nmm;
    out.load.chip_mm3 += fraction * out.all.loads[k].chip_mm3;
  }
  return out;
}

void expect_near(const Vec3& got, const Vec3& want, double fraction) {
  EXPECT_LT((got - want).norm(), fraction * want.norm()) << got.transpose() << "  against  " << want.transpose();
}

TEST(ForceHistory, BallSlotMeansMatchTheClosedForm) {
  const auto tool = make_tool(machine::ToolType::ball, 8, 2, 30);
  const Row row{.y_min = -6, .y_max = 6, .depth = 1.2, .feed = 0.04};  // c/R = 0.01
  // With the circular chip h = B + (c^2 - B^2) / 2R, by midpoints: near the tip the edge cuts behind the feed as well,
  // and the edge terms there make 1.2 N of the axial force at this feed.
  constexpr int kRings = 400, kAround = 720;
  const double radius = 4, top = std::acos(1 - row.depth / radius), dk = top / kRings, dphi = 2 * kPi / kAround;
  Vec3 closed = Vec3::Zero();
  for (int i = 0; i < kRings; ++i)
    for (int k = 0; k < kAround; ++k) {
      const double kappa = (i + 0.5) * dk, phi = (k + 0.5) * dphi, sk = std::sin(kappa), ck = std::cos(kappa);
      const double b = row.feed * sk * std::cos(phi), h = b + (row.feed * row.feed - b * b) / (2 * radius);
      if (h <= 0) continue;
      const double ft = 2000 * h + 15, fr = 700 * h + 12, fa = 300 * h + 5, weight = radius * dk * 2 * dphi / (2 * kPi);
      const double s = std::sin(phi), c = std::cos(phi);
      closed -= weight * Vec3(ft * s + (fr * sk + fa * ck) * c, -ft * c + (fr * sk + fa * ck) * s, -fr * ck + fa * sk);
    }
  expect_near(steady(tool, kSteel, row).load.force_mean_N, closed, 0.01);
  const Vec3 straight = SteadyCutModel(tool, {row.feed, row.depth, 8, Milling::up}, 0.02).mean_N(kSteel);
  expect_near(straight, closed, 0.02);
}

TEST(ForceHistory, KienzleSlotMeansMatchTheIntegral) {
  const auto tool = make_tool(machine::ToolType::flat, 10, 2, 30);
  const Row row{.depth = 1, .feed = 0.05};
  const Vec3 closed = SteadyCutModel(tool, {row.feed, row.depth, 10, Milling::up}).mean_N(kienzle_steel());
  expect_near(steady(tool, kienzle_steel(), row).load.force_mean_N, closed, 0.01);
}

TEST(ForceHistory, ForceIsConstantAtAWholeAxialPitch) {
  const auto tool = make_tool(machine::ToolType::flat, 6, 4, 45);
  const Row row{.y_min = 2, .y_max = 5, .depth = 2 * kPi / 4 * 3, .feed = 0.03};
  const StampLoad load = steady(tool, kSteel, row).load;
  EXPECT_NEAR(load.lateral_max_N, load.force_mean_N.head<2>().norm(), 0.02 * load.lateral_max_N);
  EXPECT_NEAR(load.torque_max_Nmm, load.torque_mean_Nmm, 0.02 * load.torque_mean_Nmm);
}

TEST(ForceHistory, TorqueAndPowerFollowTheRemovalRate) {
  // Without edge terms the spindle's work over the volume is Ktc, and P = Ktc Q.
  constexpr machine::Material no_edge{1800, 500, 200};
  const auto tool = make_tool(machine::ToolType::flat, 10, 2, 30);
  const Row row{.y_min = 1, .y_max = 8, .depth = 2, .feed = 0.05};
  const StampLoad load = steady(tool, no_edge, row).load;
  EXPECT_NEAR(load.chip_mm3, 2 * 4 * 0.05, 0.01 * load.chip_mm3);
  EXPECT_NEAR(load.work_Nmm / load.chip_mm3, 1800, 0.01 * 1800);
  const double rpm = 4000, rate_mm3_per_s = 2 * 4 * 0.05 * 2 * rpm / 60;
  EXPECT_NEAR(power_W(load.torque_mean_Nmm, rpm), 1800 * rate_mm3_per_s / 1000, 0.01 * 1800 * rate_mm3_per_s / 1000);
  EXPECT_NEAR(load.chip_max_mm, 0.05 * std::sin(std::acos(0.2)), 0.02 * 0.05);  // at the exit, 4 of R5
}

TEST(ForceHistory, EachToothOfATurnFollowsItsClosedForm) {
  // Straight flutes: turned clockwise by `at` degrees, tooth t stands at t 120 - at, counter-clockwise from the feed.
  const auto tool = make_tool(machine::ToolType::flat, 10, 3, 0);
  const Row row{.depth = 1, .feed = 0.05, .turn = true};
  const TurnForces turn = steady(tool, kSteel, row).all.turn;
  ASSERT_EQ(turn.teeth.size(), 3u);
  ASSERT_EQ(turn.teeth[0].size(), 360u);
  const double largest = 2000 * 0.05 + 15;
  for (int t = 0; t < 3; ++t)
    for (int at = 0; at < 360; ++at) {
      const double phi = (t * 120 - at) * kPi / 180, h = 0.05 * std::cos(phi);
      const auto& tooth = turn.teeth[static_cast<std::size_t>(t)][static_cast<std::size_t>(at)];
      if (std::abs(std::cos(phi)) < 0.05) continue;  // whether a chip of a micrometre begins is no matter here
      Vec3 want = Vec3::Zero();
      double torque = 0;
      if (h > 0) {
        const double ft = 2000 * h + 15, fr = 700 * h + 12, fa = 300 * h + 5;
        want = {-ft * std::sin(phi) - fr * std::cos(phi), ft * std::cos(phi) - fr * std::sin(phi), -fa};
        torque = ft * 5;
      }
      EXPECT_LT((tooth.force_N - want).norm(), 0.02 * largest) << t << " " << at;
      EXPECT_NEAR(tooth.torque_Nmm, torque, 0.02 * largest * 5) << t << " " << at;
      EXPECT_NEAR(tooth.chip_max_mm, std::max(0.0, h), 0.02 * 0.05) << t << " " << at;
    }
}

TEST(ForceHistory, KienzleSettlesInStaticCoupling) {
  const auto tool = make_tool(machine::ToolType::ball, 6, 2, 30);
  Row row{.y_min = -3, .y_max = 3, .depth = 0.1, .feed = 0.05, .coupling = machine::Coupling::static_};
  const auto bent = steady(tool, kienzle_steel(), row);
  EXPECT_EQ(bent.all.unsettled, 0u);
  EXPECT_GT(bent.all.rounds_max, 1);
  // What one tooth leaves by yielding the next one takes: in a steady slot the mean force is nearly the rigid one.
  row.coupling = machine::Coupling::rigid;
  expect_near(bent.load.force_mean_N, steady(tool, kienzle_steel(), row).load.force_mean_N, 0.06);
}

TEST(EdgeForce, KienzleIsThePowerLawAndItsSlope) {
  const machine::Material m = kienzle_steel();
  for (const double h : {0.003, 0.05, 0.4}) {
    const EdgeForce f = edge_force(m, h, 2.0);
    EXPECT_NEAR(f.tangential_N, 2 * 1500 * std::pow(h, 0.75), 1e-9);
    EXPECT_NEAR(f.radial_N, 2 * 500 * std::pow(h, 0.65), 1e-9);
    const double d = 1e-7;
    const double slope = (edge_force(m, h + d, 1).tangential_N - edge_force(m, h - d, 1).tangential_N) / (2 * d);
    EXPECT_NEAR(edge_force_slope(m, h).tangential_N, slope, 1e-4 * slope);
  }
}

TEST(EdgeForce, TheRampIsAChordWithoutAJump) {
  machine::Material m = kienzle_steel();
  m.kte_N_per_mm = 10;
  const double ramp = 0.002;
  EXPECT_EQ(edge_force(m, 0, 1, ramp).tangential_N, 0);
  EXPECT_NEAR(edge_force(m, 1e-9, 1, ramp).tangential_N, 0, 1e-4);
  EXPECT_NEAR(edge_force(m, ramp, 1, ramp).tangential_N, edge_force(m, ramp, 1).tangential_N, 1e-9);
  EXPECT_NEAR(edge_force(m, ramp / 2, 1, ramp).tangential_N, edge_force(m, ramp, 1).tangential_N / 2, 1e-9);
  EXPECT_NEAR(edge_force_slope(m, ramp / 2, ramp).tangential_N, edge_force(m, ramp, 1).tangential_N / ramp, 1e-6);
}

}  // namespace
}  // namespace camber::simulate
