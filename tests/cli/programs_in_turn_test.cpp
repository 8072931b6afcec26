// Jobs with several programs, and the set-up sheet.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::file_text;
using tests::run_camber;
using tests::TempFolder;

/// A slot 1 mm deep, then the same slot to 2 mm: the second program cuts on what the first has left.
void write_job(const TempFolder& folder) {
  const auto program = [](const char* depth) {
    return std::string("G21 G90 G17 G54\nT1 M6\nS4000 M3\nG43 H1\nG0 X-6. Y10. Z5.\nZ-") + depth +
           "\nG1 X26. F400\nG0 Z5.\nM30\n";
  };
  folder.write("first.nc", program("1."));
  folder.write("second.nc", program("2."));
  folder.write("job.toml",
               "program = [\"first.nc\", \"second.nc\"]\nmachine = \"preset:vmc-40\"\n[tool.1]\ntype = \"flat\"\n"
               "diameter_mm = 6.0\nflutes = 2\noverhang_mm = 20.0\n[material]\nktc_MPa = 800\nkrc_MPa = 300\n"
               "[stock]\nbox_mm = [[0, 0, -5], [20, 20, 0]]\nassumed = [\"box_mm\"]\n[simulation]\nvoxel_mm = 0.4\n"
               "coupling = \"rigid\"\n[compensation]\nlevers = [\"shift\"]\ntolerance_um = 2.0\n");
}

TEST(ProgramsInTurn, ArePredictedOnOneBlank) {
  const TempFolder folder;
  write_job(folder);
  const auto run = run_camber(folder, "predict job.toml -o out --json r.json");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto r = nlohmann::json::parse(file_text(folder / "r.json"));
  ASSERT_EQ(r["programs"].size(), 2u);
  EXPECT_EQ(r["programs"][0]["output"], "out/1-first");
  // Each takes one millimetre of a slot 6 mm wide and 20 mm long.
  for (const auto& p : r["programs"]) EXPECT_NEAR(p["removed_mm3"]["stock"].get<double>(), 120, 3) << p["program"];
  EXPECT_NEAR(r["machine_time_s"].get<double>(),
              r["programs"][0]["machine_time_s"].get<double>() + r["programs"][1]["machine_time_s"].get<double>(),
              1e-9);
  EXPECT_EQ(r["assumed"],
            (nlohmann::json{"machine preset:vmc-40, typical values of its class",
                            "T1 root_stiffness_N_per_um = 20, flute_length_mm = 18 [typical-value]", "stock box_mm"}));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/2-second/report.html"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/summary.json"));
}

TEST(ProgramsInTurn, AreCompensatedIntoAFolder) {
  const TempFolder folder;
  write_job(folder);
  const auto run = run_camber(folder, "compensate job.toml -o new --json r.json --report page.html --keep-anyway");
  EXPECT_TRUE(run.status == 0 || run.status == 3) << run.err;
  const auto r = nlohmann::json::parse(file_text(folder / "r.json"));
  ASSERT_EQ(r["programs"].size(), 2u);
  for (const char* name : {"first", "second"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / (std::string("new/") + name + ".nc"))) << name;
    const std::string page = std::string("page-") + (name[0] == 'f' ? "1-" : "2-") + name + ".html";
    EXPECT_TRUE(std::filesystem::exists(folder / page)) << page;
  }
  EXPECT_EQ(r["programs"][1]["output"], "new/second.nc");
  const auto own = run_camber(folder, "compensate job.toml -o .");
  EXPECT_EQ(own.status, 1);
  EXPECT_NE(own.err.find("[output-is-input]"), std::string::npos) << own.err;
}

TEST(ProgramsInTurn, AreRefusedWhereOneIsWanted) {
  const TempFolder folder;
  write_job(folder);
  EXPECT_EQ(
      run_camber(folder, "adapt job.toml -o new.nc").err,
      "job.toml:1:11: error: the job has 2 programs, which predict, compensate and check run one after the other; "
      "one program was expected here [several-programs]\n"
      "    program = [\"first.nc\", \"second.nc\"]\n"
      "              ^\n");
  folder.write("lines.toml", file_text(folder / "job.toml") + "[operations]\nblocks = [[1, 5]]\n");
  EXPECT_NE(
      run_camber(folder, "predict lines.toml -o out")
          .err.find("the job has 2 programs, and the lines of operations belong to one; a job for each program was "
                    "expected [several-programs]"),
      std::string::npos);
}

TEST(SetupSheet, HasToolsBlankOffsetsLimitsAndTimes) {
  const TempFolder folder;
  write_job(folder);
  const auto run = run_camber(folder, "check --job job.toml --sheet sheet.html");
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string sheet = file_text(folder / "sheet.html");
  for (const char* text : {"<h1>Set-up sheet: first.nc, second.nc</h1>", "@page { size: A4 portrait;",
                           "<b>Assumed, not given:</b> machine preset:vmc-40",
                           "Box 20 x 20 x 5 mm, from X 0 Y 0 Z -5 to X 20 Y 20 Z 0 (assumed)", "<td>G54</td>",
                           "<td>T1</td><td>flat end mill</td><td>6</td><td>2</td><td>20</td><td>H1</td><td>-</td>"
                           "<td>4000</td><td>400</td><td>-2</td>",
                           "<p>Drawn 2:1;", "<td>first.nc</td>", "<td>all</td>"})
    EXPECT_NE(sheet.find(text), std::string::npos) << text << "\n" << sheet;
  // The cutter is drawn twice its size: a polygon 12 mm wide.
  EXPECT_NE(sheet.find("class=\"cutter\""), std::string::npos);
  EXPECT_EQ(run_camber(folder, "check first.nc --sheet sheet.html").status, 2);
  ASSERT_EQ(run_camber(folder, "check --job job.toml --sheet again.html").status, 0);
  EXPECT_EQ(file_text(folder / "again.html"), sheet);
}

}  // namespace
}  // namespace camber
