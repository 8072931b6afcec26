// Features of a part in predict and compensate, fit-parts and the test piece.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/run_camber.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::run_camber;
using tests::TempFolder;

/// A pocket of radius 2 mm of the path, cut by a mill of 6 mm in two passes: a bore of 10 mm.
const std::string kProgram =
    "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS6000 M3\nG0 X0 Y0 Z5\nG0 X1.8\nG1 Z-1 F300\nG3 I-1.8 J0\nG1 X2\n"
    "G3 I-2 J0\nG1 X1.5\nG0 Z5\nM30\n";

const std::string kBore = R"([[feature]]
name = "bore"
kind = "bore"
axis_mm = [[0, 0, 0], [0, 0, -1]]
nominal_mm = 10.0
tol_mm = [-0.02, 0.02]
depth_mm = 0.5
)";

void write_job(const TempFolder& folder, const std::string& features, const std::string& name = "job.toml") {
  folder.write("p.nc", kProgram);
  folder.write("machine.toml",
               "[axis.x]\nacceleration_mm_per_s2 = 500\nposition_gain_per_s = 40\n[axis.y]\nacceleration_mm_per_s2 = "
               "500\nposition_gain_per_s = 40\n[axis.z]\nacceleration_mm_per_s2 = 500\n");
  folder.write(name,
               "program = \"p.nc\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"flat\"\ndiameter_mm = 6.0\nflutes = "
               "2\noverhang_mm = 30.0\nhelix_deg = 30\n[material]\nktc_MPa = 800.0\nkrc_MPa = 300.0\n[stock]\nbox_mm = "
               "[[-8, -8, -3], [8, 8, 0]]\n[simulation]\nvoxel_mm = 0.2\nrotation_step_deg = 4\n" +
                   features);
}

TEST(CliFeatures, PredictWritesThemEverywhere) {
  const TempFolder folder;
  write_job(folder, kBore + "measured_mm = [9.99]\n");
  const auto run = run_camber(folder, "predict job.toml -o r");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("note: T1 root_stiffness_N_per_um = 20, flute_length_mm = 18 [typical-value]\n"),
            std::string::npos)
      << run.out;
  EXPECT_NE(run.out.find("\nbore            "), std::string::npos) << run.out;
  const json f = json::parse(tests::file_text(folder / "r/summary.json"))["features"][0];
  EXPECT_EQ(f["feature"], "bore");
  EXPECT_NEAR(f["commanded_mm"].get<double>(), 10, 0.0005);
  EXPECT_NEAR(
      f["predicted_mm"].get<double>(),
      f["commanded_mm"].get<double>() + (f["contour_um"].get<double>() + f["deflection_um"].get<double>()) / 1000,
      1e-9);
  EXPECT_LT(f["contour_um"].get<double>(), -1);  // the axes lag: v^2 / (r K^2) in the radius
  EXPECT_NEAR(f["difference_um"].get<double>(), 1000 * (9.99 - f["predicted_mm"].get<double>()), 1e-6);
  EXPECT_EQ(f["lower_mm"], 9.98);
  const std::string csv = tests::file_text(folder / "r/features.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "feature,kind,nominal_mm,predicted_mm,std_mm,measured_mm,difference_um,form_um,taper_um,lower_mm,upper_mm,"
            "within");
  EXPECT_NE(tests::file_text(folder / "r/report.html").find("Features: deviations"), std::string::npos);
}

TEST(CliFeatures, CompensateBringsThemNearer) {
  const TempFolder folder;
  write_job(folder, kBore + "[compensation]\nmax_rounds = 3\n");
  const auto run = run_camber(folder, "compensate job.toml -o out.nc --keep-anyway --json c.json");
  const json j = json::parse(tests::file_text(folder / "c.json"));
  const double before = j["features_before"][0]["predicted_mm"], after = j["features_after"][0]["predicted_mm"];
  EXPECT_LT(std::abs(after - 10), 0.5 * std::abs(before - 10)) << run.out << run.err;
  EXPECT_NE(tests::file_text(folder / "features.csv").find("\nbore,bore,10.000000,"), std::string::npos);
}

