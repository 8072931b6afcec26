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

constexpr double kTolerance_mm = 0.0015;

/// A quarter circle as a CAM system writes it, in short lines.
void write_program(const TempFolder& folder, const std::string& name) {
  std::string program = "G21 G90 G17 G40 G49 G80 G54 G94\nT1 M6\nS3000 M3\nG0 X5. Y-1. Z3.\nG1 Z-0.3 F300\nY0. F900\n";
  for (int i = 1; i <= 60; ++i) {
    const double a = kPi / 2 * i / 60;
    program += fmt::format("X{:.3f} Y{:.3f}\n", 5 * std::cos(a), 5 * std::sin(a));
  }
  folder.write(name, program + "X-1.\nG0 Z3.\nM30\n");
}

void write_job(const TempFolder& folder, const std::string& name, const std::string& program) {
  folder.write("machine.toml",
               "[control]\nleast_increment_mm = 0.0001\n[axis.x]\nacceleration_mm_per_s2 = 500\n[axis.y]\n[axis.z]\n");
  folder.write(name, fmt::format(R"(program = "{}"
machine = "machine.toml"
[tool.1]
type = "ball"
diameter_mm = 6.0
flutes = 2
overhang_mm = 50.0
flute_length_mm = 50.0
root_stiffness_N_per_um = inf
[material]
ktc_MPa = 2000.0
krc_MPa = 700.0
[stock]
box_mm = [[2, 2, -1], [5, 5, 0]]
[simulation]
voxel_mm = 0.2
[compensation]
levers = ["shift"]
max_rounds = 1
tolerance_um = 0.05
max_overcut_um = 20.0
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
  return tests::hausdorff_mm(moves_of(file_text(folder / a)), moves_of(file_text(folder / b)), 0.001);
}

json figures(const TempFolder& folder, const std::string& name) { return json::parse(file_text(folder / name)); }

void compensate(const TempFolder& folder, const std::string& job, const std::string& out) {
  const auto run = run_camber(folder, "compensate " + job + " -o " + out + " --json " + out + ".json");
  ASSERT_NE(run.status, 1) << run.err;  // one round need not reach the tolerance
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
  const double shift = figures(folder, "compensated.nc.json")["max_shift_um"].get<double>();
  EXPECT_GT(shift, 0.2);  // or there is nothing to keep
  compress(folder, "compensated.nc", "both.nc");
  EXPECT_LE(distance_mm(folder, "compensated.nc", "both.nc"), kTolerance_mm + 0.0005);  // samples 0.001 mm apart
  const json r = figures(folder, "both.nc.json");
  EXPECT_LT(r["blocks_after"], 0.6 * r["blocks_before"].get<double>());
}

TEST(Compose, WhatWasCompressedCanBeCompensated) {
  const TempFolder folder;
  write_program(folder, "p.nc");
  compress(folder, "p.nc", "arcs.nc");
  EXPECT_NE(file_text(folder / "arcs.nc").find("G3 X0. Y5. I-5. J0.\n"), std::string::npos);
  write_job(folder, "job.toml", "arcs.nc");
  compensate(folder, "job.toml", "both.nc");
  const std::string out = file_text(folder / "both.nc");
  EXPECT_NE(out.find("\nG3 X"), std::string::npos) << out;  // an arc stays one, or arcs
  const json r = figures(folder, "both.nc.json");
  EXPECT_GT(r["max_shift_um"].get<double>(), 0.2);
  EXPECT_LT(r["split_after_um"]["correctable"], 0.8 * r["split_before_um"]["correctable"].get<double>());
  // And again: nothing is left to do but what the tolerance allows.
  compress(folder, "both.nc", "thrice.nc");
  EXPECT_LE(distance_mm(folder, "both.nc", "thrice.nc"), kTolerance_mm + 0.0005);
}

}  // namespace
}  // namespace camber
