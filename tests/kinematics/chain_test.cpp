#include "kinematics/chain.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/units.h"
#include "tests/kinematics/machines.h"

namespace camber::kinematics {
namespace {

using tests::sample;

/// The accuracy that the project asks of the round trip.
constexpr double kTipMm = 1e-9, kAxis = 1e-9;
/// Enough to meet the hard places; bench/kinematics runs a million of each machine.
constexpr int kPoses = 20000;
constexpr double kLengthMm = 117.25;

class EachMachine : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Samples, EachMachine, testing::ValuesIn(tests::kMachines),
                         [](const auto& info) { return std::string(info.param); });

Joints random_joints(std::mt19937_64& random, const std::string& rotary) {
  std::uniform_real_distribution<double> mm(-1000, 1000), rad(-4 * kPi, 4 * kPi);
  Joints q;
  for (int i = 0; i < 3; ++i) q.linear_mm[i] = mm(random);
  for (const char letter : rotary) q.rotary_rad[letter - 'a'] = rad(random);
  return q;
}

void expect_same_pose(const ToolPose& a, const ToolPose& b) {
  EXPECT_LE((a.tip_mm - b.tip_mm).norm(), kTipMm);
  EXPECT_LE((a.axis - b.axis).norm(), kAxis);
}

TEST_P(EachMachine, BothBranchesGiveThePoseBack) {
  const Chain chain(sample(GetParam()));
  std::mt19937_64 random(24);
  for (int i = 0; i < kPoses; ++i) {
    const ToolPose pose = chain.pose(random_joints(random, chain.rotary_axes()), kLengthMm);
    const Joints near = random_joints(random, chain.rotary_axes());
    const Branches found = chain.branches(pose, kLengthMm, near);
    ASSERT_EQ(found.count, 2U);
    for (const Joints& q : found.joints) expect_same_pose(chain.pose(q, kLengthMm), pose);
    if (HasFailure()) return;
  }
}

TEST_P(EachMachine, OneBranchIsTheJointsThatThePoseCameFrom) {
  const Chain chain(sample(GetParam()));
  std::mt19937_64 random(25);
  for (int i = 0; i < kPoses; ++i) {
    const Joints q = random_joints(random, chain.rotary_axes());
    const Branches found = chain.branches(chain.pose(q, kLengthMm), kLengthMm, q);
    double nearest_mm = 1e9, nearest_rad = 1e9;
    for (std::size_t b = 0; b < found.count; ++b) {
      nearest_rad = std::min(nearest_rad, (found.joints[b].rotary_rad - q.rotary_rad).norm());
      nearest_mm = std::min(nearest_mm, (found.joints[b].linear_mm - q.linear_mm).norm());
    }
    // Angles are as accurate as the pose allows: less so near the pole, and near the limits of the reach.
    const double off = std::min(found.pole_distance_rad, std::abs(chain.tilt_range_rad()[1] - found.pole_distance_rad));
    const double slack = 1e-12 / std::max(1e-6, off);
    ASSERT_LE(nearest_rad, slack) << i;
    ASSERT_LE(nearest_mm, 2000 * slack) << i;
  }
}

/// Directions at distances from the pole down to less than a double can tell.
TEST_P(EachMachine, PlacesTheToolWhereItsPoseIs) {
  const machine::Machine machine = sample(GetParam());
  const Chain chain(machine);
  std::mt19937_64 random(26);
  for (int i = 0; i < 1000; ++i) {
    const Joints q = random_joints(random, chain.rotary_axes());
    const auto placements = chain.placements(q);
    ASSERT_EQ(placements.size(), machine.kinematics.chain.size() + 1);
    EXPECT_TRUE(placements.front().isApprox(Eigen::Isometry3d::Identity()));
    const Eigen::Isometry3d tool = placements.back() * chain.tool_at_zero(kLengthMm);
    const ToolPose pose = chain.pose(q, kLengthMm);
    expect_same_pose({tool.translation(), tool.linear().col(2)}, pose);
    EXPECT_LE((tool.linear() - tool_frame(pose)).norm(), kAxis);
  }
}

TEST_P(EachMachine, KeepsItsAccuracyNearThePole) {
  const Chain chain(sample(GetParam()));
  std::mt19937_64 random(26);
  std::uniform_real_distribution<double> turn(-kPi, kPi), exponent(-18, -1), mm(-500, 500);
  const Joints zero;
  Joints tilted;
  tilted.rotary_rad[chain.rotary_axes()[0] - 'a'] = 1;
  // The axis next to the part keeps its direction in the part: it is what stays when it alone turns.
  const Vec3 u0 = chain.pose(zero, 0).axis, u1 = chain.pose(tilted, 0).axis;
  for (int i = 0; i < kPoses; ++i) {
    Vec3 pole = Vec3::UnitZ();
    if (std::string(GetParam()) == "table_ab") pole = Vec3::UnitY();
    ASSERT_NEAR(u0.dot(pole), u1.dot(pole), 1e-15);
    const double off = std::pow(10.0, exponent(random)), way = turn(random);
    const Vec3 side = pole.unitOrthogonal();
    const Vec3 across = std::cos(way) * side + std::sin(way) * pole.cross(side);
    const ToolPose pose{{mm(random), mm(random), mm(random)},
                        (std::cos(off) * pole + std::sin(off) * across).normalized()};
    const Joints near = random_joints(random, chain.rotary_axes());
    const Branches found = chain.branches(pose, kLengthMm, near);
    ASSERT_EQ(found.count, 2U);
    EXPECT_NEAR(found.pole_distance_rad, off, 1e-15 + 1e-12 * off);
    EXPECT_EQ(found.at_pole, found.pole_distance_rad < 1e-12);
    for (const Joints& q : found.joints) {
      expect_same_pose(chain.pose(q, kLengthMm), pose);
      const Eigen::Index first = chain.rotary_axes()[0] - 'a';
      if (found.at_pole) {
        EXPECT_EQ(q.rotary_rad[first], near.rotary_rad[first]);
      }
    }
    if (HasFailure()) return;
  }
}

TEST(Chain, KeepsTheFreeAngleAtThePole) {
  const Chain chain(sample("table_ac_linuxcnc"));
  Joints near;
  near.rotary_rad = Vec3(0.3, 0, 2.5);
  const Solution s = chain.solve({{10, 20, 30}, Vec3::UnitZ()}, kLengthMm, near);
  EXPECT_TRUE(s.at_pole);
  EXPECT_EQ(s.reach, Reach::reached);
  EXPECT_EQ(s.joints.rotary_rad.x(), 0);
  EXPECT_EQ(s.joints.rotary_rad.z(), 2.5);
}

TEST(Chain, NutatingHeadReachesNinetyDegreesAndSaysWhereItDoesNot) {
  const Chain chain(sample("nutating_head"));
  EXPECT_NEAR(chain.tilt_range_rad()[0], 0, 1e-15);
  EXPECT_NEAR(chain.tilt_range_rad()[1], kPi / 2, 1e-15);
  Joints half;
  half.rotary_rad.y() = kPi;
  EXPECT_NEAR((chain.pose(half, 100).axis - Vec3::UnitX()).norm(), 0, 1e-15);
  EXPECT_EQ(chain.branches({Vec3::Zero(), Vec3(0.6, 0, -0.8)}, 100, {}).reach, Reach::direction);
  EXPECT_EQ(chain.solve({Vec3::Zero(), Vec3(0.6, 0, -0.8)}, 100, {}).reach, Reach::direction);
}

/// At the limit of the reach both branches meet, and the angle is the square root of a rounding error.
TEST(Chain, NutatingHeadKeepsItsAccuracyAtTheLimitOfItsReach) {
  const Chain chain(sample("nutating_head"));
  std::mt19937_64 random(27);
  std::uniform_real_distribution<double> turn(-kPi, kPi);
  for (int i = 0; i < 1000; ++i) {
    const double way = turn(random);
    const ToolPose pose{{100, 50, -20}, {std::cos(way), std::sin(way), 0}};
    const Branches found = chain.branches(pose, kLengthMm, {});
    ASSERT_EQ(found.count, 2U);
    for (const Joints& q : found.joints) expect_same_pose(chain.pose(q, kLengthMm), pose);
  }
}

/// Seed 002, equations (6) to (9), with A = a1 + a2 in place of a5: table-tilting machine, B and C on the table.
struct Seed {
  double a = 100;
  ToolPose pose(const Vec3& d, double b, double c) const {
    const double cb = std::cos(b), sb = std::sin(b), cc = std::cos(c), sc = std::sin(c);
    return {{d.x() * cc * cb - d.y() * sc + (d.z() + a) * cc * sb, d.x() * sc * cb + d.y() * cc + (d.z() + a) * sc * sb,
             -d.x() * sb + (d.z() + a) * cb - a},
            {cc * sb, sc * sb, cb}};
  }
  Vec3 joints(const Vec3& p, double b, double c) const {
    const double cb = std::cos(b), sb = std::sin(b), cc = std::cos(c), sc = std::sin(c);
    const double along = p.x() * cc + p.y() * sc;
    return {along * cb - (p.z() + a) * sb, -p.x() * sc + p.y() * cc, along * sb + (p.z() + a) * cb - a};
  }
};

machine::Machine seed_machine(double a) {
  machine::Machine m;
  m.kinematics.chain = "cbxyz";
  m.kinematics.table_axes = 2;
  m.rotary[1] = {.given = true, .direction = Vec3::UnitY(), .point_mm = {0, 0, -a}};
  m.rotary[2] = {.given = true, .direction = Vec3::UnitZ()};
  return m;
}

TEST(Chain, AgreesWithEquationsSixToNineOfTheSeed) {
  const Seed seed;
  const Chain chain(seed_machine(seed.a));
  std::mt19937_64 random(28);
  for (int i = 0; i < 2000; ++i) {
    const Joints q = random_joints(random, "bc");
    const ToolPose expected = seed.pose(q.linear_mm, q.rotary_rad.y(), q.rotary_rad.z());
    const ToolPose pose = chain.pose(q, 0);
    ASSERT_LE((pose.tip_mm - expected.tip_mm).norm(), 1e-11);
    ASSERT_LE((pose.axis - expected.axis).norm(), 1e-14);
    const Vec3 joints = seed.joints(pose.tip_mm, q.rotary_rad.y(), q.rotary_rad.z());
    ASSERT_LE((*chain.linear_mm(pose.tip_mm, q.rotary_rad, 0) - joints).norm(), 1e-11);
  }
}

TEST(Chain, GivesTheSeedsNumbers) {
  const Chain chain(seed_machine(100));
  Joints q;
  q.linear_mm = {10, 20, 30};
  q.rotary_rad = {0, rad_from_deg(40), rad_from_deg(30)};
  const ToolPose pose = chain.pose(q, 0);
  EXPECT_LE((pose.tip_mm - Vec3(69.001291, 62.931925, -6.842098)).lpNorm<Eigen::Infinity>(), 1e-6);
  // As printed, with a5 = 150 in place of A (docs/errata.md).
  const Vec3 printed = Seed{150}.pose(q.linear_mm, q.rotary_rad.y(), q.rotary_rad.z()).tip_mm;
  EXPECT_LE((printed - Vec3(96.834811, 79.001615, -18.539876)).lpNorm<Eigen::Infinity>(), 1e-6);
  EXPECT_LE((pose.axis - Vec3(0.556670, 0.321394, 0.766044)).lpNorm<Eigen::Infinity>(), 1e-6);
}

/// The formula of data/linuxcnc5/README.md.
TEST(Chain, AgreesWithTheDocumentedTableOfLinuxCnc) {
  using Eigen::AngleAxisd;
  using Eigen::Translation3d;
  const Chain chain(sample("table_ac_linuxcnc"));
  const Vec3 r(25, -15, -40), d(0, 6.5, -30), tool(0, 0, 80);
  std::mt19937_64 random(29);
  for (int i = 0; i < 2000; ++i) {
    const Joints q = random_joints(random, "ac");
    const Eigen::Affine3d m = Translation3d(r) * Translation3d(d) * AngleAxisd(q.rotary_rad.x(), Vec3::UnitX()) *
                              Translation3d(-d) * AngleAxisd(q.rotary_rad.z(), Vec3::UnitZ()) * Translation3d(-r);
    const ToolPose pose = chain.pose(q, 80);
    ASSERT_LE((m * pose.tip_mm - (q.linear_mm - tool)).norm(), 1e-11);
    const double a = q.rotary_rad.x(), c = q.rotary_rad.z();
    const Vec3 axis(std::sin(a) * std::sin(c), std::sin(a) * std::cos(c), std::cos(a));
    ASSERT_LE((pose.axis - axis).norm(), 1e-14);
  }
}

TEST(Chain, LinearAxesBetweenRotaryOnesAreSolvedToo) {
  machine::Machine m = sample("table_bc");
  m.kinematics.chain = "cybxz";
  const Chain chain(m);
  std::mt19937_64 random(30);
  for (int i = 0; i < 2000; ++i) {
    const ToolPose pose = chain.pose(random_joints(random, "bc"), 50);
    const Branches found = chain.branches(pose, 50, {});
    ASSERT_EQ(found.count, 2U);
    for (const Joints& q : found.joints) expect_same_pose(chain.pose(q, 50), pose);
  }
}

/// X below the tilting B: at B = 90 degrees X and Z are parallel.
TEST(Chain, SaysWhereTwoLinearAxesAreParallel) {
  machine::Machine m = sample("table_bc");
  m.kinematics.chain = "cxbyz";
  const Chain chain(m);
  EXPECT_FALSE(chain.linear_mm(Vec3::Zero(), {0, kPi / 2, 0}, 0));
  EXPECT_TRUE(chain.linear_mm(Vec3::Zero(), {0, 1, 0}, 0));
  EXPECT_EQ(chain.branches({Vec3::Zero(), Vec3::UnitX()}, 0, {}).reach, Reach::linear);
}

TEST(Chain, FourAxesReachTheDirectionsOfOneTurn) {
  machine::Machine m = sample("head_table");
  m.kinematics.chain = "xyzb";
  m.kinematics.table_axes = 0;
  const Chain chain(m);
  const Solution s = chain.solve({{5, 6, 7}, Vec3(0.6, 0, 0.8)}, 10, {});
  EXPECT_EQ(s.reach, Reach::reached);
  EXPECT_NEAR(s.joints.rotary_rad.y(), std::atan2(0.6, 0.8), 1e-15);
  expect_same_pose(chain.pose(s.joints, 10), {{5, 6, 7}, Vec3(0.6, 0, 0.8)});
  EXPECT_EQ(chain.solve({{5, 6, 7}, Vec3(0.6, 0.64, 0.48)}, 10, {}).reach, Reach::direction);
}

TEST(Chain, ThreeAxesTakeUprightToolsOnly) {
  machine::Machine m;
  m.kinematics.chain = "xyz";
  const Chain chain(m);
  EXPECT_EQ(chain.solve({{1, 2, 3}, Vec3::UnitZ()}, 10, {}).joints.linear_mm, Vec3(1, 2, 13));
  EXPECT_EQ(chain.solve({{1, 2, 3}, Vec3::UnitX()}, 10, {}).reach, Reach::direction);
}

/// One axis too many: Newton finds angles near those that are given.
TEST(Chain, ThreeRotaryAxesAreSolvedByNewton) {
  machine::Machine m = sample("head_head");
  m.kinematics.chain = "bxyzca";
  m.kinematics.table_axes = 1;
  m.rotary[1] = {.given = true, .direction = Vec3::UnitY(), .point_mm = {0, 0, -100}};
  const Chain chain(m);
  std::mt19937_64 random(31);
  std::normal_distribution<double> nudge(0, 0.05);
  for (int i = 0; i < kPoses; ++i) {
    const Joints from = random_joints(random, "abc");
    const ToolPose pose = chain.pose(from, kLengthMm);
    const Branches far = chain.branches(pose, kLengthMm, random_joints(random, "abc"));
    ASSERT_EQ(far.count, 1U) << i;
    expect_same_pose(chain.pose(far.joints[0], kLengthMm), pose);
    Joints near = from;
    for (int k = 0; k < 3; ++k) near.rotary_rad[k] += nudge(random);
    const Branches found = chain.branches(pose, kLengthMm, near);
    ASSERT_EQ(found.count, 1U);
    EXPECT_NEAR(found.pole_distance_rad, std::acos(std::min(1.0, std::abs(pose.axis.y()))),
                1e-7);  // from B, next to the part
    expect_same_pose(chain.pose(found.joints[0], kLengthMm), pose);
    if (HasFailure()) return;
  }
}

TEST(Chain, TakesTheWindingNearestToWhereTheAxesAre) {
  const Chain chain(sample("head_table"));  // C -720 to 720 degrees, B -100 to 100
  Joints from;
  from.rotary_rad = {0, rad_from_deg(30), rad_from_deg(-663)};
  const ToolPose pose = chain.pose(from, 50);
  Joints near = from;
  near.rotary_rad.z() = rad_from_deg(-650);
  const Solution s = chain.solve(pose, 50, near);
  EXPECT_EQ(s.reach, Reach::reached);
  EXPECT_NEAR(deg_from_rad(s.joints.rotary_rad.z()), -663, 1e-9);
  near.rotary_rad.z() = rad_from_deg(459);
  EXPECT_NEAR(deg_from_rad(chain.solve(pose, 50, near).joints.rotary_rad.z()), 417, 1e-9);
}

TEST(Chain, UnwindsWhereTheNearestWindingIsOutsideTravel) {
  machine::Machine m = sample("head_table");
  m.rotary[1].travel_rad = {rad_from_deg(-5), rad_from_deg(100)};  // the other branch is out of reach
  m.rotary[2].travel_rad = {rad_from_deg(-200), rad_from_deg(200)};
  const Chain chain(m);
  Joints q, near;
  q.rotary_rad = {0, 0.5, rad_from_deg(210)};
  near.rotary_rad = {0, 0.5, rad_from_deg(195)};
  const Solution s = chain.solve(chain.pose(q, 50), 50, near);
  EXPECT_EQ(s.reach, Reach::reached);
  EXPECT_NEAR(deg_from_rad(s.joints.rotary_rad.z()), -150, 1e-9);
  EXPECT_NEAR(s.joints.rotary_rad.y(), 0.5, 1e-12);
}

TEST(Chain, UnwindsUpwardsWhereTravelIsMostlyAboveZero) {
  machine::Machine m = sample("head_table");
  m.rotary[1].travel_rad = {rad_from_deg(-5), rad_from_deg(100)};
  m.rotary[2].travel_rad = {rad_from_deg(-30), rad_from_deg(700)};
  const Chain chain(m);
  Joints q;
  q.rotary_rad = {0, 0.5, rad_from_deg(-40)};
  const Solution s = chain.solve(chain.pose(q, 50), 50, q);
  EXPECT_EQ(s.reach, Reach::reached);
  EXPECT_NEAR(deg_from_rad(s.joints.rotary_rad.z()), 320, 1e-9);
}

/// A rotary axis of the head, also next to those of the table, does not turn the table.
TEST(Chain, TheTableTurnsAboutItsOwnAxesOnly) {
  machine::Machine m = sample("head_table");
  for (const char* chain : {"cxyzb", "cbxyz"}) {
    m.kinematics.chain = chain;
    m.kinematics.table_axes = 1;
    EXPECT_EQ(Chain(m).table_rotation(Vec3(0, 0.4, 0.7)), Chain(m).table_rotation(Vec3(0, 0, 0.7)));
    EXPECT_NEAR(std::abs(Chain(m).table_rotation(Vec3(0, 0.4, 0.7))(1, 0)), std::sin(0.7), 1e-12);
  }
}

TEST(Chain, NamesTheAxisThatLeavesItsTravel) {
  const Chain chain(sample("table_bc"));
  Joints q;
  q.rotary_rad.y() = rad_from_deg(50);
  q.linear_mm = {0, 0, -100};
  EXPECT_EQ(chain.outside_travel(q), 0);
  q.linear_mm.y() = 400.1;
  EXPECT_EQ(chain.outside_travel(q), 'y');
  EXPECT_EQ(chain.solve(chain.pose(q, 50), 50, q).axis, 'y');
  EXPECT_EQ(chain.solve(chain.pose(q, 50), 50, q).reach, Reach::travel);
  q.linear_mm.y() = 0;
  q.rotary_rad.y() = rad_from_deg(111);
  EXPECT_EQ(chain.outside_travel(q), 'b');
}

/// The work turns by A from y to z and by C from x to y under LinuxCNC's signs, and the spindle stands: seen from the
/// part its directions turn back.
TEST(Chain, TheSpindlesXIsCarriedIntoThePart) {
  const Chain chain(sample("table_ac_linuxcnc"));
  std::mt19937_64 random(31);
  for (int i = 0; i < 1000; ++i) {
    const Joints q = random_joints(random, "ac");
    const Mat3 part =
        (Eigen::AngleAxisd(q.rotary_rad.x(), Vec3::UnitX()) * Eigen::AngleAxisd(q.rotary_rad.z(), Vec3::UnitZ()))
            .toRotationMatrix();
    const Mat3 frame = tool_frame(chain.pose(q, kLengthMm));
    ASSERT_LE((frame - part.transpose()).norm(), 1e-9) << i;
  }
}

TEST(Chain, TheSpindlesXDoesNotJumpAtThePole) {
  const Chain chain(sample("table_ac_linuxcnc"));
  Joints q;
  q.rotary_rad.z() = 1;
  Mat3 before = tool_frame(chain.pose(q, kLengthMm));
  for (int i = -10; i <= 10; ++i) {
    q.rotary_rad.x() = 1e-4 * i;
    const Mat3 frame = tool_frame(chain.pose(q, kLengthMm));
    if (i > -10) {
      EXPECT_LE((frame - before).norm(), 2e-4) << i;
    }
    before = frame;
  }
}

TEST(Chain, NearestTurnIsWithinHalfATurn) {
  EXPECT_DOUBLE_EQ(nearest_turn(0.5, 100 * kPi), 0.5 + 100 * kPi);
  EXPECT_DOUBLE_EQ(nearest_turn(-kPi, 0), kPi);
  EXPECT_DOUBLE_EQ(nearest_turn(kPi, 0), kPi);
}

}  // namespace
}  // namespace camber::kinematics
