// Static coupling against a second calculation, and against what must hold in a steady cut.
#include "deflection/static_cut.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/deflected_shoulder.h"

namespace camber::simulate {
namespace {

using testing::DeflectedShoulder;
using testing::PassingFigures;

double largest_force(const std::vector<PassingFigures>& all) {
  double out = 0;
  for (const auto& f : all) out = std::max(out, f.lateral_max_N);
  return out;
}

/// Tooth passing by tooth passing, from the first touch of the block on.
void expect_the_drawn_cut(const DeflectedShoulder& s, double peak_fraction, double mean_fraction) {
  const auto drawn = testing::DrawnShoulder(s).cut();
  const auto camber = testing::camber_figures(s), rigid = testing::camber_figures(s, machine::Coupling::rigid);
  ASSERT_EQ(drawn.size(), camber.size());
  const double largest = largest_force(drawn), mean = drawn.back().mean_N.norm();
  double apart = 0;
  for (std::size_t k = 0; k < drawn.size(); ++k) {
    EXPECT_NEAR(camber[k].lateral_max_N, drawn[k].lateral_max_N, peak_fraction * largest) << k;
    EXPECT_LT((camber[k].mean_N - drawn[k].mean_N).norm(), mean_fraction * mean) << k;
    apart = std::max(apart, (rigid[k].mean_N - drawn[k].mean_N).norm() / mean);
  }
  // Bending does matter on the way in.
  EXPECT_GT(apart, 2 * mean_fraction);
}

/// A soft spring: bending changes the mean force by 3.5 % on the way in, the peak by 12 %.
DeflectedShoulder soft(bool up) {
  DeflectedShoulder s;
  s.up = up, s.stiffness_N_per_mm = 1500, s.kte = s.kre = 15;
  s.to_mm = -0.5, s.instants = 180, s.slices = 20;
  return s;
}

// The peak is that of a single rotation step, a mean that of all.
constexpr double kPeak = 0.03, kMean = 0.01;

TEST(StaticCut, AnUpMillingToolOnASpringGrowsIntoItsCutAsDrawn) { expect_the_drawn_cut(soft(true), kPeak, kMean); }

TEST(StaticCut, ADownMillingToolOnASpringGrowsIntoItsCutAsDrawn) { expect_the_drawn_cut(soft(false), kPeak, kMean); }

TEST(StaticCut, ARepeatedToothPassingTakesWhatARigidToolTakes) {
  // What one tooth leaves by yielding the next one takes.
  for (const bool up : {true, false}) {
    DeflectedShoulder s;
    s.up = up, s.to_mm = 5;
    const auto bent = testing::camber_figures(s).back(),
               rigid = testing::camber_figures(s, machine::Coupling::rigid).back();
    EXPECT_LT((bent.mean_N - rigid.mean_N).norm(), 0.01 * rigid.mean_N.norm());
    EXPECT_NEAR(bent.lateral_max_N, rigid.lateral_max_N, 0.03 * rigid.lateral_max_N);
  }
}

/// A shoulder along +X whose width doubles at x = 8 and falls back at x = 14, by one step of the stock each.
CutResult stepped_shoulder(std::size_t longest_gap, double runout_um) {
  auto tool = testing::make_tool(machine::ToolType::flat, 6, 2, 30);
  tool.overhang_mm = 32;
  tool.runout_mm = runout_um / 1000;
  auto stock = testing::make_box({0, -4, -2}, {20, 0, 0}, 0.2);
  // What stands at first is 0.5 mm wide; only between the steps 1 mm.
  std::vector<removal::Stamp> before;
  for (const auto& [from, to] : {std::pair{-4.0, 4.6}, std::pair{17.4, 24.0}})
    testing::add_row(before, {from, 2.5, -1.5}, {to, 2.5, -1.5}, 0.05);
  sweep(stock, tool, before, 0, 0);
  std::vector<removal::Stamp> stamps;
  testing::add_row(stamps, {-3.2, 2, -1.5}, {23, 2, -1.5}, 0.05);
  CutOptions options;
  options.longest_gap = longest_gap;
  return cut(stock, tool, machine::Material{2000, 700, 300, 15, 12, 3}, stamps, {}, 10000, options);
}

TEST(StaticCut, PassingsThatAreNotReadHaveTheLoadsOfThoseThatAre) {
  for (const double runout_um : {0.0, 3.0}) {
    const CutResult all = stepped_shoulder(1, runout_um), some = stepped_shoulder(8, runout_um);
    EXPECT_EQ(all.read, all.loads.size());
    EXPECT_LT(some.read, all.read * 6 / 10);
    ASSERT_EQ(some.loads.size(), all.loads.size());
    double peak = 0, mean = 0;
    for (const StampLoad& load : all.loads) {
      peak = std::max(peak, load.lateral_max_N);
      mean = std::max(mean, load.force_mean_N.norm());
    }
    for (std::size_t k = 0; k < all.loads.size(); ++k) {
      EXPECT_NEAR(some.loads[k].lateral_max_N, all.loads[k].lateral_max_N, 0.04 * peak) << k;
      EXPECT_LT((some.loads[k].force_mean_N - all.loads[k].force_mean_N).norm(), 0.03 * mean) << k;
      EXPECT_NEAR(some.loads[k].deflection_max_mm, all.loads[k].deflection_max_mm, 0.04 * all.deflection_max_mm) << k;
    }
    EXPECT_NEAR(some.chip_mm3, all.chip_mm3, 0.002 * all.chip_mm3);
    EXPECT_NEAR(some.stock_mm3, all.stock_mm3, 0.001 * all.stock_mm3);
    EXPECT_LT(some.extrapolation.rms_um(), 0.05 * 1000 * some.deflection_max_mm);
  }
}

TEST(StaticCut, AToolThatIsPulledIntoItsCutIsTold) {
  auto tool = testing::make_tool(machine::ToolType::flat, 6, 2, 30);
  tool.overhang_mm = 32;
  tool.youngs_modulus_MPa = 210000;
  const machine::Material pulling{1860, -900, 0, 15, 15, 0};
  const auto slot = [&](double depth) {
    auto stock = testing::make_box({0, -4, -4}, {3, 4, 0}, 0.1);
    std::vector<removal::Stamp> stamps;
    testing::add_row(stamps, {-3.1, 0, -depth}, {-1.5, 0, -depth}, 0.05);
    for (std::size_t k = 0; k < stamps.size(); ++k) stamps[k].move = static_cast<std::uint32_t>(100 + k / 10);
    return cut(stock, tool, pulling, stamps, {}, 0, {});
  };
  const CutResult shallow = slot(0.1), deep = slot(3);
  EXPECT_EQ(shallow.unsettled, 0u);
  EXPECT_TRUE(shallow.unsettled_moves.empty());
  EXPECT_GT(deep.unsettled, 0u);
  ASSERT_FALSE(deep.unsettled_moves.empty());
  EXPECT_GE(deep.unsettled_moves.front(), 100u);
  EXPECT_LE(deep.unsettled_moves.back(), 103u);
}

TEST(StaticCut, OneWithoutRestIsGivenUpByTheTimeItTakesWhateverAirWasCutBefore) {
  auto tool = testing::make_tool(machine::ToolType::flat, 6, 2, 30);
  tool.overhang_mm = 32;
  tool.youngs_modulus_MPa = 210000;
  constexpr std::size_t kAir = 300;
  const auto given_up = [&](double envelope_step_mm) {
    auto stock = testing::make_box({0, -4, -4}, {3, 4, 0}, 0.1);
    std::vector<removal::Stamp> stamps;
    testing::add_row(stamps, {-3.1 - 0.05 * kAir, 0, -3}, {0, 0, -3}, 0.05);
    CutOptions options;
    options.envelope_step_mm = envelope_step_mm;
    options.give_up_after = 12;
    try {
      cut(stock, tool, machine::Material{1860, -900, 0, 15, 15, 0}, stamps, {}, 0, options);
    } catch (const NoRest& found) {
      return found;
    }
    return NoRest{};
  };
  const NoRest coarse = given_up(0.1), fine = given_up(0.005);
  EXPECT_EQ(coarse.unsettled, 12u);
  EXPECT_LT(coarse.readings, kAir);
  EXPECT_GT(fine.unsettled, 0u);
  EXPECT_LT(fine.unsettled, 8u) << "each of them takes longer";
}

}  // namespace
}  // namespace camber::simulate
