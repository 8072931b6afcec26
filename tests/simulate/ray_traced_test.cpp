// Random short paths: Camber's engagement and force against the ray-traced ones (tests/support/ray_traced_cutting.h).
#include <cmath>
#include <cstdio>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.h"
#include "simulate/cut.h"
#include "tests/support/accuracy_figure.h"
#include "tests/support/cutting.h"
#include "tests/support/ray_traced_cutting.h"

namespace camber::simulate {
namespace {

using machine::ToolType;

const Vec3 kLow(0, -4, -4), kHigh(7, 4, 0);
constexpr double kTop = 1.6, kEdgeStep = 0.08;
constexpr int kStepsPerPitch = 45;
// Feeds of a thirtieth of the radius: what is left is the order of c / R (1 to 2 %) and the grid.
constexpr double kAgreement = 0.03, kToothByTooth = 0.05;

/// From a place in the block's side (its first stamp takes a cutter's worth of stock and no chip) along it, then
/// another line at random, up to 1.4 mm deep: slots, shoulders, ramps.
std::vector<removal::Stamp> random_path(std::mt19937& random, double radius) {
  std::uniform_real_distribution<double> y(-3, 3), depth(-1.4, -0.4), feed(0.04, 0.07);
  const double f = feed(random);
  std::vector<removal::Stamp> stamps;
  Vec3 at(1.0 - radius, y(random), depth(random));
  for (const double x : {1.2, 2.2}) {
    const Vec3 to(x, y(random), depth(random));
    std::vector<removal::Stamp> row;
    testing::add_row(row, at, to, f);
    // The corner's own step is shorter: its feed is the motion that there is.
    if (!stamps.empty()) {
      row.front().first = false;
      row.front().feed_per_tooth_mm = row.front().pose.tip_mm - stamps.back().pose.tip_mm;
      if (row.front().feed_per_tooth_mm.norm() < 1e-9) row.erase(row.begin());
    }
    stamps.insert(stamps.end(), row.begin(), row.end());
    at = stamps.back().pose.tip_mm;
  }
  return stamps;
}

struct Case {
  const char* name;
  machine::Tool tool;
  testing::DrawnCutter drawn;
};

std::vector<Case> cases() {
  auto bull = testing::make_tool(ToolType::bull, 5, 3, 20);
  bull.corner_radius_mm = 0.8;
  auto chamfer = testing::make_tool(ToolType::chamfer, 5, 2, 0);
  chamfer.tip_diameter_mm = 1;
  chamfer.point_angle_rad = rad_from_deg(90);
  return {{"ball", testing::make_tool(ToolType::ball, 5, 2, 30), testing::drawn_end_mill(2.5, 2.5, kTop, kEdgeStep)},
          {"flat", testing::make_tool(ToolType::flat, 4, 2, 30), testing::drawn_end_mill(2, 0, kTop, kEdgeStep)},
          {"bull", bull, testing::drawn_end_mill(2.5, 0.8, kTop, kEdgeStep)},
          {"chamfer", chamfer, testing::drawn_chamfer(0.5, 2.5, rad_from_deg(45), kTop, kEdgeStep)}};
}

TEST(RayTracedSlow, RandomShortPathsAgree) {
  std::mt19937 random(20);
  const machine::Material material{2000, 700, 200, 15, 12, 3};
  const testing::DrawnCoefficients drawn{2000, 700, 200, 15, 12, 3};
  for (auto& c : cases()) {
    // The drawn ball's edge ends at the depth of the cut, as every other.
    std::erase_if(c.drawn.edge, [](const auto& e) { return e.z > kTop; });
    for (int path = 0; path < 2; ++path) {
      const auto stamps = random_path(random, c.drawn.radius);
      const auto exact = testing::ray_traced_forces(c.drawn, c.tool.flutes, c.tool.helix_rad, kLow, kHigh, stamps,
                                                    drawn, kStepsPerPitch);
      auto stock = testing::make_box(kLow, kHigh, 0.1);
      CutOptions options;
      options.coupling = machine::Coupling::rigid;
      options.envelope_step_mm = kEdgeStep;
      options.rotation_step_rad = 2 * kPi / (kStepsPerPitch * c.tool.flutes);
      const CutResult ours = cut(stock, c.tool, material, stamps, {}, 0, options);
      Vec3 mean = Vec3::Zero(), exact_mean = Vec3::Zero();
      double peak = 0, exact_peak = 0, lateral = 0, exact_lateral = 0, chips = 0, exact_chips = 0, off = 0;
      for (std::size_t k = 0; k < stamps.size(); ++k) {
        mean += ours.loads[k].force_mean_N;
        exact_mean += exact[k].mean_N;
        peak = std::max(peak, ours.loads[k].lateral_max_N);
        exact_peak = std::max(exact_peak, exact[k].lateral_max_N);
        lateral += ours.loads[k].lateral_max_N;
        exact_lateral += exact[k].lateral_max_N;
        chips += ours.loads[k].chip_mm3;
        exact_chips += exact[k].chip_mm3;
        off += std::abs(ours.loads[k].lateral_max_N - exact[k].lateral_max_N);
      }
      std::printf(
          "%-8s path %d: %3zu stamps, mean force off %.2f %%, peak %+.2f %%, mean peak %+.2f %%, tooth by tooth "
          "%.2f %%, chips %+.2f %%\n",
          c.name, path, stamps.size(), 100 * (mean - exact_mean).norm() / exact_mean.norm(),
          100 * (peak / exact_peak - 1), 100 * (lateral / exact_lateral - 1), 100 * off / exact_lateral,
          100 * (chips / exact_chips - 1));
      const std::string of = fmt::format(", {}, path {}", c.name, path);
      tests::expect_vector_figure("mean force" + of, mean, exact_mean, kAgreement);
      tests::expect_figure("peak force" + of, peak, exact_peak, kAgreement);
      tests::expect_figure("mean of the peaks" + of, lateral, exact_lateral, kAgreement);
      EXPECT_LT(off, kToothByTooth * exact_lateral) << c.name;
    }
  }
}

}  // namespace
}  // namespace camber::simulate
