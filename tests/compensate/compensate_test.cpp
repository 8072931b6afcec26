// The whole loop on a small inclined plane: the error falls, the emitted program is the user's own but for coordinates.
#include "compensate/compensate.h"

#include <cmath>

#include <cctype>
#include <regex>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "nc/interpreter.h"
#include "tests/support/temp_folder.h"

namespace camber::compensate {
namespace {

/// Rows along X on the plane z = y (45 degrees), cut by a ball of R3; the tip stands R (1 - sqrt(1/2)) beside it.
std::string plane_program() {
  std::string out = "%\nO0007 (PLANE)\nG21 G90 G17 G40 G49 G80\nT1 M6 (6. BALL)\nG54 S3000 M3\nG0 X8. Y-4. Z12.\n";
  int number = 10;
  for (double s = -1.8; s < 5; s += 0.3) {
    const double c = std::sqrt(0.5), y = s * c - 3 * c, z = s * c + 3 * c - 3;
    out += fmt::format("N{} G0 X8. Y{:.4f}\nZ{:.4f}\nG1 X4.25 F900\nX0.5\nX-3.\nG0 Z12. (ROW)\n", number, y, z);
    number += 10;
  }
  return out + "M5\nM30\n%\n";
}

machine::Job plane_job(const tests::TempFolder& folder) {
  machine::Job job;
  job.path = folder / "job.toml";
  job.program = folder.write("plane.nc", plane_program());
  for (auto& axis : job.machine.axis) {
    axis.acceleration_mm_per_s2 = 1000;
    axis.max_velocity_mm_per_s = 100;
  }
  machine::Tool tool;
  tool.number = 1;
  tool.diameter_mm = 6;
  tool.helix_rad = kPi / 6;
  tool.overhang_mm = 40;
  job.tools[1] = tool;
  job.material = {2000, 700, 0, 15, 15, 0};
  job.stock.box = machine::Box{{0, 0, -1}, {5, 3, 4}};
  job.stock.allowance_mm = 0.2;
  job.simulation.voxel_mm = 0.15;
  job.simulation.coupling = machine::Coupling::rigid;
  job.compensation.max_rounds = 2;
  job.compensation.tolerance_um = 0.1;
  return job;
}

/// The text without its coordinate words.
std::string without_coordinates(const std::string& text) {
  static const std::regex coordinate(R"( ?[XYZIJK]-?[0-9.]+)");
  return std::regex_replace(text, coordinate, "");
}

TEST(Compensate, LowersTheErrorAndChangesNothingButCoordinates_slow) {
  const tests::TempFolder folder;
  const machine::Job job = plane_job(folder);
  Diagnostics diagnostics;
  const Compensation c = compensate(job, diagnostics, {});
  EXPECT_GT(c.before_um.mean, 8);
  EXPECT_LT(std::abs(c.after_um.mean), 1.0);
  EXPECT_LT(c.after_um.p95, 0.35 * c.before_um.p95);
  EXPECT_GT(c.max_shift_mm, 0.005);
  EXPECT_LT(c.max_shift_mm, 0.05);
  EXPECT_EQ(c.rounds.size(), 3u);
  EXPECT_EQ(c.stop, Stop::rounds);

  // Lines that only split a block hold nothing but coordinates.
  std::string left = without_coordinates(c.text);
  left = std::regex_replace(left, std::regex("\n(?=\n)"), "");
  std::string wanted = without_coordinates(plane_program());
  wanted = std::regex_replace(wanted, std::regex("\n(?=\n)"), "");
  EXPECT_EQ(left, wanted);

  // What was emitted reads without complaint and has the same feeds.
  Diagnostics of_emitted;
  const auto text = nc::read_program(SourceText("emitted.nc", c.text), of_emitted);
  const auto moves = nc::interpret(text, {}, of_emitted);
  EXPECT_TRUE(of_emitted.all().empty());
  for (const auto& m : moves.moves) {
    if (m.kind == nc::MoveKind::linear) {
      EXPECT_DOUBLE_EQ(m.feed_mm_per_s, 15);
    }
  }
}

TEST(Compensate, GivesTheSameProgramTwice_slow) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  job.compensation.max_rounds = 1;
  Diagnostics diagnostics;
  EXPECT_EQ(compensate(job, diagnostics, {}).text, compensate(job, diagnostics, {}).text);
}

TEST(Compensate, HoldsToTheLargestShift_slow) {
  const tests::TempFolder folder;
  machine::Job job = plane_job(folder);
  job.compensation.max_rounds = 1;
  job.compensation.max_shift_mm = 0.004;
  Diagnostics diagnostics;
  const Compensation c = compensate(job, diagnostics, {});
  EXPECT_LE(c.max_shift_mm, 0.004 + 1e-12);
  EXPECT_GT(c.rounds.back().limited_points, 0u);
}

}  // namespace
}  // namespace camber::compensate
