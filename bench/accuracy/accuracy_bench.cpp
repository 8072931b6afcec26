// Camber against the drawn cut (tests/support/displaced_envelope.h): tables of force and form error.
#include <cstdio>
#include <ctime>
#include <string>

#include <fmt/format.h>

#include "tests/support/inclined_plane.h"

using namespace camber;
using testing::CutFigures;
using testing::InclinedPlane;

namespace {

double off(double got, double want) { return 100 * (got / want - 1); }

void print(const char* name, const CutFigures& f) {
  std::printf("%-44s %8.3f %8.4f %8.4f %8.4f  %7.3f %7.3f %7.3f %7.3f %9.6f\n", name, f.lateral_max_N, f.mean_N.x(),
              f.mean_N.y(), f.mean_N.z(), f.p5_um, f.median_um, f.p95_um, f.error_mean_um, f.chip_mm3);
}

void print_off(const char* name, const CutFigures& f, const CutFigures& want) {
  const double n = want.mean_N.norm();
  std::printf("%-44s %+8.2f %+8.2f %+8.2f %+8.2f  %+7.2f %+7.2f %+7.2f %+7.2f %+9.2f   %.4f\n", name,
              off(f.lateral_max_N, want.lateral_max_N), 100 * (f.mean_N.x() - want.mean_N.x()) / n,
              100 * (f.mean_N.y() - want.mean_N.y()) / n, 100 * (f.mean_N.z() - want.mean_N.z()) / n,
              off(f.p5_um, want.p5_um), off(f.median_um, want.median_um), off(f.p95_um, want.p95_um),
              off(f.error_mean_um, want.error_mean_um), off(f.chip_mm3, want.chip_mm3), f.chips_of_stock);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "all";
  if (what == "one") {
    InclinedPlane p;
    auto t = std::clock();
    const CutFigures want = drawn_figures(p);
    print("drawn", want);
    std::printf("%.1f s\n", double(std::clock() - t) / CLOCKS_PER_SEC), t = std::clock();
    const CutFigures got = camber_figures(p);
    print("camber", got);
    print_off("off, %", got, want);
    std::printf("%.1f s\n", double(std::clock() - t) / CLOCKS_PER_SEC);
  }
  if (what == "shift") {
    InclinedPlane p;
    p.feed_mm = argc > 2 ? std::atof(argv[2]) : 0.15;
    p.slope_deg = argc > 3 ? std::atof(argv[3]) : 45;
    const CutFigures want = drawn_figures(p);
    print("drawn", want);
    const double v = p.voxel_mm;
    for (const Vec3& o : {Vec3(0, 0, 0), Vec3(0.33, 0, 0), Vec3(0.67, 0, 0), Vec3(0, 0.37, 0), Vec3(0, 0, 0.29), Vec3(0.5, 0.5, 0.5), Vec3(0.21, 0.83, 0.62), Vec3(0.71, 0.13, 0.41)}) {
      p.offset_mm = v * o;
      print_off(fmt::format("grid at {:.2f} {:.2f} {:.2f} voxels", o.x(), o.y(), o.z()).c_str(), camber_figures(p), want);
    }
  }
  if (what == "try") {
    InclinedPlane p;
    print("drawn", drawn_figures(p));
    p.steps_per_pitch = 180;
    p.feed_mm = 0.15;
    const CutFigures want = drawn_figures(p);
    for (const double v : {0.2, 0.1})
      for (const double e : {0.03})
        for (const int s : {180, 360}) {
          p.voxel_mm = v, p.diameter_step_mm = e, p.steps_per_pitch = s;
          print_off(fmt::format("voxel {} edge {} steps {}", v, e, s).c_str(), camber_figures(p), want);
        }
  }
}
