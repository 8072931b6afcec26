// predict as a user runs it: its files, and the same bytes whatever the number of threads.
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::run_camber;
using tests::TempFolder;

void write_job(const TempFolder& folder) {
  std::string program = "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\n";
  for (const char* y : {"0.5", "0.8", "1.1"})
    program += std::string("G0 X4. Y") + y + " Z3.\nG1 Z-0.3 F300\nX-1. F900\nG0 Z3.\n";
  folder.write("p.nc", program + "M30\n");
  folder.write("machine.toml", "[axis.x]\nacceleration_mm_per_s2 = 500\n");
  folder.write("job.toml", R"(program = "p.nc"
machine = "machine.toml"
[tool.1]
type = "ball"
diameter_mm = 6.0
flutes = 2
overhang_mm = 30.0
[material]
ktc_MPa = 2000.0
krc_MPa = 700.0
[stock]
box_mm = [[0, 0, -1], [3, 2, 0]]
[simulation]
voxel_mm = 0.2
)");
}

TEST(Predict, WritesEveryFileThatIsPromised) {
  const TempFolder folder;
  write_job(folder);
  const auto run = run_camber(folder, "predict job.toml -o result --json figures.json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  for (const char* name : {"feed.csv", "forces.csv", "form_error.csv", "form_error.vtp", "form_error.ply", "stock.vdb",
                           "report.html", "summary.json"})
    EXPECT_GT(std::filesystem::file_size(folder / ("result/" + std::string(name))), 0u) << name;
  EXPECT_EQ(tests::file_text(folder / "figures.json"), tests::file_text(folder / "result/summary.json"));
  const auto figures = nlohmann::json::parse(tests::file_text(folder / "figures.json"));
  for (const char* key : {"machine_time_s", "compute_s"}) EXPECT_TRUE(figures[key].is_number()) << key;
  EXPECT_TRUE(figures["force_N"]["max"].is_number());
  for (const char* key : {"path", "stock"}) EXPECT_TRUE(figures["removed_mm3"][key].is_number()) << key;
  for (const char* key : {"min", "max", "mean", "rms", "p95"})
    EXPECT_TRUE(figures["form_error_um"][key].is_number()) << key;
}

TEST(Predict, GivesTheSameBytesOnOneAndTwoThreads) {
  const TempFolder folder;
  write_job(folder);
  ASSERT_EQ(run_camber(folder, "--threads 1 predict job.toml -o one").status, 0);
  ASSERT_EQ(run_camber(folder, "--threads 2 predict job.toml -o two").status, 0);
  for (const std::string name :
       {"feed.csv", "forces.csv", "form_error.csv", "form_error.vtp", "form_error.ply", "stock.vdb", "report.html"})
    EXPECT_EQ(tests::file_text(folder / ("one/" + name)), tests::file_text(folder / ("two/" + name))) << name;
}

TEST(Predict, IsSilentWithQuiet) {
  const TempFolder folder;
  write_job(folder);
  const auto run = run_camber(folder, "-q predict job.toml -o result");
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.out + run.err, "");
}

}  // namespace
}  // namespace camber