TEST(CliFeatures, ATableOfTheUserIsNotOverwritten) {
  const TempFolder folder;
  write_job(folder, kBore + "measured = \"features.csv\"\n[compensation]\nmax_rounds = 1\n");
  folder.write("features.csv", "feature,value_mm\nbore,9.99\n");
  const auto run = run_camber(folder, "compensate job.toml -o out.nc --keep-anyway");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("features.csv: error: is a table of somebody else; a free name was expected "
                         "[file-unwritable]"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(tests::file_text(folder / "features.csv"), "feature,value_mm\nbore,9.99\n");
}

TEST(CliFitParts, FitsAToolsDiameterAndWritesTheFolder) {
  const TempFolder folder;
  write_job(folder, kBore + "measured_mm = [9.95]\n", "one.toml");
  const auto run = run_camber(folder, "fit-parts one.toml -o fitted --json f.json --suggest");
  ASSERT_EQ(run.status, 0) << run.err;
  const json j = json::parse(tests::file_text(folder / "f.json"));
  EXPECT_EQ(j["parameters"][0]["name"], "tool.1.diameter_mm");
  EXPECT_NEAR(j["residuals"][0]["residual_um"].get<double>(), 0, 0.01);
  for (const auto& p : j["parameters"])
    if (p["name"] == "force_scale") {
      EXPECT_TRUE(p["std_error"].is_null());
      EXPECT_EQ(p["value"], 1);
    }
  for (const char* name : {"machine.toml", "tools.toml", "material.toml", "report.html"})
    EXPECT_FALSE(tests::file_text(folder / (std::string("fitted/") + name)).empty()) << name;
  folder.write("again.toml",
               "program = \"p.nc\"\nmachine = \"fitted/machine.toml\"\ntools = \"fitted/tools.toml\"\n"
               "[tool.1]\nfrom = 1\n[material]\nfile = \"fitted/material.toml\"\n[stock]\nbox_mm = [[-8, "
               "-8, -3], [8, 8, 0]]\n[simulation]\nvoxel_mm = 0.2\nrotation_step_deg = 4\n" +
                   kBore);
  const auto again = run_camber(folder, "predict again.toml -o r");
  ASSERT_EQ(again.status, 0) << again.err;
  const json f = json::parse(tests::file_text(folder / "r/summary.json"))["features"][0];
  EXPECT_NEAR(f["predicted_mm"].get<double>(), 9.95, 0.0005);
}

TEST(CliFitParts, NamesThatNobodyHasAreRefused) {
  const TempFolder folder;
  write_job(folder, kBore + "measured_mm = [9.95]\n", "one.toml");
  const auto run = run_camber(folder, "fit-parts one.toml -o fitted --hold-out two");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err.substr(run.err.find("--hold-out")),
            "--hold-out two: error: no job and no measured part has this name; the name of a job's file without folder "
            "and ending, or of a part, was expected [hold-out]\n");
}

TEST(CliFitParts, TheJobsOwnMachineIsNotOverwritten) {
  const TempFolder folder;
  write_job(folder, kBore + "measured_mm = [9.95]\n", "one.toml");
  const auto run = run_camber(folder, "fit-parts one.toml -o .");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err, "./machine.toml: error: is an input of a job; another folder was expected [output-is-input]\n");
}

TEST(CliProtocol, TestPieceIsAJobThatChecks) {
  const TempFolder folder;
  folder.write("machine.toml", "[axis.x]\nacceleration_mm_per_s2 = 500\n[axis.y]\n[axis.z]\n");
  ASSERT_EQ(run_camber(folder, "protocol --machine machine.toml --part --diameter-mm 8 -o piece").status, 0);
  const auto run = run_camber(folder, "check piece/test_piece.nc --job piece/job.toml --json c.json");
  EXPECT_EQ(run.status, 0) << run.err;
  const json j = json::parse(tests::file_text(folder / "c.json"));
  EXPECT_EQ(j["tools"].size(), 2u);
}

}  // namespace
}  // namespace camber
