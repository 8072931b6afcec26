// The lever "allowance": the pass before those to compensate is shifted, so that it leaves less stock.
#include "compensate/pass_before.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compensate/compensate_path.h"
#include "tests/support/temp_folder.h"

namespace camber::compensate {
namespace {

constexpr double kLeft_mm = 0.4;  // by the pass before

/// A wall along X, of which an end mill of 8 mm cuts the face y = 0 in two passes; lines 5 to 9 and 10 to 13.
std::string wall_program() {
  return fmt::format(
      "G21 G90 G17 G40 G49 G80\nT1 M6\nG54 S4000 M3\nG0 Z5.\n"
      "G0 X-6. Y{0:.3f}\nZ-6.\nG1 X18. F600\nG0 Z5.\n"
      "G0 X-6. Y-4.000\nZ-6.\nG1 X18. F400\nG0 Z5.\nM5\nM30\n",
      -4 - kLeft_mm);
}

machine::Job wall_job(const tests::TempFolder& folder) {
  machine::Job job;
  job.path = folder / "job.toml";
  job.program = folder.write("wall.nc", wall_program());
  for (auto& axis : job.machine.axis) {
    axis.acceleration_mm_per_s2 = 1000;
    axis.max_velocity_mm_per_s = 100;
  }
  job.machine.control.corner = {.law = machine::CornerLaw::blend, .tolerance_mm = 0.01};
  machine::Tool tool;
  tool.number = 1;
  tool.type = machine::ToolType::flat;
  tool.diameter_mm = 8;
  tool.flutes = 4;
  tool.helix_rad = kPi / 4;
  tool.overhang_mm = 36;
  job.tools[1] = tool;
  job.material = {1860, 700, 0, 15, 15, 0};
  job.stock.box = machine::Box{{0, -1.5, -5}, {12, 2, 0}};
  job.simulation.voxel_mm = 0.15;
  job.compensation.operations.blocks = {{9, 12}};
  job.compensation.tolerance_um = 2;
  job.compensation.max_rounds = 3;
  job.compensation.levers = {machine::Lever::shift};
  return job;
}

TEST(PassBefore, LeavesLessWhereABowRemains) {
  const tests::TempFolder folder;
  Diagnostics diagnostics;
  machine::Job job = wall_job(folder);
  const CompensationResult shifted = compensate(job, diagnostics, {});
  EXPECT_FALSE(shifted.pass_before);
  job.compensation.levers = {machine::Lever::shift, machine::Lever::allowance};
  job.compensation.pass_allowance_mm = 0.1;
  const CompensationResult c = compensate(job, diagnostics, {});
  EXPECT_EQ(diagnostics.all().size(), 0u);
  ASSERT_TRUE(c.pass_before);
  EXPECT_NEAR(c.pass_before->given_mm, kLeft_mm, 0.01) << "as it was programmed";
  EXPECT_NEAR(c.pass_before->left_mm, 0.1, 0.01) << "as it was asked for";
  EXPECT_LT(c.figures.after_um.p95, 0.7 * shifted.figures.after_um.p95);
  EXPECT_EQ(c.figures.before_um.p95, shifted.figures.before_um.p95) << "of the given program";
  EXPECT_LE(c.safety.others.gouge_depth_p999_um, c.safety.depth_limit_um);
  // In the middle of the wall the pass before lies where it leaves 0.1 mm.
  Diagnostics read;
  const auto emitted = motion::simulate_motion(SourceText(job.program, c.emitted.text), job, {}, read);
  double nearest_mm = 1;
  for (const nc::Move& m : emitted.moves_in_part().moves) {
    if (m.kind != nc::MoveKind::linear || m.start_mm.x() > 6 || m.end_mm.x() < 6.001) continue;
    const Vec3 middle = m.start_mm + (6 - m.start_mm.x()) / (m.end_mm.x() - m.start_mm.x()) * (m.end_mm - m.start_mm);
    nearest_mm = std::min(nearest_mm, std::abs(middle.y() + 4.1));
  }
  EXPECT_LT(nearest_mm, 0.01);
}

TEST(PassBefore, ChoosesWhatTheDeflectionOfItsCutterAllows) {
  const tests::TempFolder folder;
  Diagnostics diagnostics;
  machine::Job job = wall_job(folder);
  job.compensation.levers = {machine::Lever::shift, machine::Lever::allowance};
  const CompensationResult c = compensate(job, diagnostics, {});
  ASSERT_TRUE(c.pass_before);
  EXPECT_GT(c.pass_before->left_mm, 0.02);
  EXPECT_LT(c.pass_before->left_mm, 0.8 * kLeft_mm);
  EXPECT_LE(c.safety.others.gouge_depth_p999_um, c.safety.depth_limit_um);
}

TEST(PassBefore, IsRefusedWhereTheStockHasTheAllowance) {
  const tests::TempFolder folder;
  Diagnostics diagnostics;
  machine::Job job = wall_job(folder);
  job.operations.blocks = {{9, 12}};
  job.compensation.levers = {machine::Lever::shift, machine::Lever::allowance};
  try {
    compensate(job, diagnostics, {});
    FAIL() << "there is no pass before";
  } catch (const InputError& error) {
    EXPECT_EQ(error.diagnostics().front().check, "lever-unusable");
    EXPECT_EQ(error.diagnostics().front().message,
              "levers names \"allowance\", but no pass before those to compensate cuts what they cut, or its moves "
              "cannot be shifted; levers without \"allowance\" were expected");
  }
}

}  // namespace
}  // namespace camber::compensate
