// predict --trace: at the positions that a servo trace measured, beside the feed model.
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/run_camber.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::run_camber;
using tests::TempFolder;

/// A groove with a corner; the machine lags.
void write_job(const TempFolder& folder) {
  folder.write("p.nc",
               "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS6000 M3\nG0 X-4. Y2. Z3.\nG1 Z-0.3 F600\nG1 X6. F1200\nG1 Y8.\n"
               "G1 X14.\nG0 Z3.\nM30\n");
  folder.write(
      "machine.toml",
      "[control]\nperiod_ms = 1.0\n[axis.x]\nacceleration_mm_per_s2 = 500\nposition_gain_per_s = 40\n[axis.y]\n"
      "acceleration_mm_per_s2 = 400\nposition_gain_per_s = 50\n[axis.z]\nacceleration_mm_per_s2 = "
      "400\nposition_gain_per_s = 50\n");
  folder.write("job.toml", R"(program = "p.nc"
machine = "machine.toml"
[tool.1]
type = "ball"
diameter_mm = 4.0
flutes = 2
overhang_mm = 25.0
[material]
ktc_MPa = 800.0
krc_MPa = 300.0
[stock]
box_mm = [[0, 0, -1], [10, 10, 0]]
[simulation]
voxel_mm = 0.1
)");
}

/// feed.csv of a prediction as the trace of a machine whose Z stands `z_mm` higher.
void write_trace(const TempFolder& folder, const std::string& feed_csv, const std::string& name, double z_mm,
                 bool with_line) {
  std::istringstream rows(tests::file_text(folder / feed_csv));
  std::string row, out = std::string("t_s,x_act_mm,y_act_mm,z_act_mm") + (with_line ? ",line\n" : "\n");
  std::getline(rows, row);
  while (std::getline(rows, row)) {
    std::vector<std::string> cells;
    std::istringstream of_row(row);
    for (std::string cell; std::getline(of_row, cell, ',');) cells.push_back(cell);
    out += cells[0] + "," + cells[2] + "," + cells[3] + "," + std::to_string(std::stod(cells[4]) + z_mm);
    out += with_line ? "," + cells[1] + "\n" : "\n";
  }
  folder.write(name, out);
}

json figures_of(const TempFolder& folder, const std::string& name) {
  return json::parse(tests::file_text(folder / name));
}

TEST(Traced, OwnMotionAsATraceGivesTheSameMap) {
  const TempFolder folder;
  write_job(folder);
  ASSERT_EQ(run_camber(folder, "predict job.toml -o model").status, 0);
  for (const bool with_line : {true, false}) {
    write_trace(folder, "model/feed.csv", "t.csv", 0, with_line);
    const auto run = run_camber(folder, "predict job.toml -o traced --trace t.csv --json t.json");
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_NE(run.out.find("feed model"), std::string::npos) << run.out;
    const json f = figures_of(folder, "t.json"), model = figures_of(folder, "model/summary.json");
    EXPECT_EQ(f["trace"]["matched_by"], with_line ? "line" : "place");
    EXPECT_EQ(f["trace"]["model"]["form_error_um"]["p95"], model["form_error_um"]["p95"]);
    // feed.csv is rounded to 0.01 um; where tooth passings begin by a sample earlier, chips differ by a few nanometres.
    EXPECT_LT(f["trace"]["difference_um"]["p95"], 0.1);
    EXPECT_GT(f["trace"]["off_path_um"]["max"], 1.0);  // it rounds the corner
    EXPECT_NEAR(f["machine_time_s"], model["machine_time_s"], 0.15);
    EXPECT_EQ(tests::file_text(folder / "t.json"), tests::file_text(folder / "traced/summary.json"));
  }
}

/// A machine that stands 5 um too high leaves 5 um on the groove's floor: that is no bending.
TEST(Traced, ADisplacedTraceShowsAsMuchOnTheFloor) {
  constexpr double kHigh_um = 5;
  const TempFolder folder;
  write_job(folder);
  ASSERT_EQ(run_camber(folder, "predict job.toml -o model").status, 0);
  write_trace(folder, "model/feed.csv", "t.csv", kHigh_um / 1000, true);
  ASSERT_EQ(run_camber(folder, "predict job.toml -o traced --trace t.csv").status, 0);
  std::istringstream rows(tests::file_text(folder / "traced/form_error.csv"));
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row,
            "x_mm,y_mm,z_mm,nx,ny,nz,error_um,deflection_um,contour_um,total_error_um,area_mm2,block,tool,valid,"
            "model_error_um,difference_um");
  std::size_t level = 0;
  while (std::getline(rows, row)) {
    std::vector<std::string> cells;
    std::istringstream of_row(row);
    for (std::string cell; std::getline(of_row, cell, ',');) cells.push_back(cell);
    if (std::stod(cells[5]) < 0.999 || std::stod(cells[0]) < 1 || std::stod(cells[0]) > 5) continue;
    ++level;
    EXPECT_NEAR(std::stod(cells[15]), kHigh_um, 0.25) << row;
  }
  EXPECT_GT(level, 20u);
  const std::string page = tests::file_text(folder / "traced/report.html");
  for (const char* words : {"Feed model and trace", "\"names\":[\"feed model\",\"trace\"]", "where a trace measured"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
}

TEST(Traced, RefusesWhatIsNoTraceOfTheCut) {
  const TempFolder folder;
  write_job(folder);
  ASSERT_EQ(run_camber(folder, "predict job.toml -o model").status, 0);
  write_trace(folder, "model/feed.csv", "t.csv", 2.5, false);
  auto run = run_camber(folder, "predict job.toml -o traced --trace t.csv");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("[trace-"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "traced"));

  folder.write("t.csv", "t_s,x_act_mm,y_act_mm\n0,0,0\n0.001,0,0\n");
  run = run_camber(folder, "predict job.toml -o traced --trace t.csv");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "t.csv: error: the trace has no z_act_mm; x_act_mm, y_act_mm and z_act_mm, where the axes were, are "
            "expected [trace-column]\n");

  folder.write("t.csv", "t_s,x_act_mm,y_act_mm,z_act_mm\n0,0,0,0\n0.001,0,0,0\n0.0005,0,0,0\n");
  run = run_camber(folder, "predict job.toml -o traced --trace t.csv");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("t.csv:4:1: error: time 0.0005 s is not after the sample before it, 0.001 s [trace-time]"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(run_camber(folder, "predict job.toml -o traced --columns map.toml").status, 2);
}

}  // namespace
}  // namespace camber
