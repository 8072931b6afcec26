// The nominal surface is the commanded path's: what lag and corner rounding do is contour error, in closed form, and
// what is left of the error is bending and shift.
#include "simulate/contour.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "removal/tool_path.h"
#include "simulate/predict_path.h"

namespace camber::simulate {
namespace {

constexpr double kGrid_um = 0.5;  // a grid of 0.1 mm and stamps a tooth passing apart

machine::Job flat_job(double diameter_mm, const machine::Box& box) {
  machine::Job job;
  job.program = "p.nc";
  machine::Tool tool;
  tool.number = 1;
  tool.type = machine::ToolType::flat;
  tool.diameter_mm = diameter_mm;
  tool.overhang_mm = 30;
  job.tools[1] = tool;
  job.stock.box = box;
  job.simulation.coupling = machine::Coupling::rigid;
  job.machine.control.corner = {.law = machine::CornerLaw::blend, .tolerance_mm = 1000};
  return job;
}

void set_gain(machine::Job& job, double gain_per_s) {
  for (auto& axis : job.machine.axis) axis.position_gain_per_s = gain_per_s;
}

SimulatedProgram motion(const machine::Job& job, const std::string& text) {
  Diagnostics diagnostics;
  return motion::simulate_motion(SourceText("p.nc", text), job, {}, diagnostics);
}

/// Points of the walls, with the contour error in error_mm.
std::vector<removal::SurfacePoint> walls(const machine::Job& job, const std::string& text) {
  Diagnostics diagnostics;
  const SimulatedProgram program = motion(job, text);
  const Target target = make_target(job, program, diagnostics);
  removal::SurfaceMap map = *target.map;
  auto points = map.take();
  EXPECT_EQ(points.size(), target.contour_mm.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i].error_mm = static_cast<double>(target.contour_mm[i]);
  std::erase_if(points, [](const auto& p) { return std::abs(p.normal.z()) > 0.1; });
  return points;
}

TEST(Contour, OfABoreUnderALaggingServoIsTheClosedForm) {
  // A first-order loop follows a circle of radius r at angular speed w = v / r on the radius r / sqrt(1 + (w / Kp)^2).
  constexpr double kPath = 6, kTool = 3, kGain = 33, kFeed = 20;  // mm, mm, 1/s, mm/s
  constexpr double kStartAndStop_rad = 1;                         // ten time constants of the loop
  machine::Job job = flat_job(2 * kTool, {{-10, -10, -1}, {10, 10, 0}});
  set_gain(job, kGain);
  const auto points = walls(
      job,
      "G21 G90 G17 G64\nT1 M6\nS12000 M3\nG0 X6 Y0 Z5\nG0 Z-2\nG3 X6 Y0 I-6 J0 F1200\nG3 X6 Y0 I-6 J0\nG0 Z5\nM30\n");
  const double w = kFeed / kPath, left = kPath - kPath / std::sqrt(1 + (w / kGain) * (w / kGain));
  ASSERT_GT(1000 * left, 20);
  std::size_t seen = 0;
  for (const auto& p : points) {
    if (p.place_mm.head<2>().norm() < kPath) continue;  // the inner wall, of the core
    // Where the axes start from rest and come to rest again, at +X, they are not behind.
    if (std::abs(std::atan2(p.place_mm.y(), p.place_mm.x())) < kStartAndStop_rad) continue;
    EXPECT_NEAR(p.place_mm.head<2>().norm(), kPath + kTool, 1e-3) << "the nominal bore has the programmed size";
    EXPECT_NEAR(1000 * p.error_mm, 1000 * left, kGrid_um);
    ++seen;
  }
  EXPECT_GT(seen, 1000u);
}

TEST(Contour, OfALineThatTheAxesFollowIsNothing) {
  // The axes stay on the line, behind their command: the feed marks of both sweeps lie in step.
  machine::Job job = flat_job(6, {{0, -1, -1}, {6, 4, 0}});
  set_gain(job, 33);
  const auto points =
      walls(job, "G21 G90 G17 G64\nT1 M6\nS3000 M3\nG0 X-12 Y-3 Z5\nG0 Z-2\nG1 X14 F1200\nG0 Z5\nM30\n");
  ASSERT_GT(points.size(), 100u);
  constexpr double kMark_um = 1000 * 0.2 * 0.2 / (8 * 3);  // f^2 / (8 R): 1.7 um
  for (const auto& p : points) EXPECT_NEAR(1000 * p.error_mm, 0, 0.02 * kMark_um) << p.place_mm.transpose();
}

TEST(Contour, InAPocketCornerIsTheClosedForm) {
  // Along +X, then +Y at a constant v: behind by e = v / Kp, the loop comes to x = -e u, y = e (u - 1 - ln u) with
  // u = exp(-Kp t). The wall outside the corner, facing (1, -1), lies at the largest (x - y) / sqrt(2): u = 1/2,
  // e ln 2 / sqrt(2) short of the programmed corner.
  constexpr double kFeed = 10, kGain = 100;
  machine::Job job = flat_job(6, {{-10, -8, -1}, {8, 10, 0}});
  set_gain(job, kGain);
  const auto points =
      walls(job, "G21 G90 G17 G64\nT1 M6\nS12000 M3\nG0 X-20 Y0 Z5\nG0 Z-2\nG1 X0 F600\nG1 Y20\nG0 Z5\nM30\n");
  const double wanted_um = 1000 * kFeed / kGain * std::log(2.0) / std::sqrt(2.0);
  std::size_t seen = 0;
  const Vec3 bisector = Vec3(1, -1, 0).normalized();
  for (const auto& p : points) {
    const double away = std::acos(std::clamp(-p.normal.dot(bisector), -1.0, 1.0));
    if (p.place_mm.x() > 0 && p.place_mm.y() < 0 && away < 0.02) {
      EXPECT_NEAR(p.place_mm.head<2>().norm(), 3, 1e-3) << "the nominal corner is the cutter's";
      EXPECT_NEAR(1000 * p.error_mm, wanted_um, 0.01 * wanted_um + kGrid_um);
      ++seen;
    }
    // Far from it both walls are as programmed.
    if (p.place_mm.x() < -6) {
      EXPECT_NEAR(1000 * p.error_mm, 0, kGrid_um) << p.place_mm.transpose();
    }
  }
  EXPECT_GT(seen, 5u);
}

TEST(Contour, AndDeflectionAddUpToTheErrorAndAShiftIsNoContour) {
  machine::Job job = flat_job(6, {{0, -1, -1}, {6, 4, 0}});
  set_gain(job, 33);
  const auto wall = [](double y) {
    return fmt::format("G21 G90 G17 G64\nT1 M6\nS6000 M3\nG0 X-8 Y{0:.3f} Z5\nG0 Z-2\nG1 X14 F600\nG0 Z5\nM30\n", y);
  };
  Diagnostics diagnostics;
  const SimulatedProgram original = motion(job, wall(-3)), moved = motion(job, wall(-3.02));
  const Target target = make_target(job, original, diagnostics);
  // No force: what a shift of 20 um away from the wall leaves is 20 um, all of it beside the contour.
  const Prediction shifted = predict(job, target, moved, {});
  ASSERT_GT(shifted.surface.size(), 100u);
  for (const auto& p : shifted.surface) {
    EXPECT_NEAR(1000 * p.error_mm, 20, kGrid_um);
    EXPECT_NEAR(1000 * p.contour_mm, 0, kGrid_um);
  }
  EXPECT_NEAR(shifted.deflection_um.mean, 20, kGrid_um);
  EXPECT_NEAR(shifted.contour_um.rms, 0, kGrid_um);
  // With force, and a shift: bending is what the unshifted program shows, and the two add up.
  job.material = {2000, 700, 0, 15, 15, 0};
  job.tools[1].overhang_mm = 40;
  job.tools[1].helix_rad = kPi / 4;  // some of the edge cuts while the rest leaves its mark
  const Prediction bent = predict(job, target, original, {}), both = predict(job, target, moved, {});
  ASSERT_GT(std::abs(bent.deflection_um.mean), 5);
  EXPECT_NEAR(both.form_error_um.mean, both.deflection_um.mean + both.contour_um.mean, 1e-9);
  EXPECT_NEAR(both.deflection_um.mean - bent.deflection_um.mean, 20,
              0.05 * std::abs(bent.deflection_um.mean) + kGrid_um);
}

TEST(Contour, NominalStampsCoverEveryCornerThatTheAxesCut) {
  machine::Job job = flat_job(6, {{-10, -8, -1}, {8, 10, 0}});
  set_gain(job, 20);
  const SimulatedProgram program = motion(
      job,
      "G21 G90 G17 G64\nT1 M6\nS3000 M3\nG0 X-20 Y0 Z5\nG0 Z-2\nG1 X0 F600\nG1 Y20\nG2 X5 Y25 I5 J0\nG0 Z5\nM30\n");
  const removal::StampPath nominal = removal::nominal_path(program.moves_in_part(), program.selected, program.path);
  double corner = 1e9, end = 1e9, start = 1e9;
  for (const auto& s : nominal.stamps) {
    const Vec3 there = nc::point_at(program.moves_in_part(), program.moves_in_part().moves[s.move], s.fraction);
    EXPECT_LT((s.pose.tip_mm - there).norm(), 1e-9) << "on the programmed path";
    corner = std::min(corner, (s.pose.tip_mm - Vec3(0, 0, -2)).norm());
    start = std::min(start, (s.pose.tip_mm - Vec3(-20, 0, -2)).norm());
    end = std::min(end, (s.pose.tip_mm - Vec3(5, 25, -2)).norm());
    if (!s.first) {
      EXPECT_LT(s.feed_per_tooth_mm.norm(), 1.6 * 0.1) << "600 mm/min over 6000 passings";
    }
  }
  EXPECT_LT(corner, 1e-9);
  EXPECT_LT(start, 1e-9);
  EXPECT_LT(end, 1e-9);
  EXPECT_EQ(nominal.runs.size(), program.path.runs.size());
  EXPECT_LT(nominal.stamps.size(), program.path.stamps.size() + 20);
}

}  // namespace
}  // namespace camber::simulate
