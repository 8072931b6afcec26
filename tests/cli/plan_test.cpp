// camber plan from the command line: what it writes, and what it says where a part cannot be made.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/block_part.h"
#include "tests/support/open_page.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::CamberRun;
using tests::run_camber;
using tests::TempFolder;

const std::string kPlan =
    "part = \"part.stl\"\nmachine = \"machine.toml\"\ncase_base = \"cases.toml\"\n[blank]\n"
    "box_mm = [[0, 0, 0], [60, 40, 22]]\n[material]\npreset = \"FC250\"\nkrc_ratio = 0.4\n[work]\nmaterial = "
    "\"FC250\"\n"
    "[tool.1]\ntype = \"flat\"\ndiameter_mm = 4\nflutes = 4\noverhang_mm = 30\n"
    "[tool.2]\ntype = \"drill\"\ndiameter_mm = 8\nflutes = 2\noverhang_mm = 60\n";
const std::string kCases =
    "[[case]]\nmaterial = \"FC250\"\ntool = \"end mill\"\ntool_material = \"carbide\"\ndiameter_mm = 4\n"
    "speed_m_per_min = 60\nfeed_mm_per_min = 400\naxial_depth_mm = 2\nradial_depth_mm = 1\n"
    "[[case]]\nmaterial = \"FC250\"\ntool = \"drill\"\ntool_material = \"carbide\"\ndiameter_mm = 8\n"
    "speed_m_per_min = 50\nfeed_mm_per_min = 300\n";

/// A pocket, and a hole of this diameter.
CamberRun plan(const TempFolder& folder, double hole_mm, const std::string& more = " -o out") {
  const tests::BlockPart part{{{0, 0, 0}, {60, 40, 20}}, {{{10, 10, 12}, {30, 30, 21}}}, {{45, 20, hole_mm, 0}}};
  tests::write_stl(part.mesh(), folder / "part.stl");
  folder.write("plan.toml", kPlan);
  if (!std::filesystem::exists(folder / "cases.toml")) folder.write("cases.toml", kCases);
  folder.write("machine.toml", "[spindle]\nmax_rpm = 8000\n");
  return run_camber(folder, "plan plan.toml" + more);
}

TEST(PlanCommand, WritesTablesPageAndFigures) {
  const TempFolder folder;
  const CamberRun run = plan(folder, 8);
  ASSERT_EQ(run.status, 0) << run.err;
  for (const char* file : {"operations.toml", "plan-yz.toml", "plan-zx.toml", "plan-largest.toml", "report.html"})
    EXPECT_TRUE(std::filesystem::exists(folder / ("out/" + std::string(file)))) << file;
  const auto json = nlohmann::json::parse(tests::file_text(folder / "out/plan.json"));
  EXPECT_EQ(json.at("plans").size(), 3U);
  ASSERT_EQ(json.at("operations").size(), 3U);
  EXPECT_EQ(json.at("operations").at(0).at("feature"), "face");
  EXPECT_EQ(json.at("operations").at(1).at("feature"), "closed pocket");
  EXPECT_EQ(json.at("operations").at(2).at("feature"), "through hole");
  const std::string page = tests::file_text(folder / "out/report.html");
  EXPECT_NE(page.find("plan-data"), std::string::npos);
  EXPECT_NE(page.find("closed pocket"), std::string::npos);
}

TEST(PlanCommand, PageMachinesOnePrimitiveAfterTheOther) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  ASSERT_EQ(plan(folder, 8).status, 0);
  EXPECT_EQ(tests::open_page("plan", folder / "out/report.html"), "");
}

TEST(PlanCommand, MakesProgramsThatCutThePart) {
  const TempFolder folder;
  const CamberRun run = plan(folder, 8, " -o out --programs");
  ASSERT_EQ(run.status, 0) << run.err;
  for (const char* file : {"job.toml", "program.nc", "operation-01.nc", "operation-02.nc", "operation-03.nc"})
    EXPECT_TRUE(std::filesystem::exists(folder / ("out/" + std::string(file)))) << file;
  const auto json = nlohmann::json::parse(tests::file_text(folder / "out/plan.json"));
  const auto& taken = json.at("plans").at(json.at("setups").at(0).at("best").get<std::size_t>());
  double sum = 0;
  for (const auto& o : json.at("operations")) {
    EXPECT_GT(o.at("time_s").get<double>(), 0);
    sum += o.at("time_s").get<double>();
  }
  EXPECT_NEAR(taken.at("time_s").get<double>(), sum, 0.2 * sum);
  EXPECT_LT(taken.at("gouge_um"), 20);  // a tenth of a voxel
  // Sharp inner corners of the pocket stay; the rest of the removal volume goes.
  EXPECT_NEAR(taken.at("removed_mm3").get<double>(), json.at("removal_mm3").get<double>(),
              0.02 * json.at("removal_mm3").get<double>());
  const CamberRun check = run_camber(folder, "check out/program.nc");
  EXPECT_EQ(check.status, 0) << check.err;
  const CamberRun copy = run_camber(folder, "copy out/job.toml -o out/copied.nc --effective-config");
  EXPECT_EQ(copy.status, 0) << copy.err;
}

