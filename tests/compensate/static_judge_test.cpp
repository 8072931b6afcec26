// The program emitted with lower feeds and second cuts, judged by the simulation in time (time_domain_milling.h), which
// shares nothing with Camber but where the passes lie and how fast they are. Sample 06, the wall that is milled
// upwards.
#include <algorithm>
#include <cmath>
#include <iostream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compensate/compensate_path.h"
#include "test_paths.h"
#include "tests/support/static_wall.h"

namespace camber::compensate {
namespace {

using testing::FinishedWall;
using testing::WallPass;

constexpr double kAt_mm = 9;  ///< along the wall y = 0, from X4 to X14

FinishedWall wall_of(const machine::Job& job) {
  const machine::Tool& tool = job.tools.at(1);
  FinishedWall w;
  w.diameter_mm = tool.diameter_mm, w.flutes = tool.flutes, w.helix_deg = 45;
  w.height_mm = 5.5, w.radial_mm = job.stock.allowance_mm, w.feed_mm = 0.04;
  w.young_MPa = tool.youngs_modulus_MPa;
  w.overhang_mm = tool.overhang_mm + 0.03;  // the judge's tip runs 0.53 mm below the block, the sample's 0.5
  w.material = job.material;
  return w;
}

/// The passes along the wall, from the stamps that stand nearest to kAt_mm.
std::vector<WallPass> passes_of(const simulate::SimulatedProgram& program) {
  std::vector<WallPass> out;
  const auto& stamps = program.path.stamps;
  for (std::size_t k = 1; k < stamps.size(); ++k) {
    const Vec3 &before = stamps[k - 1].pose.tip_mm, &now = stamps[k].pose.tip_mm;
    if (stamps[k].first || before.x() >= kAt_mm || now.x() < kAt_mm || now.z() > -5.9 || now.y() > -3.5) continue;
    out.push_back({now.y() + 4, stamps[k].feed_per_tooth_mm.norm()});
  }
  return out;
}

/// Camber's error, by the judge's slices of the height.
std::vector<double> predicted_um(const FinishedWall& w, const std::vector<removal::SurfacePoint>& surface) {
  testing::detail::Slices slices(w);
  for (const auto& p : surface)
    if (std::abs(p.place_mm.y()) < 0.05 && std::abs(p.place_mm.x() - kAt_mm) < testing::detail::kRead)
      slices.add(p.place_mm.z() + w.height_mm, p.error_mm, p.area_mm2);
  return slices.means();
}

double rms(const std::vector<double>& values) {
  double squares = 0;
  for (const double v : values) squares += v * v;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double out = 0;
  for (std::size_t i = 0; i < a.size(); ++i) out = std::max(out, std::abs(a[i] - b[i]));
  return out;
}

TEST(DrawnJudgeStaticSlow, FindsTheWallOfSample06StraightAfterASlowSecondCut) {
  Diagnostics diagnostics;
  machine::Job job = machine::read_job(CAMBER_SOURCE_DIR "/samples/06-wall/job.toml", diagnostics);
  job.operations.blocks.push_back({8, 16});  // the wall that is milled upwards
  using machine::Lever;
  job.compensation.levers = {Lever::shift, Lever::feed, Lever::passes};
  CompensateOptions options;
  options.time_budget_percent = 200;
  const CompensationResult c = compensate(job, diagnostics, options);
  const FinishedWall wall = wall_of(job);
  job.operations = {};
  const auto emitted = motion::simulate_motion(SourceText(job.program, c.emitted.text), job, {}, diagnostics);
  const std::vector<WallPass> passes = passes_of(emitted);
  ASSERT_EQ(passes.size(), 2u);
  testing::WallJudgeSteps steps;
  steps.rotation_deg = 0.5;
  const auto before = testing::judged_figures(wall, steps), after = testing::judged_figures(wall, passes, steps);
  const auto camber_before = predicted_um(wall, c.surfaces.before), camber_after = predicted_um(wall, c.surfaces.after);
  for (const WallPass& p : passes)
    std::cout << fmt::format("pass {:.1f} um towards the wall, {:.4f} mm a tooth\n", 1000 * p.offset_mm, p.feed_mm);
  std::cout << fmt::format("rms over the height: judge {:.2f} to {:.2f} um, Camber {:.2f} to {:.2f}\n",
                           rms(before.error_um), rms(after.error_um), rms(camber_before), rms(camber_after));
  for (std::size_t i = 0; i < after.error_um.size(); ++i)
    std::cout << fmt::format("{:5.2f} mm: {:6.2f} {:6.2f} -> {:6.2f} {:6.2f}\n", 0.25 + wall.slice_mm * (i + 0.5),
                             before.error_um[i], camber_before[i], after.error_um[i], camber_after[i]);
  EXPECT_EQ(before.unsettled_steps + after.unsettled_steps, 0);
  EXPECT_GT(rms(before.error_um), 3);
  EXPECT_LT(rms(after.error_um), 0.2 * rms(before.error_um));
  EXPECT_LT(largest_difference(after.error_um, camber_after), 0.5);
}

}  // namespace
}  // namespace camber::compensate
