#include "dynamics/vibrating_cut.h"

#include <gtest/gtest.h>

namespace camber::dynamics {
namespace {

Eigen::Matrix2d directional(const CutSlice& s, double phi) {
  const double turns = std::floor((phi - s.entry_rad) / (2 * kPi));
  if (phi - s.entry_rad - 2 * kPi * turns > s.exit_rad - s.entry_rad) return Eigen::Matrix2d::Zero();
  const Vec2 t(std::cos(phi), -std::sin(phi)), n(std::sin(phi), std::cos(phi));
  return (s.kt_MPa * t + s.kr_MPa * n) * n.transpose();
}

TEST(DirectionalIntegral, IsWhatSmallStepsAddUpTo) {
  const CutSlice s{.entry_rad = 2.0, .exit_rad = 4.5, .kt_MPa = 900, .kr_MPa = 250};
  const DirectionalIntegral integral(s);
  const double from = -7, to = 9.3;
  constexpr int kSteps = 200000;
  const double step = (to - from) / kSteps;
  Eigen::Matrix2d first = Eigen::Matrix2d::Zero(), second = Eigen::Matrix2d::Zero();
  for (int i = 0; i < kSteps; ++i) {
    second += (integral.first(from + (i + 0.5) * step)) * step;
    first += directional(s, from + (i + 0.5) * step) * step;
  }
  EXPECT_LT((integral.first(to) - integral.first(from) - first).norm(), 0.2);
  EXPECT_LT((integral.second(to) - integral.second(from) - second).norm(), 0.2);
}

TEST(DirectionalIntegral, OfASlotIsItsClosedForm) {
  const CutSlice slot{.entry_rad = 0, .exit_rad = kPi, .kt_MPa = 600, .kr_MPa = 200};
  const Eigen::Matrix2d turn = DirectionalIntegral(slot).per_turn();
  EXPECT_NEAR(turn(0, 0), 200 * kPi / 2, 1e-9);
  EXPECT_NEAR(turn(0, 1), 600 * kPi / 2, 1e-9);
  EXPECT_NEAR(turn(1, 0), -600 * kPi / 2, 1e-9);
  EXPECT_NEAR(turn(1, 1), 200 * kPi / 2, 1e-9);
}

TEST(Shoulder, HasTheArcOfItsRadialDepth) {
  EXPECT_NEAR(shoulder(0.5, Milling::up, 1, 1).exit_rad, kPi / 2, 1e-12);
  EXPECT_NEAR(shoulder(0.5, Milling::down, 1, 1).entry_rad, kPi / 2, 1e-12);
  EXPECT_NEAR(shoulder(1, Milling::down, 1, 1).entry_rad, 0, 1e-12);
  EXPECT_NEAR(shoulder(0.05, Milling::down, 1, 1).entry_rad, 2.690566, 1e-6);
}

TEST(Receptance, OfARestingModeIsItsFlexibility) {
  const std::vector<Mode> modes{{Vec2(1, 1).normalized(), 500, 0.02, 2000}};
  const Eigen::Matrix2cd g = receptance(modes, 1e-6);
  EXPECT_NEAR(g(0, 1).real(), 0.5 / 2000, 1e-9);
  EXPECT_NEAR(std::abs(receptance(modes, 500)(0, 0)), 0.5 / 2000 / (2 * 0.02), 1e-9);
}

}  // namespace
}  // namespace camber::dynamics