TEST(PlanCommand, GoesOnFromTheStockOfAnInterruptedRun) {
  const TempFolder folder;
  ASSERT_EQ(plan(folder, 8).status, 0);
  const auto whole = nlohmann::json::parse(tests::file_text(folder / "out/plan.json"));
  const CamberRun copy =
      run_camber(folder, "copy out/job.toml -o out/stopped.nc --stop-after 60 --stock left.vdb --json out/copy.json");
  ASSERT_EQ(copy.status, 0) << copy.err;
  const double cut = nlohmann::json::parse(tests::file_text(folder / "out/copy.json")).at("removed_mm3");
  EXPECT_GT(cut, 300);
  folder.write("plan.toml", tests::replaced(kPlan, "box_mm = [[0, 0, 0], [60, 40, 22]]", "vdb = \"left.vdb\""));
  const CamberRun run = run_camber(folder, "plan plan.toml -o again --programs");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto json = nlohmann::json::parse(tests::file_text(folder / "again/plan.json"));
  const double left = json.at("removal_mm3");
  EXPECT_NEAR(left, whole.at("removal_mm3").get<double>() - cut, 0.01 * left);
  EXPECT_NE(json.at("operations").at(0), whole.at("operations").at(0));
  const auto& taken = json.at("plans").at(json.at("setups").at(0).at("best").get<std::size_t>());
  // Sharp inner corners of the pocket stay.
  EXPECT_NEAR(taken.at("removed_mm3").get<double>(), left, 0.02 * left);
  EXPECT_LT(taken.at("gouge_um"), 25);
}

TEST(PlanCommand, PlansForWhatAProgramLeaves) {
  const TempFolder folder;
  ASSERT_EQ(plan(folder, 8).status, 0);
  const auto first = nlohmann::json::parse(tests::file_text(folder / "out/plan.json"));
  const CamberRun copy = run_camber(folder, "copy out/job.toml -o out/made.nc --stock made.vdb --json out/copy.json");
  ASSERT_EQ(copy.status, 0) << copy.err;
  const double removed = nlohmann::json::parse(tests::file_text(folder / "out/copy.json")).at("removed_mm3");
  folder.write("plan.toml", tests::replaced(kPlan, "part.stl", "made.vdb"));
  const CamberRun run = run_camber(folder, "plan plan.toml -o again --programs");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto json = nlohmann::json::parse(tests::file_text(folder / "again/plan.json"));
  EXPECT_NEAR(json.at("removal_mm3").get<double>(), removed, 2e-3 * removed);
  ASSERT_EQ(json.at("operations").size(), first.at("operations").size());
  for (std::size_t i = 0; i < json.at("operations").size(); ++i) {
    EXPECT_EQ(json.at("operations").at(i).at("feature"), first.at("operations").at(i).at("feature"));
    EXPECT_EQ(json.at("operations").at(i).at("tool"), first.at("operations").at(i).at("tool"));
  }
  const auto& taken = json.at("plans").at(json.at("setups").at(0).at("best").get<std::size_t>());
  EXPECT_NEAR(taken.at("removed_mm3").get<double>(), removed, 5e-3 * removed);
  EXPECT_LT(taken.at("gouge_um"), 25);
  // The job goes through camber copy by itself.
  const CamberRun again = run_camber(folder, "copy again/job.toml -o again/copied.nc --effective-config");
  EXPECT_EQ(again.status, 0) << again.err;

  folder.write("plan.toml", tests::replaced(kPlan, "part.stl", "made.vdb") + "[[setup]]\nturn = [[1, 0, 0, 180]]\n");
  const CamberRun turned = run_camber(folder, "plan plan.toml -o turned");
  EXPECT_EQ(turned.status, 1);
  EXPECT_EQ(
      turned.err,
      "plan.toml: error: a part from a stock.vdb is not turned; a set-up without turn was expected [setup-turn]\n");
}

TEST(PlanCommand, ComparesTheProgramsOfAllPlans) {
  const TempFolder folder;
  const CamberRun run = plan(folder, 8, " -o out --all-programs");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto json = nlohmann::json::parse(tests::file_text(folder / "out/plan.json"));
  const std::size_t best = json.at("setups").at(0).at("best").get<std::size_t>();
  std::size_t others = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& row = json.at("plans").at(i);
    EXPECT_GE(row.at("time_s").get<double>(), json.at("plans").at(best).at("time_s").get<double>());
    const std::string name = "out/program-" + row.at("division").get<std::string>() + ".nc";
    others += std::filesystem::exists(folder / name);
    // The pocket is one box in each plan, so that all come to the same program.
    if (i != best) {
      EXPECT_EQ(tests::file_text(folder / name), tests::file_text(folder / "out/program.nc"));
    }
  }
  EXPECT_EQ(others, 2U);
}

