// The emitted program judged by a calculation that shares nothing with Camber but the list of stamps: chips as lengths
// of rays, the surface as displaced facets (tests/support/displaced_envelope.h). Sample 06, a stretch of its wall.
#include <cmath>
#include <iostream>

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

/// The wall y = 0 of sample 06, milled upwards with the tool at y < 0, between two places along X.
constexpr double kFrom_mm = 8, kTo_mm = 10, kHeight_mm = 6;
constexpr double kEdge_mm = 0.15;  // above and below: the map leaves out a voxel

DrawnCut drawn(const machine::Job& job, const simulate::SimulatedProgram& program,
               const simulate::SimulatedProgram& given) {
  DrawnCut c = testing::drawn_cut_of(job);
  c.corner = 0;
  c.top = kHeight_mm;
  c.steps_per_pitch = 180;
  c.edge_step = 0.06;
  const auto of_wall = [](const simulate::SimulatedProgram& p) {
    std::vector<removal::Stamp> out;
    for (const auto& s : p.path.stamps)
      if (s.pose.tip_mm.z() < -5.9 && s.pose.tip_mm.y() < -3.5 && s.pose.tip_mm.x() < 15) out.push_back(s);
    return out;
  };
  c.stamps = of_wall(program);
  c.pass_before = of_wall(given);
  return c;
}

struct Judged {
  double rms_um = 0, correctable_um = 0, mean_um = 0;
};

/// What the emitted program leaves less what the given one would with a stiff tool. A shift moves the wall as a whole
/// where the cutter stands: the mean over the height is what it can correct.
Judged judge(const machine::Job& job, const simulate::SimulatedProgram& program,
             const simulate::SimulatedProgram& given) {
  const DrawnCut cut = drawn(job, program, given), stiff = drawn(job, given, given);
  constexpr int kAlong = 81, kUp = 115;
  const double du = (kTo_mm - kFrom_mm) / (kAlong - 1), dv = (kHeight_mm - 2 * kEdge_mm) / (kUp - 1);
  const Vec3 origin(kFrom_mm, 0, -kHeight_mm + kEdge_mm);
  DrawnSurface bent(origin, Vec3::UnitX(), Vec3::UnitZ(), kAlong, kUp, du, dv), straight = bent;
  constexpr double kReach_mm = 1.3, kClearance_mm = 0.1, kPassEvery_mm = 1;
  std::map<int, DrawnPass> passes;
  for (std::size_t k = 0; k < cut.stamps.size(); ++k) {
    const double x = cut.stamps[k].pose.tip_mm.x();
    if (x < kFrom_mm - kReach_mm || x > kTo_mm + kReach_mm) continue;
    const int at = static_cast<int>(std::lround(x / kPassEvery_mm));
    if (!passes.contains(at)) passes.emplace(at, drawn_pass(cut, k));
    draw_envelope(cut, k, &passes.at(at), bent, kClearance_mm);
  }
  for (std::size_t k = 0; k < stiff.stamps.size(); ++k)
    if (std::abs(stiff.stamps[k].pose.tip_mm.x() - (kFrom_mm + kTo_mm) / 2) < (kTo_mm - kFrom_mm) / 2 + kReach_mm)
      draw_envelope(stiff, k, nullptr, straight, kClearance_mm);
  Judged out;
  double squares = 0, means = 0, sum = 0;
  for (int i = 0; i < kAlong; ++i) {
    double column = 0;
    for (int j = 0; j < kUp; ++j) {
      const double e = 1000 * (bent.at(i, j) - straight.at(i, j));
      column += e / kUp;
      squares += e * e / (kAlong * kUp);
    }
    means += column * column / kAlong;
    sum += column / kAlong;
  }
  out.rms_um = std::sqrt(squares), out.correctable_um = std::sqrt(means), out.mean_um = sum;
  return out;
}

TEST(DrawnJudgeSlow, FindsWhatAShiftCanCorrectGoneFromTheWallOfSample06) {
  Diagnostics diagnostics;
  machine::Job job = machine::read_job(CAMBER_SOURCE_DIR "/samples/06-wall/job.toml", diagnostics);
  job.simulation.coupling = machine::Coupling::rigid;  // the judge cuts with a tool whose bending does not thin chips
  job.compensation.tolerance_um = 0.2;  // under what the judge is asked for, or the tolerance would be judged
  job.compensation.levers = {machine::Lever::shift};
  job.machine.control.least_increment_mm = 1e-5;  // the correction is judged, not the 0.5 um that three decimals cost
  const CompensationResult c = compensate(job, diagnostics, {});
  const auto program = [&](const std::string& text) {
    return motion::simulate_motion(SourceText(job.program, text), job, {}, diagnostics);
  };
  const auto given = program(SourceText::read(job.program).text()), emitted = program(c.emitted.text);
  const Judged before = judge(job, given, given), after = judge(job, emitted, given);
  std::cout << fmt::format(
      "stretch X {:g} to {:g}: rms {:.2f} to {:.2f} um, mean {:.2f} to {:.2f}, correctable {:.2f} to {:.3f} ({:+.1f} "
      "%)\n",
      kFrom_mm, kTo_mm, before.rms_um, after.rms_um, before.mean_um, after.mean_um, before.correctable_um,
      after.correctable_um, 100 * (after.correctable_um / before.correctable_um - 1));
  EXPECT_GT(before.correctable_um, 1);
  EXPECT_LE(after.correctable_um, 0.05 * before.correctable_um);
  EXPECT_LT(after.rms_um, before.rms_um);
}

}  // namespace
}  // namespace camber::compensate
