#include "copymill/copy_milling.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "kinematics/control_options.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"
#include "removal/engagement.h"
#include "simulate/job_stock.h"
#include "simulate/predict_path.h"
#include "tests/copymill/small_copy.h"

namespace camber::copymill {
namespace {

using tests::read_copy;
using tests::ReadCopy;
using tests::SmallCopy;
using tests::TempFolder;

const std::string kRough =
    "[[copy]]\ntool = 1\nmode = \"contour-line\"\nspindle_rpm = 2000\nfeed_mm_per_min = 3000\nradial_depth_mm = 4\n"
    "axial_depth_mm = 4\nallowance_mm = 0.3\n";
const std::string kRows =
    "[[copy]]\ntool = 1\nmode = \"scanning-line\"\nspindle_rpm = 2000\nfeed_mm_per_min = 3000\nradial_depth_mm = 4\n"
    "axial_depth_mm = 4\nallowance_mm = 0.3\nangle_deg = 30\n";

struct Copied {
  ReadCopy read;
  CopyResult result;
};

Copied copied(const TempFolder& folder, const SmallCopy& c, const CopyOptions& options = {}) {
  Copied out{read_copy(folder, c), {}};
  Diagnostics diagnostics;
  out.result = copy(out.read.job, out.read.operations, options, diagnostics);
  return out;
}

/// Area of the sample's pocket that a cutter can clear: without what its radius leaves in the four corners.
double pocket_mm3(double radius, double allowance, double depth) {
  const double w = 50 - 2 * allowance, h = 35 - 2 * allowance, island = (12 + 2 * allowance) * (10 + 2 * allowance);
  const double rounded_island = island - (4 - kPi) * allowance * allowance;
  return (w * h - (4 - kPi) * radius * radius - rounded_island) * (depth - allowance);
}

TEST(Copy, RoughsAPocketWithAnIslandByLoops) {
  const TempFolder folder;
  const CopyResult r = copied(folder, {.operations = kRough}).result;
  EXPECT_NEAR(r.removed_mm3 / pocket_mm3(4, 0.3, 8), 1, 0.004);
  ASSERT_EQ(r.operations.size(), 1u);
  EXPECT_EQ(r.operations[0].levels, 2u);
  EXPECT_GT(r.operations[0].ramps, 0u);
  EXPECT_EQ(r.operations[0].plunges, 0u);
}

TEST(Copy, RoughsThePocketByRowsAndItsOutline) {
  const TempFolder folder;
  const CopyResult r = copied(folder, {.operations = kRows}).result;
  EXPECT_NEAR(r.removed_mm3 / pocket_mm3(4, 0.3, 8), 1, 0.004);
}

const std::string kFinish =
    "[[copy]]\ntool = 1\nmode = \"contour-line\"\nspindle_rpm = 4000\nfeed_mm_per_min = 3000\nradial_depth_mm = 4\n"
    "axial_depth_mm = 8\n";

TEST(Copy, FinishesWallsAndFloorToThePart) {
  const TempFolder folder;
  const CopyResult r = copied(folder, {.operations = kRough + kFinish}).result;
  EXPECT_NEAR(r.removed_mm3 / pocket_mm3(4, 0, 8), 1, 0.001);
  EXPECT_LT(r.path_depth_um, 5);
  EXPECT_LT(r.left.max_um, 20);
  EXPECT_LT(r.left.p95_um, 2);
  EXPECT_GT(r.left.unreached_mm2, 50);  // the corners of the pocket
}

/// Stock cut along the program's own moves, without servo lag.
removal::Stock cut_by_program(const machine::Job& job, const std::string& text) {
  Diagnostics diagnostics;
  const simulate::SimulatedProgram program = motion::simulate_motion(SourceText("out.nc", text), job, {}, diagnostics);
  removal::Stock stock = simulate::job_stock(job, 4, [](const Vec3&, const Vec3&) {});
  simulate::sweep_path(stock, job, removal::nominal_path(program.moves_in_part(), program.selected, program.path), 0);
  return stock;
}

/// Greatest difference of two stocks where one has its surface, on the voxels.
double difference_mm(const removal::Stock& a, const removal::Stock& b) {
  double out = 0;
  const double v = a.voxel_mm();
  const auto low = [&](int k) { return static_cast<int>(std::floor(a.min_mm()[k] / v)) - 1; };
  const auto high = [&](int k) { return static_cast<int>(std::ceil(a.max_mm()[k] / v)) + 1; };
  for (int x = low(0); x <= high(0); ++x)
    for (int y = low(1); y <= high(1); ++y)
      for (int z = low(2); z <= high(2); ++z) {
        const double d = a.voxel({x, y, z}), e = b.voxel({x, y, z});
        if (std::min(std::abs(d), std::abs(e)) < v) out = std::max(out, std::abs(d - e));
      }
  return out;
}

TEST(Copy, TheProgramLeavesTheSameStockWithinATenthOfAVoxel) {
  const TempFolder folder;
  const Copied c = copied(folder, {.operations = kRough + kFinish});
  EXPECT_LT(difference_mm(*c.result.stock, cut_by_program(c.read.job, c.result.text)), 0.1 * 0.25);
}

TEST(Copy, StoppedHalfWayAndTakenUpEndsWithTheSameSurface) {
  const TempFolder folder;
  const Copied whole = copied(folder, {.operations = kRough});
  const Copied half = copied(folder, {.operations = kRough}, {.stop_after_s = whole.result.time_s / 2});
  EXPECT_TRUE(half.result.stopped);
  EXPECT_LT(half.result.removed_mm3, 0.8 * whole.result.removed_mm3);
  half.result.stock->save(folder / "half.vdb");
  const Copied rest = copied(folder, {.stock = "vdb = \"half.vdb\"", .operations = kRough});
  EXPECT_LT(rest.result.time_s, 0.8 * whole.result.time_s);
  EXPECT_LT(difference_mm(*whole.result.stock, *rest.result.stock), 0.1 * 0.25);
}

TEST(Copy, EveryStopLeavesNoGouge) {
  const TempFolder folder;
  for (const double stop : {3.0, 7.77, 12.345}) {
    const CopyResult r = copied(folder, {.operations = kFinish}, {.stop_after_s = stop}).result;
    EXPECT_TRUE(r.stopped);
    EXPECT_LT(r.path_depth_um, 5);
    EXPECT_LT(r.left.gouge_um, 10);
  }
}

/// Wherever the tool is when it is told to stop, in a cut or in a rapid between two: axes brake within their 1000
/// mm/s^2, and all that is left of the way is what braking takes, with half of that, and the rounding of corners.
TEST(Copy, AStopAtAnyTickBrakesWithinTheLimits) {
  const TempFolder folder;
  const double fastest = 150, dt = 0.001, acceleration = 1000;
  for (const std::string& operations : {kRough, kRough + "slotting = \"trochoidal\"\n"}) {
    for (const double stop : {2.001, 4.4, 9.999}) {
      std::vector<Tick> ticks;
      CopyOptions options;
      options.loads = false;
      options.stream = [&](const Tick& t) { ticks.push_back(t); };
      options.stop_after_s = stop;
      const CopyResult r = copied(folder, {.operations = operations, .voxel_mm = 0.5}, options).result;
      EXPECT_TRUE(r.stopped);
      EXPECT_LT(r.path_depth_um, 5) << stop;
      double worst = 0, way_mm = 0;
      for (std::size_t k = 2; k < ticks.size(); ++k) {
        const Vec3 v1 = (ticks[k].tip_mm - ticks[k - 1].tip_mm) / dt;
        const Vec3 v0 = (ticks[k - 1].tip_mm - ticks[k - 2].tip_mm) / dt;
        worst = std::max(worst, ((v1 - v0) / dt).cwiseAbs().maxCoeff());
        const bool lifted = ticks[k].tip_mm.z() > ticks[k - 1].tip_mm.z() + 1e-6;
        if (ticks[k - 1].t_s >= stop && !lifted) way_mm += v1.norm() * dt;
        if (ticks[k - 1].t_s >= stop && lifted && v0.norm() < 1e-9) break;  // the tool stands, and is lifted
      }
      EXPECT_LT(worst, 1.001 * acceleration) << stop;
      EXPECT_LT(way_mm, fastest * fastest / (2 * 0.5 * acceleration) + fastest * 0.01) << stop;
    }
  }
}

TEST(Copy, TheStreamHasATickEveryPeriodAndKeepsTheFeed) {
  const TempFolder folder;
  std::vector<Tick> ticks;
  CopyOptions options;
  options.stream = [&](const Tick& t) { ticks.push_back(t); };
  options.stop_after_s = 10;
  const CopyResult r = copied(folder, {.operations = kRough}, options).result;
  ASSERT_EQ(ticks.size(), r.ticks);
  for (std::size_t k = 1; k < ticks.size(); ++k) ASSERT_NEAR(ticks[k].t_s - ticks[k - 1].t_s, 0.001, 1e-9);
}

TEST(Copy, DrillsPecksWhereItIsAskedTo) {
  const TempFolder folder;
  const CopyResult r = copied(folder, {.operations = "[[copy]]\ntool = 3\nmode = \"drilling\"\nspindle_rpm = 4000\n"
                                                     "feed_mm_per_min = 400\naxial_depth_mm = 3\n"
                                                     "holes_mm = [[10, 10], [20, 10]]\nregion = { z_mm = [-8, 0] }\n"})
                           .result;
  // The point of 118 degrees takes a cone less.
  const double cone_mm = 2.5 / std::tan(59 * kPi / 180);
  EXPECT_NEAR(r.removed_mm3 / (2 * kPi * 6.25 * (8 - 2 * cone_mm / 3)), 1, 0.01);
  EXPECT_EQ(r.operations[0].passes, 2u);
}

std::string message_of(const SmallCopy& c) {
  const TempFolder folder;
  try {
    copied(folder, c);
  } catch (const InputError& e) {
    std::string out;
    for (const Diagnostic& d : e.diagnostics()) out += to_string(d) + "\n";
    for (std::size_t at = 0; (at = out.find(folder.path() + "/", at)) != std::string::npos;)
      out.erase(at, folder.path().size() + 1);
    const std::string samples = CAMBER_SOURCE_DIR "/samples/14-copy-milling/";
    for (std::size_t at = 0; (at = out.find(samples, at)) != std::string::npos;) out.erase(at, samples.size());
    return out;
  }
  return "nothing was said";
}

TEST(Copy, SaysWhatIsWrongLikeACompiler) {
  EXPECT_EQ(
      message_of({.stock = "box_mm = [[0, 0, -10], [50, 45, 0]]", .operations = kRough}),
      "island.stl: error: the part, X0 Y0 Z-15 to X60 Y45 Z0, is not inside the stock, X0 Y0 Z-10 to X50 Y45 Z0; a "
      "part that the stock holds was expected [part-outside-stock]\n");
}

/// The sample's slot, whose right half is 40 % harder than the rule knows.
TEST(Copy, HoldsTheForceWhereTheMaterialIsHarderThanItKnows) {
  const std::string folder = CAMBER_SOURCE_DIR "/samples/14-copy-milling/";
  Diagnostics diagnostics;
  const machine::Job job = machine::read_unprogrammed_job(folder + "slot.toml", diagnostics);
  const auto operations = machine::read_copy_operations(folder + "slot.toml", job, diagnostics);
  CopyOptions options;
  options.regions = simulate::read_force_regions(folder + "hard.csv");
  options.stop_after_s = 12;
  const CopyResult r = copy(job, operations, options, diagnostics);
  const LoadFigures& load = r.operations.at(0).load;
  EXPECT_EQ(load.over, 0u);
  EXPECT_GT(load.max_N, 0.95 * load.target_N);
  EXPECT_GT(load.counted, 1000u);
  EXPECT_GT(static_cast<double>(load.within), 0.95 * static_cast<double>(load.counted));
  ASSERT_FALSE(r.operations[0].changes.empty());
  for (std::size_t k = 1; k < r.operations[0].changes.size(); ++k)
    EXPECT_GE(r.operations[0].changes[k].t_s, r.operations[0].changes[k - 1].t_s);
}

}  // namespace
}  // namespace camber::copymill
