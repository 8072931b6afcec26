// Servo lag is taken back by the path: a bore against the closed form of a circle under first-order lag.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compensate/compensate_path.h"
#include "test_paths.h"
#include "tests/support/temp_folder.h"

namespace camber::compensate {
namespace {

constexpr double kRadius_mm = 8, kFeed_mm_per_min = 2400, kGain_per_s = 150;

/// A bore of 16 mm and the cutter's diameter, with ways in and out on an arc.
std::string bore_program() {
  return fmt::format(
      "G21 G90 G17 G40 G49 G80\nT1 M6\nG54 S12000 M3\nG0 Z5.\nG0 X0. Y0.\nZ-2.\n"
      "G1 X4. Y-4. F{1:.0f}\nG3 X{0:.3f} Y0. I0. J4.\nG3 X-{0:.3f} Y0. I-{0:.3f} J0.\nG3 X{0:.3f} Y0. I{0:.3f} J0.\n"
      "G3 X4. Y4. I-4. J0.\nG1 X0. Y0.\nG0 Z5.\nM5\nM30\n",
      kRadius_mm, kFeed_mm_per_min);
}

machine::Job bore_job(const tests::TempFolder& folder) {
  machine::Job job;
  job.path = folder / "job.toml";
  job.program = folder.write("bore.nc", bore_program());
  for (auto& axis : job.machine.axis) {
    axis.acceleration_mm_per_s2 = 4000;
    axis.max_velocity_mm_per_s = 200;
    axis.position_gain_per_s = kGain_per_s;
  }
  job.machine.control.corner = {.law = machine::CornerLaw::blend, .tolerance_mm = 0.01};
  machine::Tool tool;
  tool.number = 1;
  tool.type = machine::ToolType::flat;
  tool.diameter_mm = 6;
  tool.flutes = 3;
  tool.overhang_mm = 20;
  tool.youngs_modulus_MPa = 1.2e6;  // what is left is the axes' error alone
  job.tools[1] = tool;
  job.material = {400, 100, 0, 2, 2, 0};
  job.stock.box = machine::Box{{-13, -13, -2}, {13, 13, 0}};
  job.stock.allowance_mm = 0.05;
  job.simulation.coupling = machine::Coupling::rigid;
  job.compensation.tolerance_um = 1;
  return job;
}

/// Radius that axes of first-order lag run where a circle of `radius_mm` is commanded: r / sqrt(1 + (v / (r Kp))^2).
double run_radius_mm(double radius_mm) {
  return radius_mm / std::hypot(1.0, kFeed_mm_per_min / 60 / (radius_mm * kGain_per_s));
}

TEST(ServoLag, OfABoreIsTakenBack) {
  const tests::TempFolder folder;
  Diagnostics diagnostics;
  const machine::Job job = bore_job(folder);
  const double given_um = 1000 * (kRadius_mm - run_radius_mm(kRadius_mm));
  ASSERT_GT(given_um, 3);
  const CompensationResult c = compensate(job, diagnostics, {});
  // The ways in and out are off by more than the bore itself.
  EXPECT_GT(c.figures.before_um.p95, 0.95 * given_um) << "the closed form, before";
  EXPECT_LT(c.figures.after_um.p95, 0.7 * given_um);
  EXPECT_LT(c.figures.after_um.p95, 0.42 * c.figures.before_um.p95);
}

/// The axes cut the corner of sample 07 short by 0.07 mm, which leaves 194 um at the foot of its walls; a path that may
/// not turn by more than 3 degrees between blocks takes none of that back.
TEST(ServoLag, OfACornerIsTakenBackByAPathThatTurnsMoreThere) {
  Diagnostics diagnostics;
  machine::Job job = machine::read_job(CAMBER_SOURCE_DIR "/samples/07-pocket-corner/job.toml", diagnostics);
  job.compensation.levers = {machine::Lever::shift};
  job.compensation.max_overcut_um = 100;
  const CompensationResult c = compensate(job, diagnostics, {});
  EXPECT_GT(c.figures.before_um.max, 150);
  EXPECT_LT(c.figures.after_um.max, 50);
  EXPECT_LT(c.figures.after_um.rms, 0.4 * c.figures.before_um.rms);
  EXPECT_LE(c.path.quality.angle_growth_rad, kPi / 6 + 0.01) << "a third of the corner's right angle";
}

}  // namespace
}  // namespace camber::compensate
