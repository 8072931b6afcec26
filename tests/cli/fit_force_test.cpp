// fit-force and predict --forces-at as a user runs them.
#include <cmath>
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "test_paths.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::file_text;
using tests::run_camber;
using tests::TempFolder;

const std::string kSample = CAMBER_SOURCE_DIR "/samples/03-force-fit/";

TEST(FitForceCommand, WritesAMaterialThatAJobTakes) {
  const TempFolder folder;
  const auto run = run_camber(
      folder, "fit-force --log " + kSample + "means.csv --job " + kSample + "job.toml -o material.toml --json r.json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const auto report = nlohmann::json::parse(file_text(folder / "r.json"));
  EXPECT_EQ(report["parameters"].size(), 6u);
  EXPECT_EQ(report["parameters"][0]["name"], "ktc_MPa");
  EXPECT_NEAR(report["parameters"][0]["value"].get<double>(), 958.9, 0.005 * 958.9);
  EXPECT_GT(report["parameters"][0]["std_error"].get<double>(), 0);
  EXPECT_GT(report["held_out"]["rms_N"].get<double>(), 0);

  folder.write("p.nc", "G21 G90 G54\nT1 M6\nS3000 M3\nG0 X4. Y0.5 Z3.\nG1 Z-0.3 F300\nX-1. F900\nG0 Z3.\nM30\n");
  folder.write("machine.toml", "[axis.x]\nacceleration_mm_per_s2 = 500\n[axis.y]\n[axis.z]\n");
  folder.write("job.toml", R"(program = "p.nc"
machine = "machine.toml"
[tool.1]
type = "ball"
diameter_mm = 6.0
flutes = 2
overhang_mm = 30.0
[material]
file = "material.toml"
[stock]
box_mm = [[0, 0, -1], [3, 2, 0]]
[simulation]
voxel_mm = 0.2
)");
  const auto predict = run_camber(folder, "-q predict job.toml -o result --forces-at 6");
  ASSERT_EQ(predict.status, 0) << predict.err;
  std::istringstream rows(file_text(folder / "result/forces_at_6.csv"));
  std::string line;
  std::getline(rows, line);
  EXPECT_EQ(line, "angle_deg,fx_1_N,fy_1_N,fz_1_N,h_max_1_mm,fx_2_N,fy_2_N,fz_2_N,h_max_2_mm,fx_N,fy_N,fz_N,torque_Nm");
  int count = 0;
  double largest = 0;
  while (std::getline(rows, line)) {
    std::vector<double> v;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) v.push_back(std::stod(field));
    ASSERT_EQ(v.size(), 13u);
    EXPECT_EQ(v[0], count++);
    EXPECT_NEAR(v[9], v[1] + v[5], 2e-4);
    largest = std::max(largest, std::hypot(v[9], v[10]));
  }
  EXPECT_EQ(count, 360);
  EXPECT_GT(largest, 1);
  const auto figures = nlohmann::json::parse(file_text(folder / "result/summary.json"));
  EXPECT_LE(largest, 1.001 * figures["force_N"]["max"].get<double>());
  EXPECT_GT(figures["torque_Nm"]["max"].get<double>(), 0);
  EXPECT_GT(figures["power_W"]["max"].get<double>(), figures["power_W"]["mean"].get<double>());
  EXPECT_GT(figures["specific_energy_MPa"].get<double>(), 958);
  EXPECT_NEAR(figures["chip_thickness_mm"]["max"].get<double>(), 0.06, 0.06);

  const auto wrong = run_camber(folder, "-q predict job.toml -o other --forces-at 1");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_EQ(tests::replaced(wrong.err, folder.path() + "/", ""),
            "p.nc:1:1: error: --forces-at 1: line 1 cuts nothing; a line that the job's operations cut was expected "
            "[forces-at]\n"
            "    G21 G90 G54\n"
            "    ^\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "other"));
}

TEST(FitForceCommand, RefusesWhatTheCutsCannotTellAndWritesNothing) {
  const TempFolder folder;
  folder.write("log.csv", "feed_mm_per_min,Fx_N,Fy_N,Fz_N\n300,63.0,-39.8,55.7\n");
  const auto run = run_camber(folder, "fit-force --log log.csv --job " + kSample + "job.toml -o material.toml");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "log.csv: error: the cuts do not determine ktc_MPa and kte_N_per_mm and krc_MPa and kre_N_per_mm and "
            "kac_MPa and kae_N_per_mm: all cuts have one feed per tooth, 0.025 mm; cuts at different feeds were "
            "expected (hold = [\"ktc_MPa\", \"kte_N_per_mm\", \"krc_MPa\", \"kre_N_per_mm\", \"kac_MPa\", "
            "\"kae_N_per_mm\"] in [force_log] keeps the values of [material]) [not-identifiable]\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "material.toml"));
}

TEST(FitForceCommand, WantsAJobForEachLogOrOneForAll) {
  const TempFolder folder;
  const auto run = run_camber(folder, "fit-force --log a --log b --log c --job d --job e -o m.toml");
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("3 logs and 2 jobs; one job for all or one for each was expected"), std::string::npos);
}

}  // namespace
}  // namespace camber
