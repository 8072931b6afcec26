// Tilted tools: rotation tells all. Stock, path and axis turned together give the forces, in the tool's frame, and the
// form errors of the upright cut; a tool that only turns has a closed form.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "removal/engagement.h"
#include "removal/form_error.h"
#include "simulate/cut.h"
#include "tests/support/cutting.h"

namespace camber::simulate {
namespace {

using testing::add_row;

constexpr double kVoxel = 0.1, kFeed = 0.12, kAllowance = 0.2, kLength = 6;

machine::Tool tool_of(machine::ToolType type) {
  machine::Tool tool = testing::make_tool(type, 6, 2, 30);
  if (type == machine::ToolType::bull) tool.corner_radius_mm = 1;
  if (type == machine::ToolType::tapered_ball) tool.taper_rad = 0.1;
  tool.helix_rad = 0.5;
  return tool;
}

/// What is cut by an upright tool: rows along x that climb or follow a plane.
struct Scene {
  machine::Tool tool;
  std::vector<removal::Stamp> stamps{};
  Vec3 lo = Vec3::Zero(), hi = Vec3::Zero();  ///< of the stock
};

/// Rows of a ball on a plane that climbs at an angle.
Scene ball_on_plane(double angle_rad, double width, machine::ToolType type = machine::ToolType::ball) {
  Scene out{tool_of(type)};
  const double s = std::sin(angle_rad), c = std::cos(angle_rad), radius = 3;
  for (double y = -1.2; y < width + 0.3; y += 0.3) {
    const Vec3 contact(0, y * c, y * s), centre = contact + radius * Vec3(0, -s, c), tip = centre - Vec3(0, 0, radius);
    add_row(out.stamps, tip + Vec3(kLength + 3, 0, 0), tip - Vec3(3, 0, 0), kFeed);
  }
  out.lo = {0, 0, -1.5}, out.hi = {kLength, width, width * s + 0.3};
  return out;
}

/// Two rows of a flat or bull-nose cutter along a wall with a floor.
Scene shoulder(machine::ToolType type) {
  Scene out{tool_of(type)};
  for (const double y : {-2.63, -2.34}) add_row(out.stamps, {kLength + 4, y, -1.13}, {-4, y, -1.13}, kFeed);
  out.lo = {0.03, 0.01, -2.51}, out.hi = {kLength, 2.52, 0.04};
  return out;
}

/// Every kind of cutter, and one that yields along its axis.
std::vector<Scene> scenes() {
  std::vector<Scene> out{ball_on_plane(0.5, 1.5), shoulder(machine::ToolType::flat), shoulder(machine::ToolType::bull),
                         ball_on_plane(0.3, 1.5, machine::ToolType::tapered_ball), ball_on_plane(0.4, 1.5)};
  out.back().tool.root_axial_stiffness_N_per_mm = 5e3;
  return out;
}

/// The scene turned about the origin, with the spindle's X.
Scene turned(const Scene& scene, const Mat3& turn) {
  Scene out = scene;
  for (removal::Stamp& s : out.stamps) {
    s.pose = pose_of_frame(turn * s.pose.tip_mm, turn.col(2), turn.col(0));
    s.feed_per_tooth_mm = turn * s.feed_per_tooth_mm;
  }
  return out;
}

removal::Stock stock_of(const Scene& scene, const Mat3& turn) {
  Vec3 lo = Vec3::Constant(1e9), hi = -lo;
  for (int c = 0; c < 8; ++c) {
    const Vec3 corner(c & 1 ? scene.hi.x() : scene.lo.x(), c & 2 ? scene.hi.y() : scene.lo.y(),
                      c & 4 ? scene.hi.z() : scene.lo.z());
    lo = lo.cwiseMin(turn * corner), hi = hi.cwiseMax(turn * corner);
  }
  const auto distance = [&](const Vec3& p) {
    return removal::box_distance_mm(turn.transpose() * p, scene.lo, scene.hi);
  };
  return {distance, lo, hi, kVoxel, 5};
}

struct Result {
  double lateral_max_N = 0, chip_mm3 = 0, removed_fraction = 0;
  removal::ErrorFigures error_um;
  Vec3 force_mean_N = Vec3::Zero();
  std::size_t points = 0;
};

/// In the steady middle of the rows. Errors within the upright scene's `y_from` ... `y_to`.
Result simulate(const Scene& upright, const Mat3& turn, machine::Coupling coupling, double y_from, double y_to) {
  const machine::Material material{2000, 700, 0, 15, 15, 0};
  const Scene scene = turned(upright, turn);
  auto stock = stock_of(upright, turn);
  sweep(stock, scene.tool, scene.stamps, 0, kAllowance);
  stock.clear_stamps();
  removal::Stock target(stock);
  sweep(target, scene.tool, scene.stamps, 0, 0);
  CutOptions options;
  options.coupling = coupling;
  options.envelope_step_mm = 0.06;
  options.rotation_step_rad = kPi / 90;
  removal::CutterPlaces places;
  places.add(0, removal::shape_of(scene.tool), scene.stamps);
  removal::SurfaceMap map(target, places, stock);
  options.surface = &map;
  const CutResult cut_result = cut(stock, scene.tool, material, scene.stamps, {}, 0, options);
  EXPECT_EQ(cut_result.unsettled, 0u);
  Result r;
  r.chip_mm3 = cut_result.chip_mm3;
  r.removed_fraction = cut_result.chip_mm3 / cut_result.stock_mm3;
  double n = 0;
  for (std::size_t k = 0; k + 1 < scene.stamps.size(); ++k) {
    const Vec3& tip = upright.stamps[k].pose.tip_mm;
    if (tip.x() < 2 || tip.x() > 4) continue;
    r.lateral_max_N += cut_result.loads[k].lateral_max_N;
    r.force_mean_N += cut_result.loads[k].force_mean_N;
    ++n;
  }
  r.lateral_max_N /= n;
  r.force_mean_N /= n;
  std::vector<double> error, area;
  for (const auto& p : map.take()) {
    const Vec3 place = turn.transpose() * p.place_mm;
    if (place.x() < 2.03 || place.x() > 3.97 || place.y() < y_from || place.y() > y_to) continue;
    error.push_back(1000 * p.error_mm);
    area.push_back(p.area_mm2);
  }
  r.points = error.size();
  r.error_um = removal::error_figures(error, area);
  return r;
}

void expect_same(const Result& is, const Result& should, double force_share, double error_share) {
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
      expect_same(simulate(scene, hardly(), coupling, 0.23, 1.17), simulate(scene, upright, coupling, 0.23, 1.17),
                  0.005, 0.02);
    }
}

TEST(TiltedTool, ABallTiltedOnAPlaneCutsAsOnTheInclinedPlane) {
  // Leads and tilts of -40 to 40 degrees: the plane lies level, or stands anywhere.
  for (const double degrees : {-40.0, 15.0, 40.0})
    for (const auto coupling : {kRigid, kStatic}) {
      SCOPED_TRACE(degrees + (coupling == kRigid ? 0.1 : 0));
      const double angle = degrees * kPi / 180;
      const Scene scene = ball_on_plane(std::abs(angle), 1.5);
      const Mat3 level = Eigen::AngleAxisd(-std::abs(angle), Vec3::UnitX()).toRotationMatrix(),
                 about = Eigen::AngleAxisd(degrees < 0 ? kPi / 2 : 0, Vec3::UnitZ()).toRotationMatrix();
      const Result upright = simulate(scene, Mat3::Identity(), coupling, 0.23, 1.17);
      expect_same(simulate(scene, about * level, coupling, 0.23, 1.17), upright, 0.02, 0.05);
    }
}

TEST(TiltedTool, TurnsOfEverythingChangeNothing) {
  for (const std::uint32_t seed : {1u, 2u})
    for (const Scene& scene : scenes()) {
      SCOPED_TRACE(seed + 10 * static_cast<std::uint32_t>(scene.tool.type));
      expect_same(simulate(scene, turn_of(seed), kStatic, 0.23, 1.17),
                  simulate(scene, Mat3::Identity(), kStatic, 0.23, 1.17), 0.02, 0.05);
    }
}

TEST(TiltedTool, AToolThatOnlyTurnsTakesAChipThatGrowsWithTheHeight) {
  // The tip stays, the axis tilts in the y-z plane by omega a tooth: at height b the motion is omega b, and the chip of
  // a wide cut omega b sin(phi) (closed form), phi from the direction across the motion.
  machine::Tool tool = tool_of(machine::ToolType::flat);
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
  auto stock = testing::make_box(lo, hi, kVoxel);
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
