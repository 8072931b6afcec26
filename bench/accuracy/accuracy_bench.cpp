// Camber against the drawn cut (tests/support/displaced_envelope.h): force and form error of rigid finishing cuts.
//   accuracy_bench plane | cutters | uneven | grid | wall | voxels
// Static coupling against a drawn shoulder on a spring, and against milling simulated in time:
//   accuracy_bench static | static-plane | static-wall | judge
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/support/deflected_shoulder.h"
#include "tests/support/finished_wall.h"
#include "tests/support/inclined_plane.h"
#include "tests/support/static_plane.h"
#include "tests/support/static_wall.h"

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

/// Half as fine as the judge's own: a tenth of the time.
bool coarse_judge = false;

testing::JudgeSteps plane_steps() {
  testing::JudgeSteps s;
  if (coarse_judge) s.rotation_deg = 0.5, s.edge_mm = 0.04, s.grid_mm = 0.025, s.length_mm = 4.4;
  return s;
}

testing::WallJudgeSteps wall_steps() {
  testing::WallJudgeSteps s;
  if (coarse_judge) s.rotation_deg = 0.5;
  return s;
}

/// Static coupling of a ball on a plane, against the simulation in time.
void static_plane(const std::string& name, testing::InclinedPlane p) {
  p.coupling = machine::Coupling::static_;
  const auto want = testing::judged_figures(p, plane_steps());
  const auto got = testing::camber_figures(p);
  const double mean = 100 * (got.mean_N - want.mean_N).norm() / want.mean_N.norm();
  std::printf(
      "| %s | %.1f N, %.1f %.1f %.1f um | %+.1f %% | %.1f %% | %+.1f %% (%+.2f um) | %+.1f %% (%+.2f) | %+.1f %% "
      "(%+.2f) | %+.2f "
      "%% | %.3f | %zu, %d |\n",
      name.c_str(), want.lateral_max_N, want.p5_um, want.median_um, want.p95_um,
      off(got.lateral_max_N, want.lateral_max_N), mean, off(got.p5_um, want.p5_um), got.p5_um - want.p5_um,
      off(got.median_um, want.median_um), got.median_um - want.median_um, off(got.p95_um, want.p95_um),
      got.p95_um - want.p95_um, 100 * (testing::chips_over_surface(p, got) - 1), got.chips_of_stock, got.unsettled,
      want.unsettled_steps);
  std::fflush(stdout);
}

machine::Material kienzle_steel() {
  machine::Material m;
  m.law = machine::ForceLaw::kienzle;
  m.kc1_1_MPa = 1410, m.mc = 0.128, m.kr1_1_MPa = 564, m.mr = 0.128;
  return m;
}

void static_planes() {
  std::printf(
      "| | judge: peak; p5, median, p95 | peak | mean force | p5 | median | p95 | chips, surface | chips / stock | "
      "unsettled, judge's steps |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const double young : {600.0, 400.0, 300.0, 250.0, 210.0, 150.0}) {
    testing::InclinedPlane p;
    p.young_MPa = 1000 * young;
    static_plane(fmt::format("45 degrees, {} GPa", young), p);
  }
  for (const double young : {600.0, 210.0})
    for (const double slope : {15.0, 30.0, 60.0, 75.0}) {
      testing::InclinedPlane p;
      p.young_MPa = 1000 * young, p.slope_deg = slope;
      static_plane(fmt::format("{} degrees, {} GPa", slope, young), p);
    }
  for (const double young : {600.0, 210.0}) {
    testing::InclinedPlane p;
    p.young_MPa = 1000 * young, p.upwards = false;
    static_plane(fmt::format("rows downwards, {} GPa", young), p);
    p.along_x = 1;
    static_plane(fmt::format("rows downwards, along +X, {} GPa", young), p);
    p.upwards = true;
    static_plane(fmt::format("along +X, {} GPa", young), p);
    p.along_x = -1, p.material = kienzle_steel();
    static_plane(fmt::format("Kienzle, {} GPa", young), p);
    p = {};
    p.young_MPa = 1000 * young, p.pitch_deg = {180, 180}, p.run_out_mm = 0.003, p.run_out_deg = 20;
    static_plane(fmt::format("run-out 3 um, {} GPa", young), p);
  }
}

