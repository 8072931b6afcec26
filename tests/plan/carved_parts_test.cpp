// Programs of plans for random parts, judged by a height map that shares no code with Camber.
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "plan/programs.h"
#include "tests/support/height_map_judge.h"
#include "tests/support/random_part.h"
#include "tests/support/temp_folder.h"

namespace camber::plan {
namespace {

/// CAMBER_CARVED_PARTS seeds from 3 on (bench/plan/random-parts), else three. Of these 4 has a slot that is entered
/// from the side where a graze of 0.05 mm stands, and rows along a wall of 84 would leave fins narrower than the
/// planner's cells.
std::vector<unsigned> carved_seeds() {
  constexpr unsigned kFirst = 3;
  const char* given = std::getenv("CAMBER_CARVED_PARTS");
  if (!given) return {3, 4, 84};
  std::vector<unsigned> out(static_cast<std::size_t>(std::atoi(given)));
  std::iota(out.begin(), out.end(), kFirst);
  return out;
}

std::string axis(const char* name) {
  return std::string("[axis.") + name + "]\nmax_velocity_mm_per_min = 20000\nacceleration_mm_per_s2 = 3000\n";
}
const std::string kCarvedMachine = "[control]\ndialect = \"fanuc\"\nperiod_ms = 4.0\n" + axis("x") + axis("y") +
                                   axis("z") + "[spindle]\nmax_rpm = 12000\n";
constexpr const char* kCarvedCases =
    "[[case]]\nmaterial = \"A5052\"\ntool = \"end mill\"\ntool_material = \"carbide\"\ndiameter_mm = 8\n"
    "speed_m_per_min = 300\nfeed_mm_per_min = 3600\naxial_depth_mm = 6\nradial_depth_mm = 3\n"
    "[[case]]\nmaterial = \"A5052\"\ntool = \"drill\"\ntool_material = \"carbide\"\ndiameter_mm = 8\n"
    "speed_m_per_min = 100\nfeed_mm_per_min = 600\n";

std::string mill(int number, double diameter) {
  return "[tool." + std::to_string(number) + "]\ntype = \"flat\"\ndiameter_mm = " + std::to_string(diameter) +
         "\nflutes = 3\noverhang_mm = 60\n";
}
std::string drill(int number, double diameter) {
  return "[tool." + std::to_string(number) + "]\ntype = \"drill\"\ndiameter_mm = " + std::to_string(diameter) +
         "\nflutes = 2\noverhang_mm = 90\n";
}

std::string plan_text(const machine::Box& blank) {
  const auto corner = [](const Vec3& p) {
    return "[" + std::to_string(p.x()) + ", " + std::to_string(p.y()) + ", " + std::to_string(p.z()) + "]";
  };
  return "part = \"part.stl\"\nmachine = \"machine.toml\"\ncase_base = \"cases.toml\"\n[blank]\nbox_mm = [" +
         corner(blank.min_mm) + ", " + corner(blank.max_mm) +
         "]\n[material]\npreset = \"Al6082-T6\"\n[work]\nmaterial = \"A5052\"\n[simulation]\nvoxel_mm = 0.5\n" +
         mill(1, 3) + mill(2, 6) + mill(3, 12) + drill(4, 8) + drill(5, 10);
}

judge::Point point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

std::map<int, judge::Cutter> cutters_of(const PlanInput& input) {
  std::map<int, judge::Cutter> out;
  for (const auto& [number, tool] : input.tools) {
    judge::Cutter c{.diameter = tool.tool.diameter_mm, .point_angle = tool.tool.point_angle_rad};
    if (tool.tool.type == machine::ToolType::drill && c.point_angle <= 0) c.point_angle = kPi * 118 / 180;
    c.flutes = tool.tool.overhang_mm;
    out.emplace(number, c);
  }
  return out;
}

/// The least diameter that mills a primitive; 0: none does.
int smallest_mill(const PlanInput& input, const PlannedDivision& plan, std::size_t primitive) {
  int out = 0;
  for (const PlanOperation& o : plan.operations)
    if (o.primitive == primitive && o.pattern != Pattern::drilling &&
        (out == 0 || input.tools.at(o.tool).tool.diameter_mm < input.tools.at(out).tool.diameter_mm))
      out = o.tool;
  return out;
}

class CarvedParts : public ::testing::TestWithParam<unsigned> {};

TEST_P(CarvedParts, AreThePartWhereToolsReach) {
  const tests::RandomPart made = tests::random_part(GetParam());
  const tests::TempFolder folder;
  const std::string stl = folder / "part.stl";
  tests::write_stl(made.part.mesh(), stl);
  folder.write("machine.toml", kCarvedMachine);
  folder.write("cases.toml", kCarvedCases);
  Diagnostics diagnostics;
  const PlanInput input = read_plan_input(folder.write("plan.toml", plan_text(made.blank)), diagnostics);
  const PlanResult result = make_plan(input, diagnostics);
  const SetupPlan& setup = result.setups.at(0);
  const PlannedDivision& plan = setup.plans.at(setup.best);
  const PlanProgram program =
      make_program(input, copy_job(input, input.part_path, ""), plan, "program.nc", diagnostics);
  for (const Diagnostic& d : diagnostics.all())
    EXPECT_TRUE(d.check == "plan-no-place" || d.check == "tooth-frequency") << to_string(d);

  const std::map<int, judge::Cutter> cutters = cutters_of(input);
  const judge::PartMesh part(judge::read_stl(stl));
  constexpr double kCell = 0.5, kOfInterest = 0.01, kToWall = 0.33;
  // Points of the map stand beside the part's walls, which are at multiples of half a millimetre.
  judge::HeightMap map(point(made.blank.min_mm + Vec3(0.17, 0.17, 0)), point(made.blank.max_mm), kCell);
  judge::Verdict whole;
  for (const judge::Piece& piece : judge::ProgramReader().read(program.whole))
    map.cut(piece, cutters.at(piece.tool), whole);
  EXPECT_EQ(whole.rapid.depth, 0) << "line " << whole.rapid.line;
  EXPECT_EQ(whole.shank.depth, 0) << "line " << whole.shank.line;
  for (std::size_t i = 0; i < plan.order.steps.size(); ++i) {
    const VolumePrimitive& p = plan.primitives[plan.order.steps[i].primitive];
    const int tool = p.is_hole ? 0 : smallest_mill(input, plan, i + 1);
    if (tool == 0) continue;
    judge::Verdict v;
    map.compare(part, point(p.min_mm - Vec3(0, 0, 1e-3)), point(p.max_mm - Vec3(0, 0, 1e-3)), 0, kOfInterest,
                cutters.at(tool), v, kToWall);
    EXPECT_EQ(v.left_reachable.depth, 0) << "primitive " << i + 1 << ", T" << tool << " at " << v.left_reachable.place.x
                                         << " " << v.left_reachable.place.y << " " << v.left_reachable.place.z;
  }
  judge::Verdict all;
  map.compare(part, {-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}, 0, 1e9, cutters.at(1), all);
  EXPECT_LT(all.gouge.depth, 0.010) << "at " << all.gouge.place.x << " " << all.gouge.place.y << " "
                                    << all.gouge.place.z << ", line " << all.gouge.line;
}

INSTANTIATE_TEST_SUITE_P(All, CarvedParts, ::testing::ValuesIn(carved_seeds()));

}  // namespace
}  // namespace camber::plan
