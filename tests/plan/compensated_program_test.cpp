// compensate = true: a finishing operation is moved against its predicted form error in the same run.
#include <algorithm>
#include <regex>

#include <gtest/gtest.h>

#include "plan/programs.h"
#include "tests/support/block_part.h"
#include "tests/support/temp_folder.h"

namespace camber::plan {
namespace {

/// A step of 6 mm by a slender end mill of 6 mm; its wall is at y = 8.
constexpr const char* kStepPlan =
    "part = \"part.stl\"\nmachine = \"machine.toml\"\ncase_base = \"cases.toml\"\n[blank]\n"
    "box_mm = [[0, 0, 0], [10, 14, 8]]\n[material]\npreset = \"FC250\"\nkrc_ratio = 0.4\n"
    "[work]\nmaterial = \"FC250\"\nfinish = \"fine\"\nallowance_mm = 0.3\ncompensate = true\n"
    "[simulation]\nvoxel_mm = 0.25\n"
    "[tool.1]\ntype = \"flat\"\ndiameter_mm = 6\nflutes = 4\nhelix_deg = 30\noverhang_mm = 30\n";
constexpr const char* kStepMachine =
    "[control]\ndialect = \"fanuc\"\nperiod_ms = 4.0\n"
    "[axis.x]\nmax_velocity_mm_per_min = 20000\nacceleration_mm_per_s2 = 3000\n"
    "[axis.y]\nmax_velocity_mm_per_min = 20000\nacceleration_mm_per_s2 = 3000\n"
    "[axis.z]\nmax_velocity_mm_per_min = 20000\nacceleration_mm_per_s2 = 3000\n[spindle]\nmax_rpm = 12000\n";
constexpr const char* kStepCases =
    "[[case]]\nmaterial = \"FC250\"\ntool = \"end mill\"\ntool_material = \"carbide\"\ndiameter_mm = 6\n"
    "finish = \"fine\"\nspeed_m_per_min = 60\nfeed_mm_per_min = 1500\naxial_depth_mm = 6\nradial_depth_mm = 2\n";

PlanProgram step_program(const tests::TempFolder& folder, bool compensate, std::size_t& finish) {
  const tests::BlockPart part{{{0, 0, 0}, {10, 14, 8}}, {{{-1, -1, 2}, {11, 8, 9}}}, {}};
  tests::write_stl(part.mesh(), folder / "part.stl");
  folder.write("machine.toml", kStepMachine);
  folder.write("cases.toml", kStepCases);
  Diagnostics diagnostics;
  PlanInput input = read_plan_input(folder.write("plan.toml", kStepPlan), diagnostics);
  EXPECT_TRUE(input.compensate);
  input.compensate = compensate;
  const PlanResult result = make_plan(input, diagnostics);
  const PlannedDivision& plan = result.setups.at(0).plans.at(result.setups.at(0).best);
  finish = static_cast<std::size_t>(std::ranges::find(plan.operations, OperationKind::finish, &PlanOperation::kind) -
                                    plan.operations.begin());
  EXPECT_EQ(finish, plan.operations.size() - 1);
  return make_program(input, copy_job(input, input.part_path, ""), plan, "program.nc", diagnostics);
}

/// Greatest Y of the places over the step's length.
double nearest_to_wall_mm(const std::string& text) {
  double out = -1e9, x = 1e9, y = -1e9;
  const std::regex x_word("X(-?[0-9.]+)"), y_word("Y(-?[0-9.]+)");
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    std::smatch m;
    if (std::regex_search(line, m, x_word)) x = std::stod(m[1]);
    if (std::regex_search(line, m, y_word)) y = std::stod(m[1]);
    if (x > -1 && x < 11) out = std::max(out, y);
    at = end + 1;
  }
  return out;
}

TEST(CompensatedPlan, FinishesWithLessFormErrorInTheSameRun) {
  const tests::TempFolder folder;
  std::size_t finish = 0;
  const PlanProgram plain = step_program(folder, false, finish), moved = step_program(folder, true, finish);
  const std::regex note(
      R"(compensated: form error ([0-9.]+) um \(p95\) without, ([0-9.]+) um with it, both predicted)");
  std::smatch m;
  ASSERT_TRUE(std::regex_match(moved.notes.at(finish), m, note)) << moved.notes.at(finish);
  const double without = std::stod(m[1]), with = std::stod(m[2]);
  EXPECT_GT(without, 5);
  EXPECT_LT(with, 0.5 * without);
  EXPECT_EQ(plain.notes.at(finish), "");
  // Only the finishing operation is another one, in its own program and in the whole.
  for (std::size_t i = 0; i < finish; ++i) EXPECT_EQ(moved.each.at(i), plain.each.at(i));
  EXPECT_NE(moved.each.at(finish), plain.each.at(finish));
  EXPECT_NE(moved.whole, plain.whole);
  // Down milling bends the tool off the wall: the path goes into it by about what was left.
  const double into = 1000 * (nearest_to_wall_mm(moved.each.at(finish)) - nearest_to_wall_mm(plain.each.at(finish)));
  EXPECT_GT(into, 0.3 * without);
  EXPECT_LT(into, 3 * without);
}

}  // namespace
}  // namespace camber::plan
