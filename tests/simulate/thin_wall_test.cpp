// A wall of 2 x 30 x 60 mm cut level by level: how it yields, and the error that it is left with, against a plate whose
// thickness is that of the moment (tests/support/cantilever_plate.h).
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.h"
#include "camber/diagnostics.h"
#include "removal/form_error.h"
#include "simulate/cut.h"
#include "simulate/part_survey.h"
#include "simulate/predict_path.h"
#include "tests/support/accuracy_figure.h"
#include "tests/support/cantilever_plate.h"
#include "tests/support/cutting.h"

namespace camber::testing {
namespace {

constexpr double kLength = 60, kHeight = 30, kThin = 2, kAllowance = 0.2, kLevel = 6, kRadius = 5;
constexpr double kE_MPa = 68900, kNu = 0.33;
constexpr double kHelix_rad = 30 * kPi / 180;

/// The wall stands from y = 0 to y = 2, and as far as it is not finished to y = 2.2. One level, from the tip up, is
/// finished along +x by a tool at y > 2, down milling.
struct Scene {
  /// `stands_off_mm`: of each cut, by which its path is farther from the wall than the last surface asks for.
  explicit Scene(double tip_mm, double voxel_mm = 0.2, const std::vector<double>& stands_off_mm = {0})
      : tip(tip_mm), voxel(voxel_mm) {
    job.machine.axis = {};
    tool = make_tool(machine::ToolType::flat, 2 * kRadius, 2, 30);
    tool.flute_length_mm = kLevel;
    tool.youngs_modulus_MPa = 6e8;  // the wall alone yields
    job.tools[1] = tool;
    job.material = material;
    job.workpiece.emplace();
    job.workpiece->youngs_modulus_MPa = kE_MPa;
    job.workpiece->poisson_ratio = kNu;
    for (const double off : stands_off_mm)
      add_row(path.stamps, {-4, kThin + kRadius + off, tip}, {kLength + 4, kThin + kRadius + off, tip}, feed_mm);
    path.runs = {{1, 0, path.stamps.size(), removal::RunKind::milling}};
  }
  removal::Stock blank() const {
    const auto wall = [this](const Vec3& p) {
      return std::min(removal::box_distance_mm(p, {0, 0, 0}, {kLength, kThin + kAllowance, tip + kLevel}),
                      removal::box_distance_mm(p, {0, 0, 0}, {kLength, kThin, kHeight}));
    };
    return {wall, {0, 0, 0}, {kLength, kThin + kAllowance, kHeight}, voxel, 4};
  }
  /// The plate while the tool stands at x. `behind_mm`, `ahead_mm`: what stands over kThin of the level.
  test::CantileverPlate plate(double x, double behind_mm = 0, double ahead_mm = kAllowance) const {
    test::CantileverPlate::Description d;
    d.length = kLength, d.height = kHeight;
    d.youngs_modulus_MPa = kE_MPa, d.poisson_ratio = kNu;
    d.z_breaks = {tip, tip + kLevel};
    d.x_breaks = {x};
    d.thickness = [=, this](double at_x, double z) {
      if (z > tip + kLevel) return kThin;
      return kThin + (z < tip ? kAllowance : at_x < x ? behind_mm : ahead_mm);
    };
    return test::CantileverPlate(d);
  }

