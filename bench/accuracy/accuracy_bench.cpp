// Camber against the drawn cut (tests/support/displaced_envelope.h): force and form error of rigid finishing cuts.
//   accuracy_bench plane | cutters | uneven | grid | wall | voxels | static
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/support/deflected_shoulder.h"
#include "tests/support/finished_wall.h"
#include "tests/support/inclined_plane.h"

using namespace camber;
using testing::CutFigures;
using testing::FinishedWall;
using testing::InclinedPlane;
using testing::WallFigures;

namespace {

double off(double got, double want) { return 100 * (got / want - 1); }

void head_of_plane() {
  std::printf("%-40s %8s %8s %8s %8s %8s %8s %8s %8s\n", "", "peak F", "mean Fx", "mean Fy", "mean Fz", "err p5",
              "err p50", "err p95", "err mean");
}

void print_drawn(const CutFigures& f) {
  std::printf("%-40s %8.2f %8.3f %8.3f %8.3f %8.2f %8.2f %8.2f %8.2f   N, um\n", "  drawn", f.lateral_max_N,
              f.mean_N.x(), f.mean_N.y(), f.mean_N.z(), f.p5_um, f.median_um, f.p95_um, f.error_mean_um);
}

/// Forces' means against the mean force's length.
void print_off(const std::string& name, const CutFigures& f, const CutFigures& want) {
  const Vec3 mean = 100 * (f.mean_N - want.mean_N) / want.mean_N.norm();
  std::printf("%-40s %+8.2f %+8.2f %+8.2f %+8.2f %+8.2f %+8.2f %+8.2f %+8.2f   %%\n", name.c_str(),
              off(f.lateral_max_N, want.lateral_max_N), mean.x(), mean.y(), mean.z(), off(f.p5_um, want.p5_um),
              off(f.median_um, want.median_um), off(f.p95_um, want.p95_um), off(f.error_mean_um, want.error_mean_um));
  std::fflush(stdout);
}

void plane_case(const std::string& name, InclinedPlane p) {
  p.drawn_steps = 2880 / p.flutes, p.drawn_edge = 0.01;
  const CutFigures want = drawn_figures(p);
  std::printf("%s\n", name.c_str());
  print_drawn(want);
  print_off("  Camber, off by", camber_figures(p), want);
}

void planes() {
  head_of_plane();
  for (const double slope : {5.0, 15.0, 20.0, 30.0, 45.0, 60.0, 75.0}) {
    InclinedPlane p;
    p.slope_deg = slope;
    plane_case(fmt::format("slope {} deg", slope), p);
  }
  for (const double feed : {0.05, 0.1, 0.2, 0.3}) {
    InclinedPlane p;
    p.feed_mm = feed;
    plane_case(fmt::format("45 deg, {} mm/tooth", feed), p);
  }
  InclinedPlane p;
  p.upwards = false;
  plane_case("45 deg, rows downwards", p);
  p.along_x = 1;
  plane_case("45 deg, rows downwards, along +X", p);
  p.upwards = true;
  plane_case("45 deg, rows upwards, along +X", p);
  p.along_x = 0;
  plane_case("45 deg, rows upwards, to and fro", p);
  p = {};
  p.row_mm = 0.5;
  plane_case("45 deg, rows 0.5 mm apart", p);
  p.row_mm = 0.15;
  plane_case("45 deg, rows 0.15 mm apart", p);
  p = {};
  p.allowance_mm = 0.4;
  plane_case("45 deg, allowance 0.4 mm", p);
  for (const int flutes : {3, 4}) {
    p = {};
    p.flutes = flutes;
    plane_case(fmt::format("45 deg, {} flutes", flutes), p);
  }
  for (const double helix : {0.0, 45.0}) {
    p = {};
    p.helix_deg = helix;
    plane_case(fmt::format("45 deg, helix {}", helix), p);
  }
}

/// Bull-nose and tapered cutters, and rows along the fall line.
void cutters() {
  head_of_plane();
  for (const double slope : {20.0, 45.0})
    for (const double way : {1.0, -1.0}) {
      InclinedPlane p;
      p.slope_deg = slope, p.along_slope = way;
      plane_case(fmt::format("ball, {} deg, {}", slope, way > 0 ? "climbing" : "descending"), p);
    }
  for (const double corner : {1.0, 0.5})
    for (const double slope : {20.0, 45.0}) {
      InclinedPlane p;
      p.corner_mm = corner, p.slope_deg = slope;
      plane_case(fmt::format("bull R{}, {} deg", corner, slope), p);
    }
  for (const double way : {1.0, -1.0}) {
    InclinedPlane p;
    p.corner_mm = 1, p.along_slope = way;
    plane_case(fmt::format("bull R1, 45 deg, {}", way > 0 ? "climbing" : "descending"), p);
  }
  for (const double slope : {20.0, 45.0, 80.0}) {
    InclinedPlane p;
    p.taper_deg = 5, p.slope_deg = slope;
    plane_case(fmt::format("tapered ball, {} deg", slope), p);
  }
}

void grid() {
  head_of_plane();
  InclinedPlane p;
  const CutFigures want = drawn_figures(p);
  print_drawn(want);
  for (const Vec3& o : {Vec3(0, 0, 0), Vec3(0.33, 0, 0), Vec3(0.67, 0, 0), Vec3(0, 0.37, 0), Vec3(0, 0, 0.29),
                        Vec3(0.5, 0.5, 0.5), Vec3(0.21, 0.83, 0.62), Vec3(0.71, 0.13, 0.41)}) {
    p.offset_mm = p.voxel_mm * o;
    print_off(fmt::format("  shifted by {:.2f} {:.2f} {:.2f} voxels", o.x(), o.y(), o.z()), camber_figures(p), want);
  }
}

void wall_case(const FinishedWall& w) {
  const WallFigures want = drawn_figures(w), got = camber_figures(w);
  const Vec3 mean = 100 * (got.mean_N - want.mean_N) / want.mean_N.norm();
  std::printf(
      "%s, helix %g, %d flutes, ae %g, %g mm/tooth: peak %.2f N %+.2f %%, mean %.3f %.3f %.3f N %+.2f %+.2f %+.2f %%\n",
      w.up ? "up" : "down", w.helix_deg, w.flutes, w.radial_mm, w.feed_mm, want.lateral_max_N,
      off(got.lateral_max_N, want.lateral_max_N), want.mean_N.x(), want.mean_N.y(), want.mean_N.z(), mean.x(), mean.y(),
      mean.z());
  double largest = 0, worst = 0;
  for (const double e : want.error_um) largest = std::max(largest, std::abs(e));
  for (std::size_t i = 0; i < want.error_um.size(); ++i)
    worst = std::max(worst, std::abs(got.error_um[i] - want.error_um[i]));
  for (const auto* f : {&want, &got}) {
    std::printf(f == &want ? "  drawn  um" : "  Camber um");
    for (const double e : f->error_um) std::printf(" %7.2f", e);
    std::printf("\n");
  }
  std::printf("  largest difference %.3f um, %.2f %% of the largest error\n", worst, 100 * worst / largest);
  std::fflush(stdout);
}

void uneven_walls() {
  for (const double helix : {30.0, 0.0})
    for (const bool up : {true, false}) {
      FinishedWall w;
      w.helix_deg = helix, w.up = up;
      w.pitch_deg = {85, 97, 83, 95};
      std::printf("pitch 85, 97, 83, 95\n");
      wall_case(w);
      w.pitch_deg = {90, 90, 90, 90}, w.run_out_deg = 20;
      for (const double run_out : {0.003, 0.01}) {
        w.run_out_mm = run_out;
        std::printf("run-out %g um\n", 1000 * run_out);
        wall_case(w);
      }
    }
}

void walls() {
  FinishedWall w;
  for (const double helix : {0.0, 30.0, 45.0})
    for (const bool up : {true, false}) {
      w.helix_deg = helix, w.up = up;
      wall_case(w);
    }
  w.helix_deg = 30;
  w.flutes = 2;
  for (const bool up : {true, false}) {
    w.up = up;
    wall_case(w);
  }
  // One thing at a time: flutes, widths of cut, feed, helix, height.
  std::vector<FinishedWall> others(7);
  others[0].flutes = 3;
  others[1].radial_mm = 0.1;
  others[2].radial_mm = 5;
  others[3].feed_mm = 0.1;
  others[4].helix_deg = 60;
  others[5].height_mm = 20;
  others[6].flutes = 3, others[6].helix_deg = 0;
  for (FinishedWall& other : others)
    for (const bool up : {true, false}) {
      other.up = up;
      wall_case(other);
    }
  w = {};
  w.radial_mm = 2;
  w.offset_mm = Vec3(0.037, 0.051, 0.023);
  for (const bool up : {true, false}) {
    w.up = up;
    wall_case(w);
  }
}

/// Both walls of a slot.
void slots() {
  for (const double helix : {30.0, 45.0})
    for (const bool up : {true, false}) {
      FinishedWall w;
      w.radial_mm = 12, w.helix_deg = helix, w.up = up;
      wall_case(w);
    }
}

/// Unequal pitch and run-out, on planes and walls.
void uneven() {
  head_of_plane();
  for (const double slope : {45.0, 60.0}) {
    InclinedPlane p;
    p.slope_deg = slope, p.pitch_deg = {170, 190};
    plane_case(fmt::format("{} deg, pitch 170, 190", slope), p);
    p.pitch_deg = {180, 180}, p.run_out_deg = 20;
    for (const double run_out : {0.003, 0.01}) {
      p.run_out_mm = run_out;
      plane_case(fmt::format("{} deg, run-out {} um", slope, 1000 * run_out), p);
    }
  }
  uneven_walls();
}

/// The inclined plane on coarser and finer voxels, the envelope's samples as fine as predict sets them.
void voxels() {
  const CutFigures want = drawn_figures(InclinedPlane{});
  std::printf("%-8s %9s %9s %9s %11s %9s %9s %9s\n", "voxel mm", "peak F %", "mean F %", "chips %", "chips/stock",
              "err p5 %", "err p95 %", "err mean %");
  for (const double voxel : {0.4, 0.2, 0.1, 0.05}) {
    // The mean over a few places of the grid, without sign: what a user meets.
    double peak = 0, mean = 0, chips = 0, balance = 0, p5 = 0, p95 = 0, error = 0;
    constexpr int kPlaces = 4;
    for (int i = 0; i < kPlaces; ++i) {
      InclinedPlane p;
      p.voxel_mm = voxel;
      p.offset_mm = voxel * Vec3(0.25 * i, 0.37 * i, 0.61 * i);
      const CutFigures f = camber_figures(p);
      peak += std::abs(off(f.lateral_max_N, want.lateral_max_N)) / kPlaces;
      mean += 100 * (f.mean_N - want.mean_N).norm() / want.mean_N.norm() / kPlaces;
      chips += std::abs(off(f.chip_mm3, p.feed_mm * p.row_mm * p.allowance_mm)) / kPlaces;
      balance += f.chips_of_stock / kPlaces;
      p5 += std::abs(off(f.p5_um, want.p5_um)) / kPlaces;
      p95 += std::abs(off(f.p95_um, want.p95_um)) / kPlaces;
      error += std::abs(off(f.error_mean_um, want.error_mean_um)) / kPlaces;
    }
    std::printf("%-8g %9.2f %9.2f %9.2f %11.4f %9.2f %9.2f %9.2f\n", voxel, peak, mean, chips, balance, p5, p95, error);
    std::fflush(stdout);
  }
}

void shoulder_case(const testing::DeflectedShoulder& s) {
  const auto drawn = testing::DrawnShoulder(s).cut();
  const auto bent = testing::camber_figures(s), rigid = testing::camber_figures(s, machine::Coupling::rigid);
  double largest = 0, peak = 0, mean = 0, rigid_mean = 0, rigid_peak = 0;
  for (const auto& f : drawn) largest = std::max(largest, f.lateral_max_N);
  const double mean_N = drawn.back().mean_N.norm();
  for (std::size_t k = 0; k < drawn.size(); ++k) {
    peak = std::max(peak, 100 * std::abs(bent[k].lateral_max_N - drawn[k].lateral_max_N) / largest);
    rigid_peak = std::max(rigid_peak, 100 * std::abs(rigid[k].lateral_max_N - drawn[k].lateral_max_N) / largest);
    mean = std::max(mean, 100 * (bent[k].mean_N - drawn[k].mean_N).norm() / mean_N);
    rigid_mean = std::max(rigid_mean, 100 * (rigid[k].mean_N - drawn[k].mean_N).norm() / mean_N);
  }
  std::printf(
      "%s, helix %g, ae %g, edge %g N/mm, spring %g N/mm: %.1f N, steady peak %+.2f %%, mean %+.2f %%; at worst on the "
      "way in peak %.2f %%, mean %.2f %% (rigid %.2f, %.2f %%)\n",
      s.up ? "up" : "down", s.helix_deg, s.radial_mm, s.kte, s.stiffness_N_per_mm, drawn.back().lateral_max_N,
      off(bent.back().lateral_max_N, drawn.back().lateral_max_N),
      100 * (bent.back().mean_N - drawn.back().mean_N).norm() / mean_N, peak, mean, rigid_peak, rigid_mean);
  std::fflush(stdout);
}

/// Static coupling: shoulders of a cutter on a spring, from the first touch on, tooth passing by tooth passing.
void shoulders() {
  for (const double stiffness : {5000.0, 1500.0})
    for (const double edge : {0.0, 15.0})
      for (const bool up : {true, false}) {
        testing::DeflectedShoulder s;
        s.up = up, s.kte = s.kre = edge, s.stiffness_N_per_mm = stiffness;
        shoulder_case(s);
      }
  for (const bool up : {true, false}) {
    testing::DeflectedShoulder s;
    s.up = up, s.radial_mm = 3, s.from_mm = -5;
    shoulder_case(s);
    s = {};
    s.up = up, s.helix_deg = 0, s.slices = 1;
    shoulder_case(s);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "plane") planes();
  if (what == "cutters") cutters();
  if (what == "uneven") uneven();
  if (what == "grid") grid();
  if (what == "wall") walls(), slots();
  if (what == "voxels") voxels();
  if (what == "static") shoulders();
}
