// Carving, engagement and force on a finishing workload that other programs were measured on, without NC text and feed
// model: surface z = 4 sin(kx) cos(ky), k = 2 pi / 50 mm, ball R5, its tip on the exact offset surface, zigzag rows
// 0.3 mm apart, points 0.2 mm apart (one tooth passing each), stock the box [0,100]^2 x [-10, 4.5].
// The path sweeps 44 971.98 mm3, its stamps alone 44 968.4 (a height field of 0.05 mm).
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include <sys/resource.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include "machine/material.h"
#include "machine/simulation_settings.h"
#include "machine/tool.h"
#include "removal/stock.h"
#include "removal/tool_path.h"
#include "simulate/cut.h"

using namespace camber;

namespace {

constexpr double kSide_mm = 100, kRadius_mm = 5, kRow_mm = 0.3, kStep_mm = 0.2;
constexpr int kRows = 334, kPoints = 501;

/// The tip of the ball that touches the surface above (x, y).
Vec3 tip_touching(double x, double y) {
  const double k = 2 * kPi / 50;
  const double z = 4 * std::sin(k * x) * std::cos(k * y);
  const Vec3 n =
      Vec3(-4 * k * std::cos(k * x) * std::cos(k * y), 4 * k * std::sin(k * x) * std::sin(k * y), 1).normalized();
  return Vec3(x, y, z) + kRadius_mm * n - Vec3(0, 0, kRadius_mm);
}

/// The tip at (x, y), on the offset surface.
Vec3 tip_at(double x, double y) {
  Vec2 touched(x, y);
  for (int step = 0; step < 60; ++step) touched -= tip_touching(touched.x(), touched.y()).head<2>() - Vec2(x, y);
  return tip_touching(touched.x(), touched.y());
}

std::vector<removal::Stamp> stamps_of(int from_row, int rows, double lift_mm) {
  std::vector<removal::Stamp> out;
  for (int r = from_row; r < from_row + rows; ++r)
    for (int i = 0; i < kPoints; ++i) {
      removal::Stamp s;
      s.pose.tip_mm = tip_at((r % 2 ? kPoints - 1 - i : i) * kStep_mm, r * kRow_mm) + Vec3(0, 0, lift_mm);
      s.first = out.empty();
      if (!out.empty()) s.feed_per_tooth_mm = s.pose.tip_mm - out.back().pose.tip_mm;
      s.t_s = static_cast<double>(out.size()) * 0.004;
      out.push_back(s);
    }
  return out;
}

double seconds_since(std::chrono::steady_clock::time_point t) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
}

double cpu_seconds(const rusage& u) {
  return static_cast<double>(u.ru_utime.tv_sec) + 1e-6 * static_cast<double>(u.ru_utime.tv_usec);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Carving, engagement and force on the finishing workload");
  double voxel = 0.2, helix_deg = 30;
  int threads = 1, rows = kRows, from_row = 0;
  bool second = false, carve_only = false, bent = false;
  app.add_option("--voxel-mm", voxel);
  app.add_option("--threads", threads);
  app.add_option("--rows", rows, "how many of the 334 rows");
  app.add_option("--from-row", from_row, "first of them");
  app.add_flag("--second", second, "the pass below the same path lifted by 0.3 mm");
  app.add_flag("--carve-only", carve_only, "no engagement");
  app.add_flag("--static", bent, "static coupling");
  CLI11_PARSE(app, argc, argv);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));

  machine::Tool tool;
  tool.type = machine::ToolType::ball;
  tool.diameter_mm = 2 * kRadius_mm;
  tool.flutes = 2;
  tool.helix_rad = helix_deg * kPi / 180;
  tool.overhang_mm = 30;
  tool.effective_diameter_ratio = 0.8;
  tool.youngs_modulus_MPa = 600000;
  machine::Material material;
  material.ktc_MPa = 700;
  material.krc_MPa = 200;
  material.kte_N_per_mm = material.kre_N_per_mm = 10;

  const Vec3 lo(0, 0, -10), hi(kSide_mm, kSide_mm, 4.5);
  const double band = std::clamp(std::ceil((kStep_mm * 1.3 + 0.1) / voxel) + 1, 4.0, 12.0);
  removal::Stock stock([&](const Vec3& p) { return removal::box_distance_mm(p, lo, hi); }, lo, hi, voxel, band);
  // The pass before, where the cutter can meet it.
  const int row0 = std::max(0, from_row - 20), row1 = std::min(kRows, from_row + rows + 20);
  if (second) simulate::sweep(stock, tool, stamps_of(row0, row1 - row0, 0.3), 0, 0);
  stock.clear_stamps();
  // A part of the path meets what the rows before it have left.
  if (from_row > row0) simulate::sweep(stock, tool, stamps_of(row0, from_row - row0, 0), 0, 0);
  stock.clear_stamps();
  const auto stamps = stamps_of(from_row, rows, 0);
  const double volume = stock.volume_mm3();
  rusage at_start{};
  getrusage(RUSAGE_SELF, &at_start);
  const double cpu_start = cpu_seconds(at_start);
  const auto start = std::chrono::steady_clock::now();
  double chips = 0;
  if (carve_only) {
    simulate::sweep(stock, tool, stamps, 0, 0);
  } else {
    simulate::CutOptions options;
    options.coupling = bent ? machine::Coupling::static_ : machine::Coupling::rigid;
    options.envelope_step_mm = 0.1;
    const auto result = simulate::cut(stock, tool, material, stamps, {}, 0, options);
    chips = result.chip_mm3;
  }
  const double seconds = seconds_since(start);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const double cpu = cpu_seconds(usage) - cpu_start;
  const double removed = volume - stock.volume_mm3();
  std::printf(
      "voxel %.2f mm, %d threads, %zu stamps: %.2f s, %.0f stamps/s, %.0f per second of one core; removed %.3f mm3, "
      "chips %.3f mm3; %.0f MB\n",
      voxel, threads, stamps.size(), seconds, static_cast<double>(stamps.size()) / seconds,
      static_cast<double>(stamps.size()) / cpu, removed, chips, static_cast<double>(usage.ru_maxrss) / 1024);
}
