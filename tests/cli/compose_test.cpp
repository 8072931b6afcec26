// compress and compensate one after the other, in both orders.
#include <cmath>
#include <deque>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "nc/interpreter.h"
#include "tests/support/path_distance.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::file_text;
using tests::run_camber;
using tests::TempFolder;

constexpr double kTolerance_mm = 0.005;

/// Three quarter circles as a CAM system writes them, in short lines, each cutting a little more from outside.
void write_program(const TempFolder& folder, const std::string& name) {
  std::string program = "G21 G90 G17 G40 G49 G80 G54 G94\nT1 M6\nS3000 M3\n";
  for (const double radius : {9.0, 8.7, 8.4}) {
    program += fmt::format("G0 X{:.3f} Y-1. Z3.\nG1 Z-0.3 F300\nY0. F600\n", radius);
    for (int i = 1; i <= 90; ++i) {
      const double a = kPi / 2 * i / 90;
      program += fmt::format("X{:.3f} Y{:.3f}\n", radius * std::cos(a), radius * std::sin(a));
    }
    program += "X-1.\nG0 Z3.\n";
  }
  folder.write(name, program + "M30\n");
}

void write_job(const TempFolder& folder, const std::string& name, const std::string& program) {
  folder.write("machine.toml", "[axis.x]\nacceleration_mm_per_s2 = 500\n");
  folder.write(name, fmt::format(R"(program = "{}"
machine = "machine.toml"
[tool.1]
type = "ball"
diameter_mm = 6.0
flutes = 2
overhang_mm = 40.0
[material]
ktc_MPa = 2000.0
krc_MPa = 700.0
[stock]
box_mm = [[0, 0, -1], [8, 8, 0]]
[simulation]
voxel_mm = 0.2
[compensation]
max_rounds = 2
)",
                                 program));
}

nc::Interpretation moves_of(const std::string& text) {
  static std::deque<nc::Program> kept;
  Diagnostics diagnostics;
  kept.push_back(nc::read_program(SourceText("p.nc", text), diagnostics));
  nc::Interpretation moves = nc::interpret(kept.back(), {}, diagnostics);
  diagnostics.throw_if_errors();
  return moves;
}

double distance_mm(const TempFolder& folder, const std::string& a, const std::string& b) {
  return tests::hausdorff_mm(moves_of(file_text(folder / a)), moves_of(file_text(folder / b)), 0.005);
}

json figures(const TempFolder& folder, const std::string& name) { return json::parse(file_text(folder / name)); }

void compensate(const TempFolder& folder, const std::string& job, const std::string& out) {
  const auto run = run_camber(folder, "compensate " + job + " -o " + out + " --json " + out + ".json");
  ASSERT_NE(run.status, 1) << run.err;  // two rounds need not reach the tolerance
  EXPECT_EQ(run_camber(folder, "check " + out).status, 0);
}

void compress(const TempFolder& folder, const std::string& program, const std::string& out) {
  const auto run = run_camber(folder, fmt::format("compress {} --tolerance-mm {} --helices -o {} --json {}.json",
                                                  program, kTolerance_mm, out, out));
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run_camber(folder, "check " + out).status, 0);
}

TEST(Compose, WhatWasCompensatedCanBeCompressed) {
  const TempFolder folder;
  write_program(folder, "p.nc");
  write_job(folder, "job.toml", "p.nc");
  compensate(folder, "job.toml", "compensated.nc");
  EXPECT_GT(distance_mm(folder, "p.nc", "compensated.nc"), 0.01);  // or there is nothing to keep
  compress(folder, "compensated.nc", "both.nc");
  EXPECT_LE(distance_mm(folder, "compensated.nc", "both.nc"), kTolerance_mm + 0.0007);  // samples 0.005 mm apart
  const json r = figures(folder, "both.nc.json");
  EXPECT_LT(r["blocks_after"], 0.6 * r["blocks_before"].get<double>());
}

TEST(Compose, WhatWasCompressedCanBeCompensated) {
  const TempFolder folder;
  write_program(folder, "p.nc");
  compress(folder, "p.nc", "arcs.nc");
  ASSERT_GE(figures(folder, "arcs.nc.json")["arcs"], 3);
  write_job(folder, "lines.toml", "p.nc");
  write_job(folder, "arcs.toml", "arcs.nc");
  compensate(folder, "lines.toml", "from_lines.nc");
  compensate(folder, "arcs.toml", "from_arcs.nc");
  const json lines = figures(folder, "from_lines.nc.json"), arcs = figures(folder, "from_arcs.nc.json");
  std::cout << lines["form_error_um"].dump() << "\n" << arcs["form_error_um"].dump() << "\n";
  std::cout << distance_mm(folder, "p.nc", "from_lines.nc") << " "
            << distance_mm(folder, "from_lines.nc", "from_arcs.nc") << "\n"
            << file_text(folder / "arcs.nc") << "\n"
            << file_text(folder / "from_arcs.nc");
}

}  // namespace
}  // namespace camber
