#include "repath/post/tip_motion.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "kinematics/chain.h"
#include "tests/kinematics/machines.h"

namespace camber::repath {
namespace {

using kinematics::tests::kMachines;
using kinematics::tests::sample;

struct Drawn {
  Vec3 tip_mm[2], rotary_rad[2], linear_mm[2];
  double length_mm;
};

Drawn drawn(const kinematics::Chain& chain, std::mt19937& random, double turn_rad, double way_mm) {
  std::uniform_real_distribution<double> one(-1, 1);
  const auto vector = [&](double size) { return Vec3(size * one(random), size * one(random), size * one(random)); };
  Drawn d;
  d.tip_mm[0] = vector(150);
  d.tip_mm[1] = d.tip_mm[0] + vector(way_mm);
  d.rotary_rad[0] = vector(kPi);
  d.rotary_rad[1] = d.rotary_rad[0] + vector(turn_rad);
  d.length_mm = 100 + 50 * one(random);
  for (int i = 0; i < 2; ++i) d.linear_mm[i] = *chain.linear_mm(d.tip_mm[i], d.rotary_rad[i], d.length_mm);
  return d;
}

/// The largest distance of 33 samples.
double sampled_mm(const kinematics::Chain& chain, const Drawn& d) {
  double worst = 0;
  for (int i = 0; i <= 32; ++i) {
    const double v = i / 32.0;
    const kinematics::Joints joints{d.linear_mm[0] + v * (d.linear_mm[1] - d.linear_mm[0]),
                                    d.rotary_rad[0] + v * (d.rotary_rad[1] - d.rotary_rad[0])};
    const Vec3 want = d.tip_mm[0] + v * (d.tip_mm[1] - d.tip_mm[0]);
    worst = std::max(worst, (chain.pose(joints, d.length_mm).tip_mm - want).norm());
  }
  return worst;
}

TEST(JointLine, BoundsTheDeviationOnEveryMachine) {
  for (const char* name : kMachines) {
    const machine::Machine machine = sample(name);
    const kinematics::Chain chain(machine);
    const JointLine line(machine);
    std::mt19937 random(5);
    for (int i = 0; i < 3000; ++i) {
      const Drawn d = drawn(chain, random, i % 3 == 0 ? 3 : 0.2, i % 2 == 0 ? 60 : 2);
      const double bound =
          line.deviation_bound_mm(TipPiece::line(d.tip_mm[0], d.tip_mm[1]), d.rotary_rad, d.length_mm, d.linear_mm);
      ASSERT_LE(sampled_mm(chain, d), bound * (1 + 1e-9) + 1e-9) << name << " " << i;
    }
  }
}

/// Where a block turns by few degrees, as the blocks that are written do, the bound is little more than the truth.
TEST(JointLine, IsCloseForSmallTurns) {
  for (const char* name : kMachines) {
    const machine::Machine machine = sample(name);
    const kinematics::Chain chain(machine);
    const JointLine line(machine);
    std::mt19937 random(6);
    double sum = 0;
    constexpr int kCount = 500;
    for (int i = 0; i < kCount; ++i) {
      const Drawn d = drawn(chain, random, 0.03, 1);
      sum += line.deviation_bound_mm(TipPiece::line(d.tip_mm[0], d.tip_mm[1]), d.rotary_rad, d.length_mm, d.linear_mm) /
             sampled_mm(chain, d);
    }
    EXPECT_LT(sum / kCount, 1.1) << name;
  }
}

/// A tip at the distance rho of the only axis that turns: rho theta^2 / 8 (1 - theta^2 / 48 ...).
TEST(JointLine, IsTheSagittaOfATurnAboutOneAxis) {
  const machine::Machine machine = sample("table_ac_linuxcnc");
  const kinematics::Chain chain(machine);
  const Vec3 tip(125, -15, 0), rotary[2] = {Vec3::Zero(), Vec3(0, 0, 0.02)};
  const Vec3 linear[2] = {*chain.linear_mm(tip, rotary[0], 80), *chain.linear_mm(tip, rotary[1], 80)};
  EXPECT_NEAR(JointLine(machine).deviation_bound_mm(TipPiece::line(tip, tip), rotary, 80, linear), 100 * 4e-4 / 8,
              1.1e-4);
}

/// Linear axes on both sides of a rotary one: the looser bound holds there.
TEST(JointLine, HoldsForSplitLinearAxes) {
  machine::Machine machine = sample("table_bc");
  machine.kinematics.chain = "xcbyz";
  machine.kinematics.table_axes = 3;
  const kinematics::Chain chain(machine);
  const JointLine line(machine);
  std::mt19937 random(7);
  for (int i = 0; i < 3000; ++i) {
    Drawn d = drawn(chain, random, 0.3, 20);
    const double bound =
        line.deviation_bound_mm(TipPiece::line(d.tip_mm[0], d.tip_mm[1]), d.rotary_rad, d.length_mm, d.linear_mm);
    ASSERT_LE(sampled_mm(chain, d), bound * (1 + 1e-9) + 1e-9) << i;
  }
}

}  // namespace
}  // namespace camber::repath