TEST(PlanCommand, WritesTheSameTwice) {
  const TempFolder a, b;
  ASSERT_EQ(plan(a, 8).status, 0);
  ASSERT_EQ(plan(b, 8, " -o out --threads 1").status, 0);
  for (const char* file : {"out/operations.toml", "out/plan-yz.toml", "out/report.html"})
    EXPECT_EQ(tests::file_text(a / file), tests::file_text(b / file)) << file;
}

TEST(PlanCommand, GoesOnFromAnEditedTable) {
  const TempFolder folder;
  ASSERT_EQ(plan(folder, 8).status, 0);
  const std::string table = tests::replaced(tests::file_text(folder / "out/operations.toml"), "radial_depth_mm = 1\n",
                                            "radial_depth_mm = 0.5\n");
  folder.write("edited.toml", table);
  const CamberRun run = run_camber(folder, "plan plan.toml --operations edited.toml -o again");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto json = nlohmann::json::parse(tests::file_text(folder / "again/plan.json"));
  EXPECT_EQ(json.at("operations").at(1).at("radial_mm"), 0.5);
  EXPECT_EQ(json.at("operations").at(1).at("limit"), "given");
}

TEST(PlanCommand, SaysWhatToolWouldDo) {
  const TempFolder folder;
  const CamberRun run = plan(folder, 5);
  EXPECT_EQ(run.status, 3);
  EXPECT_EQ(run.err,
            "camber: error: through hole, hole from (42.5, 17.5, 0) to (47.5, 22.5, 20) stays: none of the tools will "
            "do; it needs a drill of 5 mm that reaches 20 mm deep\n");
}

TEST(PlanCommand, LearnsTheConditionsOfAPlan) {
  const TempFolder folder;
  const CamberRun first = plan(folder, 8, " -o out --learn");
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_NE(tests::file_text(folder / "cases.toml").find("[[case]]", kCases.size()), std::string::npos);
  const std::string learned = tests::file_text(folder / "cases.toml");
  EXPECT_EQ(learned.substr(0, kCases.size()), kCases);
  ASSERT_EQ(plan(folder, 8, " -o out --operations out/operations.toml --learn").status, 0);
  EXPECT_EQ(tests::file_text(folder / "cases.toml"), learned);
}

TEST(PlanCommand, AnswersOtherwiseAfterALearnedJob) {
  const TempFolder folder;
  ASSERT_EQ(plan(folder, 8).status, 0);
  const auto pocket = [&] {
    return nlohmann::json::parse(tests::file_text(folder / "out/plan.json")).at("operations").at(1);
  };
  const double before = pocket().at("S");
  const std::string table = tests::file_text(folder / "out/operations.toml");
  const std::string row = "spindle_rpm = " + std::to_string(static_cast<int>(before));
  ASSERT_NE(table.find(row), std::string::npos);
  folder.write("edited.toml",
               tests::replaced(table, row, "spindle_rpm = " + std::to_string(static_cast<int>(1.4 * before))));
  ASSERT_EQ(plan(folder, 8, " -o out --operations edited.toml --learn").status, 0);
  EXPECT_EQ(pocket().at("limit"), "given");
  ASSERT_EQ(plan(folder, 8).status, 0);
  // The mean of the old case and the learned one.
  EXPECT_NEAR(pocket().at("S").get<double>() / before, 1.2, 0.01);
}

/// docs/plan.md shows what is printed.
TEST(PlanCommand, PrintsTheErrorsOfTheSampleBaseAsDocumented) {
  const TempFolder folder;
  const CamberRun run = run_camber(folder, "plan " CAMBER_SOURCE_DIR "/samples/15-plan/plan.toml --cases-error");
  EXPECT_EQ(run.status, 0) << run.err;
  const std::string page = tests::file_text(CAMBER_SOURCE_DIR "/docs/plan.md");
  std::size_t rows = 0;
  for (const char* tool : {"\nall ", "\ndrill ", "\nend mill ", "\nface mill "}) {
    const std::size_t at = run.out.find(tool);
    ASSERT_NE(at, std::string::npos) << tool;
    EXPECT_NE(page.find(run.out.substr(at, run.out.find('\n', at + 1) - at)), std::string::npos) << tool;
    ++rows;
  }
  EXPECT_EQ(rows, 4U);
}

TEST(PlanCommand, PrintsHowWellTheCasesPredictEachOther) {
  const TempFolder folder;
  const CamberRun run = plan(folder, 8, " --cases-error");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out.substr(0, run.out.find('\n')),
            "2 cases, each asked of the others: factor between predicted and true");
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(PlanCommand, NeedsAFolderOrCasesError) {
  const TempFolder folder;
  const CamberRun run = plan(folder, 8, "");
  EXPECT_EQ(run.status, 2);
}

}  // namespace
}  // namespace camber