  double tip, voxel;
  static constexpr double feed_mm = 0.15;
  machine::Job job;
  machine::Tool tool;
  machine::Material material{800, 250, 0, 6, 6, 0};
  removal::StampPath path;
};

/// Of the wall, as the tool's y at a height over the tip answers a force along y at another one; um/N.
double survey_um_per_N(const Scene& scene, const simulate::PartSurvey& survey, double x, double z_read,
                       double z_force) {
  const auto part = survey.along(scene.path, 0);
  std::size_t stamp = 0;
  while (scene.path.stamps[stamp].pose.tip_mm.x() < x) ++stamp;
  const Eigen::MatrixXd c = part->at(stamp);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(c.cols());
  const auto w = deflection::height_weight(*part, z_force);
  force[static_cast<Eigen::Index>(2 * w.lower) + 1] = w.of_lower();
  force[static_cast<Eigen::Index>(2 * w.lower) + 3] = w.upper_fraction;
  return 1000 * deflection::lateral_at(*part, z_read, c * force).y();
}

/// The same of the plate. The edges touch the wall from x on, as far as the cut goes, with a chip that grows with the
/// turn: there they push, and there the survey reads the mean.
double plate_um_per_N(const Scene& scene, double x, double z_read, double z_force) {
  constexpr int kParts = 8;
  const double end = std::acos(1 - kAllowance / kRadius);
  std::vector<double> at, share;
  double sum = 0;
  for (int i = 0; i < kParts; ++i) {
    const double turn = (i + 0.5) / kParts * end;
    at.push_back(x + kRadius * std::sin(turn)), share.push_back(std::sin(turn));
    sum += share.back();
  }
  const test::CantileverPlate plate = scene.plate(x);
  std::vector<test::CantileverPlate::Load> loads;
  for (std::size_t i = 0; i < at.size(); ++i) loads.push_back({at[i], scene.tip + z_force, share[i] / sum});
  double out = 0;
  for (std::size_t i = 0; i < at.size(); ++i)
    out += 1000 * share[i] / sum * plate.deflection_mm(at[i], scene.tip + z_read, loads);
  return out;
}

void expect_like_plate(double tip) {
  const Scene scene(tip);
  const simulate::PartSurvey survey = simulate::survey_part(scene.job, scene.blank(), scene.path, {.cell_mm = 2});
  for (const double x : {3.0, 15.0, 30.0, 57.0})
    for (const auto& [read, force] : {std::pair{1.0, 1.0}, {1.0, 5.0}, {5.0, 5.0}}) {
      const double expected = plate_um_per_N(scene, x, read, force);
      EXPECT_NEAR(survey_um_per_N(scene, survey, x, read, force), expected, 0.05 * expected)
          << "x " << x << " z " << read << ", " << force;
    }
}

TEST(ThinWallSlow, YieldsLikeAPlateAtTheTop) { expect_like_plate(24); }
TEST(ThinWallSlow, YieldsLikeAPlateAtHalfHeight) { expect_like_plate(12); }

TEST(ThinWallSlow, PlacesAreFewWhereTheComplianceChangesLittle) {
  const Scene scene(24);
  const auto coarse = simulate::survey_part(scene.job, scene.blank(), scene.path, {.cell_mm = 3, .tolerance = 0.2}),
             fine = simulate::survey_part(scene.job, scene.blank(), scene.path, {.cell_mm = 3, .tolerance = 0.01});
  EXPECT_LT(coarse.solved, fine.solved);
  EXPECT_LT(coarse.solved, 25u);
}

/// The force along y on the tool at height z over the tip and its height, N/mm, while an edge passes the wall at z0:
/// higher parts of the edge lag and are still in the cut, before they leave it at the wall. h = f sin(theta), theta the
/// way to go to the wall; F = (K_t h + k_t) sin + (K_r h + k_r) cos.
double force_N_per_mm(const Scene& s, double z, double z0, double radial_mm) {
  const double theta = (z - z0) * std::tan(kHelix_rad) / kRadius;
  if (theta < 0 || radial_mm <= 0 || theta > std::acos(1 - radial_mm / kRadius)) return 0;
  const double h = s.feed_mm * std::sin(theta);
  return (s.material.ktc_MPa * h + s.material.kte_N_per_mm) * std::sin(theta) +
         (s.material.krc_MPa * h + s.material.kre_N_per_mm) * std::cos(theta);
}

/// Heights at which the wall's deflection is worked out, mm over the tip.
constexpr std::size_t kHeights = 7;
using AtHeights = std::array<double, kHeights>;

double at_height(const AtHeights& values, double z) {
  const auto below = std::min(static_cast<std::size_t>(z), kHeights - 2);
  return values[below] + (z - static_cast<double>(below)) * (values[below + 1] - values[below]);
}

/// Radial depth of a cut at heights over the tip, mm.
using RadialDepth = std::function<double(double z)>;

double whole_allowance(double) { return kAllowance; }

/// What the wall moves while an edge passes it at z0 over the tip, the tool at x, by plate theory; um by heights.
/// `given_way_um`: by which the edges stand farther off.
AtHeights plate_moves_um(const Scene& s, const test::CantileverPlate& plate, double x, double z0,
                         const AtHeights& given_way_um, const RadialDepth& radial_mm = whole_allowance) {
  constexpr double kStep = 0.1;
  std::vector<test::CantileverPlate::Load> loads;
  for (double z = kStep / 2; z < kLevel; z += kStep) {
    const double ahead = kRadius * std::sin((z - z0) * std::tan(kHelix_rad) / kRadius);
    const double force = kStep * force_N_per_mm(s, z, z0, radial_mm(z) - at_height(given_way_um, z) / 1000);
    if (force > 0) loads.push_back({x + ahead, s.tip + z, force});
  }
  AtHeights out{};
  for (std::size_t i = 0; i < kHeights; ++i)
    out[i] = 1000 * plate.deflection_mm(x, s.tip + static_cast<double>(i), loads);
  return out;
}

double rigid_error_um(const Scene& s, const test::CantileverPlate& plate, double x, double z0) {
  return at_height(plate_moves_um(s, plate, x, z0, {}), z0);
}

/// In static coupling the wall has given way until it bears the force of what is left: at each instant for itself, as
/// the tooth before had done the same at the same turn. In a cut that goes on, feed and chip stay; where the edge
/// enters does not.
double static_error_um(const Scene& s, const test::CantileverPlate& plate, double x, double z0,
                       const RadialDepth& radial_mm = whole_allowance) {
  AtHeights moved{};
  for (int round = 0; round < 40; ++round) {
    const AtHeights next = plate_moves_um(s, plate, x, z0, moved, radial_mm);
    for (std::size_t i = 0; i < kHeights; ++i) moved[i] += 0.4 * (next[i] - moved[i]);
  }
  return at_height(moved, z0);
}

/// What stands over kThin after several cuts in static coupling, mm, by steps of kStandsStep_mm over the tip: each cut
/// finds what the one before left.
constexpr double kStandsStep_mm = 0.25;
using Stands = std::vector<double>;

double stands_at(const Stands& stands, double z) {
  const auto below = std::min(static_cast<std::size_t>(std::max(0.0, z) / kStandsStep_mm), stands.size() - 2);
  const double way = std::clamp(z / kStandsStep_mm - static_cast<double>(below), 0.0, 1.0);
  return stands[below] + way * (stands[below + 1] - stands[below]);
}

Stands after_cuts_mm(const Scene& s, double x, const std::vector<double>& stands_off_mm) {
  Stands stands(static_cast<std::size_t>(kLevel / kStandsStep_mm) + 1, kAllowance);
  const auto mean = [](const Stands& v) {
    return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
  };
  for (const double off : stands_off_mm) {
    const Stands before = stands;
    const test::CantileverPlate plate = s.plate(x, std::max(0.0, off), mean(before));
    const RadialDepth depth = [&](double z) { return stands_at(before, z) - off; };
    for (std::size_t i = 0; i < stands.size(); ++i) {
      const double z = static_cast<double>(i) * kStandsStep_mm;
      stands[i] = std::min(before[i], off + static_error_um(s, plate, x, z, depth) / 1000);
    }
  }
  return stands;
}

struct CutWall {
  std::map<int, double> total_um, part_um;  ///< by whole millimetres over the tip, near x
  double chips_of_stock = 0;
  std::size_t unsettled = 0;
};

CutWall cut_wall(const Scene& s, machine::Coupling coupling, double x) {
  const auto survey = simulate::survey_part(s.job, s.blank(), s.path, {.cell_mm = 2});
  const auto part = survey.along(s.path, 0);
  removal::Stock stock = s.blank(), target(stock);
  simulate::sweep(target, s.tool, s.path.stamps, 0, 0);
  removal::CutterPlaces places;
  places.add(0, removal::shape_of(s.tool), s.path.stamps);
  removal::SurfaceMap map(target, places, stock), of_tool(map);
  simulate::CutOptions options;
  options.coupling = coupling;
  options.envelope_step_mm = 0.1;
  options.part = &*part;
  options.surface = &map, options.tool_surface = &of_tool;
  const auto result = simulate::cut(stock, s.tool, s.material, s.path.stamps, {}, 0, options);
  const auto errors = of_tool.take_errors_mm();
  CutWall out;
  out.chips_of_stock = result.chip_mm3 / result.stock_mm3, out.unsettled = result.unsettled;
  std::map<int, double> area;
  const auto points = map.take();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& p = points[i];
    const double z = p.place_mm.z() - s.tip, at = std::round(z);
    if (std::abs(p.place_mm.x() - x) > 1 || std::abs(p.normal.y()) < 0.99 || std::abs(z - at) > 0.25) continue;
    area[static_cast<int>(at)] += p.area_mm2;
    out.total_um[static_cast<int>(at)] += 1000 * p.error_mm * p.area_mm2;
    out.part_um[static_cast<int>(at)] += 1000 * (p.error_mm - static_cast<double>(errors[i])) * p.area_mm2;
  }
  for (auto& [z, sum] : out.total_um) sum /= area[z];
  for (auto& [z, sum] : out.part_um) sum /= area[z];
  return out;
}

TEST(ThinWallSlow, RigidCouplingLeavesWhatThePlateYields) {
  tests::LargestFigure walls("form error of a wall cut level by level", 0.05);
  for (const double tip : {24.0, 12.0}) {
    const Scene scene(tip);
    constexpr double kAt = 30;
    const CutWall cut = cut_wall(scene, machine::Coupling::rigid, kAt);
    const test::CantileverPlate plate = scene.plate(kAt);
    for (const int z : {1, 2, 3}) {
      const double expected = rigid_error_um(scene, plate, kAt, z);
      walls.expect(cut.total_um.at(z), expected, fmt::format("{} + {}", tip, z));
      EXPECT_NEAR(cut.part_um.at(z), cut.total_um.at(z), 0.02 * expected);
    }
  }
}

TEST(ThinWallSlow, StaticCouplingLeavesThePlatesEquilibrium) {
  tests::LargestFigure walls("form error of a wall cut level by level", 0.05);
  const Scene scene(24);
  constexpr double kAt = 30;
  const CutWall cut = cut_wall(scene, machine::Coupling::static_, kAt);
  EXPECT_EQ(cut.unsettled, 0u);
  EXPECT_NEAR(cut.chips_of_stock, 1, 0.03);
  const test::CantileverPlate plate = scene.plate(kAt);
  for (const int z : {1, 2, 3}) {
    const double expected = static_error_um(scene, plate, kAt, z);
    walls.expect(cut.total_um.at(z), expected, fmt::format("{}", z));
  }
}

// A tool that leans along the wall, as in five axes, makes the same surface: the chips and the forces are turned by 3
// degrees within the wall's plane.
TEST(ThinWallSlow, ALeaningToolBendsTheWallAlike) {
  const Scene upright(24);
  Scene leaning(24);
  for (removal::Stamp& s : leaning.path.stamps)
    s.pose = pose_of_frame(s.pose.tip_mm, Vec3(std::sin(3 * kPi / 180), 0, std::cos(3 * kPi / 180)), Vec3::UnitX());
  constexpr double kAt = 30;
  const CutWall expected = cut_wall(upright, machine::Coupling::static_, kAt);
  const CutWall cut = cut_wall(leaning, machine::Coupling::static_, kAt);
  EXPECT_EQ(cut.unsettled, 0u);
  for (const int z : {1, 2, 3}) {
    EXPECT_NEAR(cut.total_um.at(z), expected.total_um.at(z), 0.03 * expected.total_um.at(z)) << z;
    EXPECT_NEAR(cut.part_um.at(z), expected.part_um.at(z), 0.03 * expected.part_um.at(z)) << z;
  }
}

// What compensation emits for such a wall: a level is cut up to an allowance, and again past its surface.
TEST(ThinWallSlow, FurtherCutsLeaveThePlatesEquilibrium) {
  tests::LargestFigure walls("form error of a level that is cut three times, of what it springs back", 0.1);
  const std::vector<double> stands_off_mm{0.02, 0.02, -0.015};
  const Scene scene(24, 0.2, stands_off_mm);
  constexpr double kAt = 30;
  const CutWall cut = cut_wall(scene, machine::Coupling::static_, kAt);
  EXPECT_EQ(cut.unsettled, 0u);
  const Stands expected = after_cuts_mm(scene, kAt, stands_off_mm);
  for (const int z : {1, 2, 3, 4}) {
    const double sprung_um = 1000 * (stands_at(expected, z) - stands_off_mm.back());
    walls.expect(cut.total_um.at(z), sprung_um, fmt::format("{}", z));
  }
}

TEST(ThinWall, ThicknessIsFoundUnderTheSurface) {
  const Scene scene(24);
  removal::Stock stock = scene.blank();
  simulate::sweep(stock, scene.tool, scene.path.stamps, 0, 0);
  EXPECT_NEAR(simulate::thickness_mm(stock, {30, kThin, 27}, Vec3::UnitY(), 20), kThin, 0.1);
  EXPECT_EQ(simulate::thickness_mm(stock, {60, 1, 10}, Vec3::UnitX(), 20), 20);
  const simulate::Thickness wall{kThin, {30, kThin, 27}, Vec3::UnitY()};
  EXPECT_NEAR(simulate::reach_mm(stock, wall, 0, 100).value_or(0), 27, 1);
}

TEST(ThinWall, NothingHeldIsAnError) {
  Scene scene(24);
  scene.job.workpiece->fixed_bottom = false;
  scene.job.workpiece->fixed_boxes = {{{100, 0, 0}, {110, 2, 2}}};
  scene.job.workpiece->place.location = {"job.toml", 12, 9};
  try {
    simulate::survey_part(scene.job, scene.blank(), scene.path, {.cell_mm = 3});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(
        e.what(),
        "job.toml:12:9: error: fixed holds nothing of the part's material; a part that is held in the stock was "
        "expected [workpiece-loose]");
  }
}

TEST(ThinWall, NothingUnderTheToolIsAnError) {
  Scene scene(24);
  for (removal::Stamp& s : scene.path.stamps) s.pose.tip_mm.y() += 50;
  try {
    simulate::survey_part(scene.job, scene.blank(), scene.path, {.cell_mm = 3});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.diagnostics().front().check, "workpiece-loose");
    EXPECT_EQ(e.diagnostics().front().message,
              "nothing that is held of the part is under the tool anywhere; a part that it cuts was expected");
  }
}

}  // namespace
}  // namespace camber::testing
