// The emitted program of a ball finishing, judged by rays and displaced facets (tests/support/displaced_envelope.h): a
// slope of 45 degrees, rows to and fro, with the cutter of sample 05.
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compensate/compensate_path.h"
#include "test_paths.h"
#include "tests/support/drawn_job.h"

namespace camber::compensate {
namespace {

using testing::DrawnCut;
using testing::DrawnPass;
using testing::DrawnSurface;

constexpr int kRows = 8;
constexpr double kStep_mm = 0.25;  // along the slope
constexpr double kRadius_mm = 2, kFrom_mm = -2.6, kTo_mm = 7.6;
const double kSlope = std::sqrt(0.5);  // sine and cosine

/// Row k's contact, across the slope, lies k steps above the origin of the slope.
Vec3 tip(double x, int row) {
  const double v = kStep_mm * row;
  return Vec3(x, kSlope * v, kSlope * v) + kRadius_mm * Vec3(0, -kSlope, kSlope) - kRadius_mm * Vec3::UnitZ();
}

std::string rows_to_and_fro() {
  std::string text = "%\nG21 G17 G40 G49 G80 G90\nT1 M6\nG54 S6000 M3\nG0 Z12.\n";
  for (int row = 0; row < kRows; ++row) {
    const Vec3 from = tip(row % 2 ? kTo_mm : kFrom_mm, row), to = tip(row % 2 ? kFrom_mm : kTo_mm, row);
    text += fmt::format("G0 X{:.4f} Y{:.4f}\nG1 Z{:.4f} F1200\n", from.x(), from.y(), from.z());
    for (int i = 1; i <= 12; ++i) text += fmt::format("X{:.4f}\n", from.x() + i * (to.x() - from.x()) / 12);
    text += "G0 Z12.\n";
  }
  return text + "M5\nM30\n%\n";
}

machine::Job slope_job(const std::filesystem::path& folder, Diagnostics& diagnostics) {
  machine::Job job = machine::read_job(CAMBER_SOURCE_DIR "/samples/05-freeform/job.toml", diagnostics);
  job.program = (folder / "slope.nc").string();
  std::ofstream(job.program) << rows_to_and_fro();
  job.stock.box = machine::Box{{0, 0.05, -1}, {5, 1.2, 1.6}};  // no wider than the rows
  job.simulation.coupling = machine::Coupling::rigid;          // the judge's bending does not thin chips
  job.compensation.tolerance_um = 5;
  job.compensation.levers = {machine::Lever::shift};
  return job;
}

DrawnCut drawn(const machine::Job& job, const simulate::SimulatedProgram& program,
               const simulate::SimulatedProgram& given) {
  DrawnCut c = testing::drawn_cut_of(job);
  c.corner = c.radius;
  c.top = c.radius;
  c.steps_per_pitch = 180;
  c.edge_step = 0.04;
  c.stamps = program.path.stamps;
  c.pass_before = given.path.stamps;
  return c;
}

/// The judged stretch: rows whose neighbours on both sides are cut as well.
constexpr double kJudgedFrom_mm = 2, kJudgedTo_mm = 3;
constexpr int kFirstRow = 2, kLastRow = 5;
constexpr int kAlong = 21, kOfRow = 24;  // points of the lattice along X, and in a row's width

struct Judged {
  double rms_um = 0, correctable_um = 0;
  std::map<int, double> row_um;
};

/// What the emitted program leaves less what the given one would with a stiff tool; a shift moves a row as a whole, so
/// the mean over its width is what it can correct.
Judged judge(const machine::Job& job, const simulate::SimulatedProgram& program,
             const simulate::SimulatedProgram& given) {
  const DrawnCut cut = drawn(job, program, given), stiff = drawn(job, given, given);
  const double du = (kJudgedTo_mm - kJudgedFrom_mm) / (kAlong - 1), dv = kStep_mm / kOfRow;
  constexpr int kUp = (kLastRow - kFirstRow + 1) * kOfRow;
  const double v0 = (kFirstRow - 0.5) * kStep_mm + dv / 2;
  const Vec3 origin(kJudgedFrom_mm, kSlope * v0, kSlope * v0);
  DrawnSurface bent(origin, Vec3::UnitX(), Vec3(0, kSlope, kSlope), kAlong, kUp, du, dv), straight = bent;
  constexpr double kReach_mm = 0.5, kClearance_mm = 0.03;
  const double middle = (kJudgedFrom_mm + kJudgedTo_mm) / 2;
  const auto row_of = [](const removal::Stamp& s) {
    return static_cast<int>(std::lround((s.pose.tip_mm.y() - tip(0, 0).y()) / (kSlope * kStep_mm)));
  };
  const auto near = [&](const removal::Stamp& s) {
    return std::abs(s.pose.tip_mm.x() - middle) < (kJudgedTo_mm - kJudgedFrom_mm) / 2 + kReach_mm &&
           row_of(s) >= kFirstRow - 2 && row_of(s) <= kLastRow + 2;
  };
  std::map<std::pair<int, int>, DrawnPass> passes;  // conditions stay the same along a row: one a row and millimetre
  for (std::size_t k = 0; k < cut.stamps.size(); ++k) {
    const removal::Stamp& s = cut.stamps[k];
    if (!near(s)) continue;
    const std::pair at{row_of(s), static_cast<int>(std::lround(s.pose.tip_mm.x()))};
    if (!passes.contains(at)) passes.emplace(at, drawn_pass(cut, k));
    draw_envelope(cut, k, &passes.at(at), bent, kClearance_mm);
  }
  for (std::size_t k = 0; k < stiff.stamps.size(); ++k)
    if (near(stiff.stamps[k])) draw_envelope(stiff, k, nullptr, straight, kClearance_mm);
  Judged out;
  double squares = 0, means = 0;
  for (int row = 0; row <= kLastRow - kFirstRow; ++row) {
    for (int i = 0; i < kAlong; ++i) {
      double mean = 0;
      for (int j = row * kOfRow; j < (row + 1) * kOfRow; ++j) {
        const double e = 1000 * (bent.at(i, j) - straight.at(i, j));
        mean += e / kOfRow;
        squares += e * e / (kAlong * kUp);
      }
      out.row_um[kFirstRow + row] += mean / kAlong;
    }
    const double of_row = out.row_um[kFirstRow + row];
    means += of_row * of_row / (kLastRow - kFirstRow + 1);
  }
  out.rms_um = std::sqrt(squares), out.correctable_um = std::sqrt(means);
  return out;
}

TEST(DrawnJudge, FindsWhatAShiftCanCorrectGoneFromASlopeOfBallRows) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("camber-slope-{}", ::getpid());
  std::filesystem::create_directories(folder);
  Diagnostics diagnostics;
  const machine::Job job = slope_job(folder, diagnostics);
  const CompensationResult c = compensate(job, diagnostics, {});
  const auto program = [&](const std::string& text) {
    return motion::simulate_motion(SourceText(job.program, text), job, {}, diagnostics);
  };
  std::cout << fmt::format("camber: rms {:.2f} to {:.2f}, correctable {:.2f} to {:.3f} um\n", c.figures.before_um.rms,
                           c.figures.after_um.rms, c.figures.split_before.correctable_um,
                           c.figures.split_after.correctable_um);
  const auto given = program(rows_to_and_fro()), emitted = program(c.emitted.text);
  const Judged before = judge(job, given, given), after = judge(job, emitted, given);
  std::filesystem::remove_all(folder);
  for (const auto& [row, mean] : before.row_um)
    std::cout << fmt::format("row {}: {:.2f} to {:.3f} um\n", row, mean, after.row_um.at(row));
  std::cout << fmt::format("rms {:.2f} to {:.2f} um, correctable {:.2f} to {:.3f} ({:+.1f} %)\n", before.rms_um,
                           after.rms_um, before.correctable_um, after.correctable_um,
                           100 * (after.correctable_um / before.correctable_um - 1));
  EXPECT_GT(before.correctable_um, 1);
  EXPECT_LE(after.correctable_um, 0.05 * before.correctable_um);
  EXPECT_LT(after.rms_um, before.rms_um);
}

}  // namespace
}  // namespace camber::compensate
