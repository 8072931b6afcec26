#include <gtest/gtest.h>

#include "plan/setup_plan.h"
#include "test_paths.h"
#include "tests/support/block_part.h"
#include "tests/support/temp_folder.h"

namespace camber::plan {
namespace {

constexpr const char* kMachine =
    "[control]\ndialect = \"fanuc\"\n[axis.x]\nmax_velocity_mm_per_min = 9000\n"
    "[axis.y]\nmax_velocity_mm_per_min = 9000\n[axis.z]\nmax_velocity_mm_per_min = 9000\n";
constexpr const char* kCases =
    "[[case]]\nmaterial = \"FC250\"\ntool = \"end mill\"\ntool_material = \"carbide\"\n"
    "diameter_mm = 10\nspeed_m_per_min = 80\nfeed_mm_per_min = 350\n";
constexpr const char* kRest =
    "[material]\npreset = \"FC250\"\nkrc_ratio = 0.4\n[work]\nmaterial = \"FC250\"\n"
    "[tool.1]\ntype = \"flat\"\ndiameter_mm = 10\nflutes = 4\noverhang_mm = 40\n";

class PlanFile : public ::testing::Test {
 protected:
  PlanFile() {
    const tests::BlockPart part{{{0, 0, 0}, {60, 40, 20}}, {{{10, 10, 12}, {40, 30, 21}}}, {}};
    tests::write_stl(part.mesh(), folder / "part.stl");
    folder.write("machine.toml", kMachine);
    folder.write("cases.toml", kCases);
  }

  /// First lines of the messages, without the folder.
  std::string messages(const std::string& head, const std::string& rest = kRest) {
    const std::string path = folder.write("plan.toml", head + rest);
    Diagnostics diagnostics;
    std::string out;
    const auto add = [&](const std::vector<Diagnostic>& all) {
      for (const Diagnostic& d : all) {
        const std::string text = to_string(d);
        out += tests::replaced(text.substr(0, text.find('\n')), folder.path() + "/", "") + "\n";
      }
    };
    try {
      const PlanInput input = read_plan_input(path, diagnostics);
      make_plan(input, diagnostics);
      add(diagnostics.all());
    } catch (const InputError& error) {
      add(error.diagnostics());
    }
    return out;
  }

  static std::string head(const std::string& blank = "box_mm = [[0, 0, 0], [60, 40, 20]]") {
    return "part = \"part.stl\"\nmachine = \"machine.toml\"\ncase_base = \"cases.toml\"\n[blank]\n" + blank + "\n";
  }

  tests::TempFolder folder;
};

TEST_F(PlanFile, IsGoodAsTheTestsHaveIt) { EXPECT_EQ(messages(head()), ""); }

TEST_F(PlanFile, NamesFilesThatAreMissing) {
  EXPECT_EQ(
      messages("part = \"no.stl\"\nmachine = \"machine.toml\"\n[blank]\nbox_mm = [[0, 0, 0], [1, 1, 1]]\n"),
      "plan.toml:1:8: error: part: no such file: no.stl (paths are relative to the plan's folder) [file-missing]\n"
      "plan.toml: error: case_base is missing; a text in quotes was expected [key-missing]\n");
}

TEST_F(PlanFile, NamesToolsThatDoNotFitTheirUse) {
  EXPECT_EQ(messages(head(), std::string(kRest) + "use = \"drill\"\ncoating = true\n"),
            "plan.toml:17:1: error: unknown key coating in [tool.1] [key-unknown]\n");
  EXPECT_EQ(messages(head(), std::string(kRest) + "use = \"ball end mill\"\n"),
            "plan.toml:16:7: error: a tool of this type is no ball end mill; \"flat\" for end mills and face mills, "
            "\"ball\" for ball end mills, \"drill\" for drills was expected [tool-use]\n");
}

TEST_F(PlanFile, RefusesAPartOutsideTheBlank) {
  EXPECT_EQ(messages(head("box_mm = [[5, 0, 0], [60, 40, 20]]")),
            "plan.toml: error: 4000 mm3 of the part part.stl are outside the blank; a part within it was expected "
            "[part-outside-blank]\n");
}

TEST_F(PlanFile, RefusesABlankThatIsThePart) {
  EXPECT_EQ(messages(head("mesh = \"part.stl\"")),
            "plan.toml: error: the blank is the part part.stl; nothing is to be removed [nothing-to-remove]\n");
}

TEST_F(PlanFile, RefusesAnOpenMesh) {
  tests::BlockPart part{{{0, 0, 0}, {60, 40, 20}}, {}, {}};
  TriangleMesh mesh = part.mesh();
  mesh.triangles.pop_back();
  tests::write_stl(mesh, folder / "part.stl");
  EXPECT_EQ(
      messages(head()),
      "part.stl: error: the mesh has 3 edges without exactly two triangles; a closed solid was expected [stl-open]\n");
}

TEST_F(PlanFile, TakesInches) {
  const std::string path = folder.write("plan.toml", "units = \"inch\"\n" + head() + kRest);
  Diagnostics diagnostics;
  const PlanInput input = read_plan_input(path, diagnostics);
  EXPECT_NEAR(make_plan(input, diagnostics).removal_mm3, 30 * 20 * 8 * 25.4 * 25.4 * 25.4, 30);
}

TEST_F(PlanFile, GoesOnInAnotherSetup) {
  // A pocket from above and one from below.
  const tests::BlockPart part{
      {{0, 0, 0}, {60, 40, 20}}, {{{10, 10, 12}, {40, 30, 21}}, {{10, 10, -1}, {50, 30, 5}}}, {}};
  tests::write_stl(part.mesh(), folder / "part.stl");
  const std::string path = folder.write(
      "plan.toml",
      head() + kRest + "[[setup]]\nname = \"top\"\n[[setup]]\nname = \"bottom\"\nturn = [[1, 0, 0, 180]]\n");
  Diagnostics diagnostics;
  const PlanInput input = read_plan_input(path, diagnostics);
  const PlanResult result = make_plan(input, diagnostics);
  ASSERT_EQ(result.setups.size(), 2U);
  const PlannedDivision &first = result.setups[0].plans[0], &second = result.setups[1].plans[0];
  ASSERT_EQ(first.order.steps.size(), 1U);
  EXPECT_NEAR(first.primitives[first.order.steps[0].primitive].volume_mm3, 30 * 20 * 8, 0.1);
  EXPECT_EQ(first.unmachined.size(), 1U);
  ASSERT_EQ(second.order.steps.size(), 1U);
  EXPECT_NEAR(second.primitives[second.order.steps[0].primitive].volume_mm3, 40 * 20 * 5, 0.1);
  EXPECT_TRUE(second.complete());
}

}  // namespace
}  // namespace camber::plan
