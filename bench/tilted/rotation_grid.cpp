// Rotation tells all: stock, path and axis of an upright cut, turned together by every lead and tilt of -40 to 40
// degrees, against that cut. Static coupling. Prints the differences of each cutter's worst case.
//
//     build/release/bench/rotation_grid [STEP_DEG [CUTTER [VOXEL_MM]]]
//
// Default: steps of 20 degrees, all cutters, voxels of 0.1 mm.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "base/units.h"
#include "tests/support/tilted_scene.h"

namespace {

using namespace camber;

struct Worst {
  double force = 0, components = 0, chips = 0, p95 = 0, mean = 0;
  double force_at[2] = {}, p95_at[2] = {};  ///< lead and tilt, degrees
  void add(const testing::TiltedResult& is, const testing::TiltedResult& should, double lead, double tilt) {
    const auto raise = [](double& value, double to) { value = std::max(value, std::abs(to)); };
    const auto place = [&](double(&at)[2], double value, double to) {
      if (std::abs(to) > value) at[0] = lead, at[1] = tilt;
    };
    place(force_at, force, is.lateral_max_N / should.lateral_max_N - 1);
    place(p95_at, p95, is.error_um.p95 / should.error_um.p95 - 1);
    raise(force, is.lateral_max_N / should.lateral_max_N - 1);
    raise(components, (is.force_mean_N - should.force_mean_N).norm() / should.lateral_max_N);
    raise(chips, is.chip_mm3 / should.chip_mm3 - 1);
    raise(p95, is.error_um.p95 / should.error_um.p95 - 1);
    raise(mean, (is.error_um.mean - should.error_um.mean) / should.error_um.p95);
  }
};

Worst worst_of(const testing::TiltedScene& scene, double step_deg) {
  constexpr double kMost_deg = 40;
  constexpr auto kStatic = machine::Coupling::static_;
  const testing::TiltedResult upright =
      testing::cut_turned(scene, Mat3::Identity(), kStatic, 0.23, 1.17, testing::away_from_edges(scene));
  Worst worst;
  for (double lead = -kMost_deg; lead <= kMost_deg; lead += step_deg)
    for (double tilt = -kMost_deg; tilt <= kMost_deg; tilt += step_deg) {
      if (lead == 0 && tilt == 0) continue;
      const Mat3 turn =
          (Eigen::AngleAxisd(rad_from_deg(lead), Vec3::UnitY()) * Eigen::AngleAxisd(rad_from_deg(tilt), Vec3::UnitX()))
              .toRotationMatrix();
      worst.add(testing::cut_turned(scene, turn, kStatic, 0.23, 1.17, testing::away_from_edges(scene)), upright, lead,
                tilt);
    }
  return worst;
}

}  // namespace

int main(int argc, char** argv) {
  const double step_deg = argc > 1 ? std::atof(argv[1]) : 20;
  std::printf(
      "| cutter | peak force | at lead, tilt | mean force | chips | p95 of the error | at lead, tilt | mean error of "
      "p95 "
      "|\n|---|---|---|---|---|---|---|---|\n");
  constexpr std::array kNames{"ball", "flat", "bull-nose", "tapered ball", "ball, axial spring"};
  const auto scenes = testing::scenes();
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (argc > 2 && std::string_view(argv[2]) != kNames[i]) continue;
    testing::TiltedScene scene = scenes[i];
    if (argc > 3) scene.voxel_mm = std::atof(argv[3]);
    const Worst worst = worst_of(scene, step_deg);
    std::printf("| %s | %.2f %% | %g, %g | %.2f %% | %.2f %% | %.2f %% | %g, %g | %.2f %% |\n", kNames[i],
                100 * worst.force, worst.force_at[0], worst.force_at[1], 100 * worst.components, 100 * worst.chips,
                100 * worst.p95, worst.p95_at[0], worst.p95_at[1], 100 * worst.mean);
    std::fflush(stdout);
  }
}
