// Random small jobs: what a compensation never does to any of them.
#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compensate/compensate_path.h"
#include "tests/support/temp_folder.h"

namespace camber::compensate {
namespace {

using Random = std::mt19937;

constexpr double kWorstPoint_um = 10.5;   // by which a single point becomes worse at most; most jobs stay below 5
constexpr double kWorseFraction = 0.059;  // of the area, over the tolerance and worse than given by more than 1 um

double between(Random& random, double from, double to) {
  return from + (to - from) * static_cast<double>(random() >> 8) / static_cast<double>(1u << 24);
}

/// Rows along X on a plane inclined by `slope_rad`, cut by a ball of R3.
std::string rows_program(double slope_rad, double row_mm, double feed_mm_per_min) {
  std::string out = "G21 G90 G17 G40 G49 G80\nT1 M6\nG54 S3000 M3\nG0 X8. Y-4. Z12.\n";
  const double c = std::cos(slope_rad), s = std::sin(slope_rad);
  for (double along = -1.2; along < 3.6; along += row_mm)
    out += fmt::format("G0 X8. Y{:.4f}\nZ{:.4f}\nG1 X-3. F{:.0f}\nG0 Z12.\n", along * c - 3 * s, along * s + 3 * c - 3,
                       feed_mm_per_min);
  return out + "M5\nM30\n";
}

machine::Job random_job(unsigned seed, const tests::TempFolder& folder) {
  Random random(seed);
  machine::Job job;
  job.path = folder / "job.toml";
  job.program = folder.write(
      "rows.nc", rows_program(between(random, 0.4, 1.1), between(random, 0.25, 0.4), between(random, 500, 1400)));
  for (auto& axis : job.machine.axis) {
    axis.acceleration_mm_per_s2 = between(random, 500, 3000);
    axis.max_velocity_mm_per_s = 100;
  }
  if (random() % 2 == 0) job.machine.control.corner = {.law = machine::CornerLaw::blend, .tolerance_mm = 0.01};
  machine::Tool tool;
  tool.number = 1;
  tool.diameter_mm = 6;
  tool.helix_rad = between(random, 0.1, 0.8);
  tool.overhang_mm = between(random, 25, 60);
  job.tools[1] = tool;
  job.material = {between(random, 700, 2500), 700, 0, 15, 15, 0};
  job.stock.box = machine::Box{{0, 0, -1}, {4, 2.5, 4}};
  job.stock.allowance_mm = between(random, 0.1, 0.3);
  job.simulation.voxel_mm = 0.15;
  job.simulation.coupling = machine::Coupling::rigid;
  job.compensation.tolerance_um = between(random, 0.5, 5);
  job.compensation.max_rounds = 3;
  if (random() % 2 == 0) job.compensation.max_overcut_um = between(random, 2, 20);
  return job;
}

class RandomJobs : public ::testing::TestWithParam<unsigned> {};

void expect_kept_promises(unsigned seed) {
  const tests::TempFolder folder;
  Diagnostics diagnostics;
  const machine::Job job = random_job(seed, folder);
  const CompensationResult c = compensate(job, diagnostics, {});
  EXPECT_LE(c.figures.after_um.rms, c.figures.before_um.rms);
  EXPECT_LE(c.figures.after_um.p95, c.figures.before_um.p95);
  EXPECT_LE(c.safety.after.gouge_depth_p999_um, std::max(c.safety.depth_limit_um, c.safety.before.gouge_depth_p999_um));
  EXPECT_LE(c.figures.feed_after.time_s, 1.104 * c.figures.feed_before.time_s) << "the budget by default, and its room";
  ASSERT_EQ(c.surfaces.before.size(), c.surfaces.after.size());
  double worse_um = 0, area = 0, worse_area = 0, over_area = 0;
  for (std::size_t i = 0; i < c.surfaces.before.size(); ++i) {
    const auto &before = c.surfaces.before[i], &after = c.surfaces.after[i];
    if (!before.valid || !after.valid) continue;
    const double more_um = 1000 * (std::abs(after.error_mm) - std::abs(before.error_mm));
    worse_um = std::max(worse_um, more_um);
    area += before.area_mm2;
    if (more_um <= 1) continue;
    worse_area += before.area_mm2;
    if (std::abs(after.error_mm) > job.compensation.tolerance_um / 1000) over_area += before.area_mm2;
  }
  // What is left is at the ends of rows, where the error falls to a quarter within one node, and at the upper border,
  // where the ball leaves both signs at one place: bounds that cost over a quarter of the percentile make room for it.
  EXPECT_LE(worse_um, kWorstPoint_um);
  EXPECT_LE(over_area, kWorseFraction * area);
  EXPECT_NEAR(c.figures.worse.area_fraction, over_area / area, 1e-9);
  fmt::print(
      "seed {}: p95 {:.2f} to {:.2f} um, worse by {:.2f} um, {:.3f} % of the area by more than 1 um, {:.3f} % of it "
      "over "
      "the tolerance; round {} of {}\n",
      seed, c.figures.before_um.p95, c.figures.after_um.p95, worse_um, 100 * worse_area / area, 100 * over_area / area,
      c.best, c.rounds.size() - 1);
}

TEST_P(RandomJobs, AreNeverWorseThanGivenNorBeyondTheirLimits) { expect_kept_promises(GetParam()); }

TEST(CombinedRounds, TakeEachPlaceFromTheRoundThatLeavesTheLeastThere) {
  const tests::TempFolder folder;
  Diagnostics diagnostics;
  const CompensationResult c = compensate(random_job(29, folder), diagnostics, {});
  ASSERT_TRUE(c.rounds[c.best].combined);
  for (std::size_t i = 0; i < c.rounds.size(); ++i) {
    if (i == c.best) continue;
    EXPECT_LT(c.rounds[c.best].error_um.p95, 0.95 * c.rounds[i].error_um.p95) << "round " << i;
    EXPECT_LT(c.rounds[c.best].error_um.rms, 0.95 * c.rounds[i].error_um.rms) << "round " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Quick, RandomJobs, ::testing::Range(0u, 10u));
INSTANTIATE_TEST_SUITE_P(Slow, RandomJobs, ::testing::Range(10u, 40u));

}  // namespace
}  // namespace camber::compensate
