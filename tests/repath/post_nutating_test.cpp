// camber post on nutating heads: the other branch, and the turn at a pole that the head cannot pass.
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "base/units.h"
#include "kinematics/travel_check.h"
#include "repath/path_deviation.h"
#include "repath/post/post_plan.h"
#include "repath/post/post_processing.h"
#include "tests/kinematics/machines.h"
#include "tests/repath/five_axis_program.h"

namespace camber::repath {
namespace {

constexpr Eigen::Index kB = 1, kC = 2;

/// The head of the sample, and others: axes the other way round, at another angle, table and head sense.
std::vector<machine::Machine> nutating_machines() {
  std::vector<machine::Machine> out(4, kinematics::tests::sample("nutating_head"));
  out[1].rotary[1].direction = -out[1].rotary[1].direction;
  out[1].rotary[2].positive = machine::PositiveTurn::table;
  out[2].rotary[2].direction = -Vec3::UnitZ();
  out[2].rotary[1].direction = Vec3(-1, 0.4, 2);
  out[3].rotary[1].direction = Vec3(0.3, -1, -0.7);
  out[3].rotary[1].positive = machine::PositiveTurn::table;
  return out;
}

TEST(RotaryChoice, TheOtherBranchOfANutatingHeadHasTheSameDirectionEverywhere) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> angle(-1.9 * kPi, 1.9 * kPi);
  for (const machine::Machine& machine : nutating_machines()) {
    const kinematics::Chain chain(machine);
    const auto other = mirrored_choice(machine, chain);
    ASSERT_TRUE(other && other->twist);
    for (int i = 0; i < 200; ++i) {
      const Vec3 rad(0, angle(random), angle(random));
      const Vec3 here = chain.pose({Vec3::Zero(), rad}, 0).axis,
                 there = chain.pose({Vec3::Zero(), other->of(rad)}, 0).axis;
      ASSERT_LT((here - there).norm(), 1e-12) << rad.transpose();
      EXPECT_EQ(other->of(rad)[kB], -rad[kB] + other->mirror_rad[kB]);
    }
  }
}

TEST(RotaryChoice, TheOtherBranchDoesNotJump) {
  for (const machine::Machine& machine : nutating_machines()) {
    const auto other = *mirrored_choice(machine, kinematics::Chain(machine));
    constexpr double kStep = 1e-4;
    for (double b = -3 * kPi; b < 3 * kPi; b += kStep)
      ASSERT_LT((other.of({0, b + kStep, 0}) - other.of({0, b, 0})).norm(), 10 * kStep) << b;
  }
}

TEST(RotaryChoice, TheBoundOfEvenTurnsHolds) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> one(-1, 1);
  double share = 0;
  for (const machine::Machine& machine : nutating_machines()) {
    const kinematics::Chain chain(machine);
    const RotaryChoice other = *mirrored_choice(machine, chain);
    for (int i = 0; i < 100; ++i) {
      const Vec3 from(0, 2 * one(random), one(random)), to = from + Vec3(0, 0.2 * one(random), 0.2 * one(random));
      double most = 0;
      for (int k = 1; k < 20; ++k) {
        const double u = k / 20.0;
        const Vec3 even = other.of(from) + u * (other.of(to) - other.of(from)), meant = from + u * (to - from);
        const Vec3 a = chain.pose({Vec3::Zero(), even}, 0).axis, b = chain.pose({Vec3::Zero(), meant}, 0).axis;
        most = std::max(most, (a - b).norm());
      }
      const double bound = other.deviation_rad(from, to);
      ASSERT_LE(most, bound + 1e-12);
      if (bound > 1e-9) share = std::max(share, most / bound);
    }
  }
  EXPECT_GT(share, 0.2);  // and is no idle one
}

TEST(RotaryChoice, HeadsThatDoNotReachTheirPoleHaveNoOtherBranch) {
  machine::Machine machine = kinematics::tests::sample("nutating_head");
  machine.rotary[2].direction = Vec3(0, 0.2, 1).normalized();
  EXPECT_FALSE(mirrored_choice(machine, kinematics::Chain(machine)));
}

/// A head that does not turn past the upright spindle. The cut goes over the pole.
class NutatingPole : public ::testing::Test {
 protected:
  NutatingPole() : machine_(kinematics::tests::sample("nutating_head")) {
    machine_.rotary[1].travel_rad = {0, rad_from_deg(185)};
  }

  TurnBack turned_once() {
    const tests::FiveAxisProgram given = tests::read_five_axes(
        "G21 G17 G90 G94\nG54\nT1 M6\nG0\nG43.5 H1 X0. Y-20. Z20. I0 J-0.5 K1\nG1 Z0. F1000 I0 J-0.5 K1\nY-10. J-0.15 "
        "K1\nY0. J0. K1\nY10. J0.15 K1\nY20. J0.6 K1\nG0 Z30. J0.6 K1\nG49\nG53 Z0\nM30\n",
        machine_);
    Diagnostics diagnostics;
    const Posted out = post(given.program, given.moves, machine_, {}, diagnostics);
    diagnostics.throw_if_errors();
    const tests::FiveAxisProgram made = tests::read_five_axes(out.text, machine_);
    kinematics::check_travel(machine_, made.program, made.moves, diagnostics);
    diagnostics.throw_if_errors();
    const PostDeviation d = post_deviation(given.moves, made.moves, machine_, out, 16);
    EXPECT_LE(d.tip_mm, out.tip_bound_mm);
    EXPECT_LE(d.axis_rad, out.axis_bound_rad);
    EXPECT_LT(out.axis_bound_rad, rad_from_deg(0.0052));
    EXPECT_EQ(out.turns_back.size(), 1U);
    return out.turns_back.at(0);
  }

  machine::Machine machine_;
};

TEST_F(NutatingPole, TurnsOffThePart) {
  const TurnBack back = turned_once();
  EXPECT_FALSE(back.in_air);  // the cut goes on through the pole
  EXPECT_EQ(back.retract_mm, 50);
  EXPECT_NEAR(back.from_rad[kB], 0, 1e-6);
  EXPECT_NEAR(back.to_rad[kB], 0, 1e-6);
  EXPECT_NEAR(std::abs(back.to_rad[kC] - back.from_rad[kC]), kPi, 1e-6);
}

TEST_F(NutatingPole, RetractsAsFarAsTravelAllows) {
  machine_.axis[2].travel_mm[1] = 10;  // at the pole Z stands at -20
  const TurnBack back = turned_once();
  EXPECT_GT(back.retract_mm, 25);
  EXPECT_LE(back.retract_mm, 30);
}

}  // namespace
}  // namespace camber::repath
