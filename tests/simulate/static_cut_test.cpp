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

TEST(StaticCut, AnUpMillingToolOnASpringGrowsIntoItsCutAsDrawn_slow) { expect_the_drawn_cut(soft(true), kPeak, kMean); }

TEST(StaticCut, ADownMillingToolOnASpringGrowsIntoItsCutAsDrawn_slow) {
  expect_the_drawn_cut(soft(false), kPeak, kMean);
}

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

}  // namespace
}  // namespace camber::simulate
