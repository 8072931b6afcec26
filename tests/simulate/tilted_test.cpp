// Tilted tools: rotation tells all. Stock, path and axis turned together give the forces, in the tool's frame, and the
// form errors of the upright cut; a tool that only turns has a closed form.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/units.h"
#include "removal/engagement.h"
#include "tests/support/cutting.h"
#include "tests/support/tilted_scene.h"

namespace camber::simulate {
namespace {

using testing::cut_turned;
using testing::scenes;
using Scene = testing::TiltedScene;
using Result = testing::TiltedResult;

void expect_same(const Result& is, const Result& should, double force_share, double error_share) {
  EXPECT_EQ(is.unsettled, 0u);
  EXPECT_EQ(should.unsettled, 0u);
  const double force = should.lateral_max_N;
  EXPECT_NEAR(is.lateral_max_N, force, force_share * force);
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(is.force_mean_N[a], should.force_mean_N[a], force_share * force) << a;
  EXPECT_NEAR(is.chip_mm3, should.chip_mm3, force_share * should.chip_mm3);
  ASSERT_GT(is.points, 100u);
  EXPECT_NEAR(is.error_um.mean, should.error_um.mean, error_share * should.error_um.p95);
  EXPECT_NEAR(is.error_um.p95, should.error_um.p95, error_share * should.error_um.p95);
  std::printf("force %+.2f %%, chips %+.2f %%, mean error %+.2f, p95 %+.2f um of %.2f\n",
              100 * (is.lateral_max_N / force - 1), 100 * (is.chip_mm3 / should.chip_mm3 - 1),
              is.error_um.mean - should.error_um.mean, is.error_um.p95 - should.error_um.p95, should.error_um.p95);
}

/// Hardly turned: the same voxels, by the code for tilted tools.
Mat3 hardly() { return Eigen::AngleAxisd(1e-9, Vec3::UnitZ()).toRotationMatrix(); }

Mat3 turn_of(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

constexpr auto kRigid = machine::Coupling::rigid, kStatic = machine::Coupling::static_;

}  // namespace

TEST(TiltedTool, HardlyTurnedCutsAsTheUprightToolDoes) {
  for (const auto coupling : {kRigid, kStatic})
    for (const Scene& scene : scenes()) {
      SCOPED_TRACE(static_cast<int>(scene.tool.type) + 10 * static_cast<int>(coupling));
      const Mat3 upright = Mat3::Identity();
      expect_same(cut_turned(scene, hardly(), coupling, 0.23, 1.17), cut_turned(scene, upright, coupling, 0.23, 1.17),
                  0.005, 0.02);
    }
}

TEST(TiltedTool, ABallTiltedOnAPlaneCutsAsOnTheInclinedPlane) {
  // Leads and tilts of -40 to 40 degrees: the plane lies level, or stands anywhere.
  for (const double degrees : {-40.0, 15.0, 40.0})
    for (const auto coupling : {kRigid, kStatic}) {
      SCOPED_TRACE(degrees + (coupling == kRigid ? 0.1 : 0));
      const double angle = degrees * kPi / 180;
      const Scene scene = testing::ball_on_plane(std::abs(angle), 1.5);
      const Mat3 level = Eigen::AngleAxisd(-std::abs(angle), Vec3::UnitX()).toRotationMatrix(),
                 about = Eigen::AngleAxisd(degrees < 0 ? kPi / 2 : 0, Vec3::UnitZ()).toRotationMatrix();
      const Result upright = cut_turned(scene, Mat3::Identity(), coupling, 0.23, 1.17);
      expect_same(cut_turned(scene, about * level, coupling, 0.23, 1.17), upright, 0.02, 0.05);
    }
}

TEST(TiltedTool, TurnsOfEverythingChangeNothing) {
  for (const Scene& scene : scenes()) {
    const auto upright = cut_turned(scene, Mat3::Identity(), kStatic, 0.23, 1.17);
    for (const std::uint32_t seed : {1u, 2u}) {
      SCOPED_TRACE(seed + 10 * static_cast<std::uint32_t>(scene.tool.type));
      expect_same(cut_turned(scene, turn_of(seed), kStatic, 0.23, 1.17), upright, 0.02, 0.05);
    }
  }
}

/// Of the grid of bench/rotation_grid: a corner, and where a blank's edge that is read trilinearly, rounded, makes most
/// of the peak force (2.1 % with the bull-nose cutter, 3.0 % with the flat one).
TEST(TiltedTool, LeadAndTiltChangeNothing) {
  struct Case {
    machine::ToolType type;
    double lead_deg, tilt_deg, force_share;
  };
  const auto all = scenes();
  std::vector<std::pair<const Scene*, Case>> cases;
  for (const Scene& scene : all) cases.push_back({&scene, {scene.tool.type, -40, -40, 0.02}});
  for (const Case& c : {Case{machine::ToolType::flat, -20, -40, 0.02}, {machine::ToolType::bull, 20, -20, 0.01}})
    cases.push_back({&*std::ranges::find(all, c.type, [](const Scene& s) { return s.tool.type; }), c});
  for (const auto& [scene, c] : cases) {
    SCOPED_TRACE(static_cast<int>(c.type));
    const Mat3 turn = (Eigen::AngleAxisd(rad_from_deg(c.lead_deg), Vec3::UnitY()) *
                       Eigen::AngleAxisd(rad_from_deg(c.tilt_deg), Vec3::UnitX()))
                          .toRotationMatrix();
    const auto heights = testing::away_from_edges(*scene);
    const auto cut = [&](const Mat3& t) { return cut_turned(*scene, t, kStatic, 0.23, 1.17, heights); };
    expect_same(cut(turn), cut(Mat3::Identity()), c.force_share, 0.05);
  }
}

TEST(TiltedTool, AToolThatOnlyTurnsTakesAChipThatGrowsWithTheHeight) {
  // The tip stays, the axis tilts in the y-z plane by omega a tooth: at height b the motion is omega b, and the chip of
  // a wide cut omega b sin(phi) (closed form), phi from the direction across the motion.
  machine::Tool tool = testing::tool_of(machine::ToolType::flat);
  tool.helix_rad = 0;
  constexpr double kOmega = 0.01, kDeep = 8;
  std::vector<removal::Stamp> stamps;
  for (int k = 0; k < 30; ++k) {
    const double angle = -0.35 + kOmega * k;
    removal::Stamp s;
    s.pose = pose_of_frame(Vec3(0, 0, 0), {0, std::sin(angle), std::cos(angle)}, Vec3::UnitX());
    s.first = k == 0;
    stamps.push_back(s);
  }
  const Vec3 lo(-4, -8, 1), hi(4, 8, kDeep);
  auto stock = testing::make_box(lo, hi, testing::kTiltedVoxel_mm);
  const removal::Stock blank(stock);
  const removal::EnvelopeGrid envelope = removal::make_envelope(tool, kDeep - 1, 0.2, kPi / 90);
  removal::RigidEngager engager(stock, blank, envelope, stamps, 0);
  std::size_t compared = 0;
  engager.engage(0, stamps.size(), [&](std::size_t k, std::span<const removal::ChipBlock> chips) {
    if (k != 20) return;
    for (const removal::ChipSample& c : removal::chips_of(engager.blocks(), chips)) {
      const double height = static_cast<double>(envelope.z[c.point]), sine = static_cast<double>(envelope.ny[c.point]);
      if (height < 2.5 || height > 6 || sine < 0.3) continue;
      EXPECT_NEAR(c.thickness_mm, kOmega * height * sine, 0.02 * kOmega * height) << height << ' ' << sine;
      ++compared;
    }
  });
  EXPECT_GT(compared, 500u);
}

}  // namespace camber::simulate