/// The same of a flat end mill along a wall and through a slot.
void static_wall(const std::string& name, FinishedWall w) {
  w.coupling = machine::Coupling::static_;
  const auto want = testing::judged_figures(w, wall_steps());
  const auto got = testing::camber_figures(w);
  const double mean = 100 * (got.mean_N - want.mean_N).norm() / want.mean_N.norm();
  double largest = 0, worst = 0;
  for (const double e : want.error_um) largest = std::max(largest, std::abs(e));
  for (std::size_t i = 0; i < want.error_um.size(); ++i)
    worst = std::max(worst, std::abs(got.error_um[i] - want.error_um[i]));
  std::printf("| %s | %.1f N, %.1f um | %+.1f %% | %.1f %% | %.2f um, %.1f %% | %.3f | %.3f | %zu, %d |\n",
              name.c_str(), want.lateral_max_N, largest, off(got.lateral_max_N, want.lateral_max_N), mean, worst,
              100 * worst / largest, got.chips_of_stock, want.chips_of_surface, got.unsettled, want.unsettled_steps);
  std::fflush(stdout);
}

void static_walls() {
  std::printf(
      "| | judge: peak, largest error | peak | mean force | largest difference of a slice | chips / stock | judge's "
      "chips / surface | unsettled, judge's steps |\n|---|---|---|---|---|---|---|---|\n");
  for (const double young : {600.0, 210.0})
    for (const double radial : {0.5, 2.0, 5.0, 12.0})
      for (const bool up : {true, false}) {
        FinishedWall w;
        w.young_MPa = 1000 * young, w.radial_mm = radial, w.up = up;
        if (radial > 10)
          static_wall(fmt::format("slot, {} side, {} GPa", up ? "up" : "down", young), w);
        else
          static_wall(fmt::format("{}, ae {}, {} GPa", up ? "up" : "down", radial, young), w);
      }
  FinishedWall w;
  w.young_MPa = 300000, w.pitch_deg = {90, 90, 90, 90}, w.run_out_mm = 0.003, w.run_out_deg = 20;
  static_wall("up, ae 0.5, run-out 3 um, 300 GPa", w);
  w = {};
  w.young_MPa = 300000, w.material = kienzle_steel();
  static_wall("up, ae 0.5, Kienzle, 300 GPa", w);
}

/// The judge against its own steps and grid.
void judge() {
  for (const double young : {600.0, 210.0}) {
    testing::InclinedPlane p;
    p.young_MPa = 1000 * young;
    const auto line = [&](const char* name, const testing::JudgeSteps& s) {
      const auto f = testing::judged_figures(p, s);
      std::printf("| %s, %g GPa | %.2f N | %.3f %.3f %.3f N | %.2f %.2f %.2f um | %.4f |\n", name, young,
                  f.lateral_max_N, f.mean_N.x(), f.mean_N.y(), f.mean_N.z(), f.p5_um, f.median_um, f.p95_um,
                  f.chips_of_surface);
      std::fflush(stdout);
    };
    testing::JudgeSteps s;
    line("0.25 degrees, edge 0.03, grid 0.02 mm", s);
    s.rotation_deg = 0.5;
    line("0.5 degrees", s);
    s = {};
    s.grid_mm = 0.01;
    line("grid 0.01 mm", s);
    s = {};
    s.edge_mm = 0.015;
    line("edge 0.015 mm", s);
    s = {};
    s.bent_rows = 12;
    line("12 rows", s);
    s = {};
    s.ramp_mm = 0.001;
    line("ramp 1 um", s);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  coarse_judge = argc > 2 && std::string(argv[2]) == "coarse";
  if (what == "plane") planes();
  if (what == "cutters") cutters();
  if (what == "uneven") uneven();
  if (what == "grid") grid();
  if (what == "wall") walls(), slots();
  if (what == "voxels") voxels();
  if (what == "static") shoulders(), static_planes(), static_walls();
  if (what == "static-plane") static_planes();
  if (what == "static-wall") static_walls();
  if (what == "judge") judge();
}
