// lobes, fit-modes and the margins of predict as a user has them.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "test_paths.h"
#include "tests/support/csv_columns.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::file_text;
using tests::run_camber;
using tests::TempFolder;

const std::string kChatterSample = CAMBER_SOURCE_DIR "/samples/24-chatter/";

TEST(FitModesCommand, WritesModesThatAJobTakes) {
  const TempFolder folder;
  const auto run =
      run_camber(folder, "fit-modes " + kChatterSample + "tap_x.csv --tool 1 --direction x -o modes.toml " +
                             "--json r.json --plot p.svg");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto report = nlohmann::json::parse(file_text(folder / "r.json"));
  ASSERT_EQ(report["modes"].size(), 2u);
  EXPECT_NEAR(report["modes"][0]["frequency_Hz"].get<double>(), 1180, 0.002 * 1180);
  EXPECT_NEAR(report["modes"][0]["damping_percent"].get<double>(), 2.8, 0.05 * 2.8);
  EXPECT_NEAR(report["modes"][0]["stiffness_N_per_um"].get<double>(), 9.5, 0.03 * 9.5);
  EXPECT_NEAR(report["modes"][1]["frequency_Hz"].get<double>(), 2450, 0.002 * 2450);
  EXPECT_NE(file_text(folder / "p.svg").find("</svg>"), std::string::npos);
  EXPECT_NE(file_text(folder / "modes.toml").find("[[tool.1.mode]]\ndirection = \"x\"\nfrequency_Hz = 1179.97\n"),
            std::string::npos);

  folder.write("machine.toml", "[axis.x]\n[axis.y]\n[axis.z]\n");
  folder.write("job.toml",
               "machine = \"machine.toml\"\n[tool.1]\ntype = \"flat\"\ndiameter_mm = 12\nflutes = 3\n"
               "overhang_mm = 50\n" +
                   file_text(folder / "modes.toml") +
                   "[material]\nktc_MPa = 800\nkrc_MPa = 250\n[stock]\nbox_mm = [[0, 0, -8], [24, 20, 0]]\n");
  const auto lobes = run_camber(folder, "lobes job.toml --radial-mm 4 --rpm 6000:12000:13 --method zero");
  ASSERT_EQ(lobes.status, 0) << lobes.err;
  const auto columns = tests::columns_of(file_text(folder / "lobes.csv"));
  EXPECT_EQ(columns.at("speed_rpm").size(), 13u);
  for (const double depth : columns.at("depth_mm")) EXPECT_GT(depth, 0.1);
}

TEST(FitModesCommand, SaysWhereNothingIsAMode) {
  const TempFolder folder;
  std::string rows = "frequency_Hz,re_m_per_N,im_m_per_N\n";
  for (int i = 1; i <= 200; ++i) rows += std::to_string(i) + "," + std::to_string(std::sin(7.0 * i * i)) + ",0.1\n";
  folder.write("tap.csv", rows);
  const auto run = run_camber(folder, "fit-modes tap.csv -o modes.toml");
  EXPECT_EQ(run.status, 3);
  EXPECT_EQ(run.err,
            "camber: error: tap.csv: no mode stands out of the noise; a band (--band) around the resonances or another "
            "number of modes (--modes) was expected\n");
  EXPECT_EQ(run_camber(folder, "fit-modes tap.csv --band 7").err,
            "--band: 7: FROM:TO in Hz, as in 200:4000, was expected\nRun with --help for more information.\n");
}

TEST(LobesCommand, RefusesWhatItCannotCalculate) {
  const TempFolder folder;
  const std::string job = kChatterSample + "job.toml";
  EXPECT_EQ(run_camber(folder, "lobes " + job + " --radial-mm 4 --rpm 6000:5000:3").err,
            "--rpm: 6000:5000:3: FROM:TO:N, two speeds and how many, as in 4000:12000:81, was expected\n"
            "Run with --help for more information.\n");
  EXPECT_EQ(run_camber(folder, "lobes " + job + " --radial-mm 14 --rpm 6000:9000:3").err,
            "--radial-mm: error: 14: at most the diameter of T1, 12, was expected [value-range]\n");
  EXPECT_EQ(run_camber(folder, "lobes " + job + " --tool 2 --radial-mm 4 --rpm 6000:9000:3").err,
            job + ": error: has no [tool.2] [tool-missing]\n");
}

/// The sample's shoulder: up-milling, 4 mm wide, passes of 2, 1 and 1 mm.
class ChatterPrediction : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    run_ = new tests::CamberRun(run_camber(*folder_, "predict " + kChatterSample + "job.toml -o out"));
  }
  static void TearDownTestSuite() { delete folder_, delete run_; }
  static TempFolder* folder_;
  static tests::CamberRun* run_;
};
TempFolder* ChatterPrediction::folder_ = nullptr;
tests::CamberRun* ChatterPrediction::run_ = nullptr;

TEST_F(ChatterPrediction, HasTheMarginOfTheLobes) {
  ASSERT_EQ(run_->status, 0) << run_->err;
  const auto lobes = run_camber(*folder_, "lobes " + kChatterSample + "job.toml --radial-mm 4 --rpm 9000:9001:2 --up");
  ASSERT_EQ(lobes.status, 0) << lobes.err;
  const double critical = tests::columns_of(file_text(*folder_ / "lobes.csv")).at("depth_mm")[0];
  const auto forces = tests::columns_of(file_text(*folder_ / "out/forces.csv"));
  for (const auto& [line, depth] : {std::pair{8, 2.0}, {12, 1.0}, {16, 1.0}}) {
    int rows = 0;
    for (std::size_t i = 0; i < forces.at("block").size(); ++i) {
      if (forces.at("block")[i] != line || std::abs(forces.at("x_mm")[i] - 12) > 4) continue;
      EXPECT_NEAR(forces.at("chatter_margin")[i], depth / critical, 0.06 * depth / critical);
      ++rows;
    }
    EXPECT_GT(rows, 5);
  }
}

TEST_F(ChatterPrediction, MarksUnstablePassagesAsNotValid) {
  const auto forces = tests::columns_of(file_text(*folder_ / "out/forces.csv"));
  int unstable = 0;
  for (std::size_t i = 0; i < forces.at("block").size(); ++i) {
    if (forces.at("chatter_margin")[i] <= 1) continue;
    ++unstable;
    EXPECT_EQ(forces.at("valid")[i], 0);
    EXPECT_GT(forces.at("chatter_Hz")[i], 1000);
  }
  EXPECT_GT(unstable, 20);
  EXPECT_NE(run_->err.find("[chatter]"), std::string::npos);
}

TEST_F(ChatterPrediction, NamesASpeedAtWhichTheCutIsStable) {
  const auto summary = nlohmann::json::parse(file_text(*folder_ / "out/summary.json"));
  const auto& operation = summary["chatter"]["operations"][0];
  EXPECT_EQ(operation["modes"], "given");
  EXPECT_GT(operation["margin"].get<double>(), 1);
  EXPECT_GT(operation["probability"].get<double>(), 0.5);
  const int stable = operation["stable_speed_rpm"].get<int>();
  ASSERT_GT(stable, 0);
  std::string program = file_text(kChatterSample + "shoulder.nc");
  program = tests::replaced(program, "S9000", "S" + std::to_string(stable));
  folder_->write("shoulder.nc", program);
  std::string job = file_text(kChatterSample + "job.toml");
  folder_->write("job.toml", tests::replaced(job, "../01-finishing", CAMBER_SOURCE_DIR "/samples/01-finishing"));
  const auto run = run_camber(*folder_, "predict job.toml -o cured --json cured.json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err.find("[chatter]"), std::string::npos) << run.err;
  const auto cured = nlohmann::json::parse(file_text(*folder_ / "cured.json"));
  EXPECT_LT(cured["chatter"]["margin"].get<double>(), 0.9);
}

TEST_F(ChatterPrediction, WithAGuessedDampingOnlyTakesNote) {
  std::string job = file_text(kChatterSample + "job.toml");
  const auto from = job.find("[[tool.1.mode]]"), to = job.find("[material]");
  job = tests::replaced(job.substr(0, from) + job.substr(to), "../01-finishing",
                        CAMBER_SOURCE_DIR "/samples/01-finishing");
  folder_->write("shoulder.nc", file_text(kChatterSample + "shoulder.nc"));
  folder_->write("job.toml", job);
  const auto run = run_camber(*folder_, "predict job.toml -o guessed --json guessed.json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err.find("[chatter]"), std::string::npos) << run.err;
  EXPECT_NE(run.out.find("\nchatter: T1 at S9000: "), std::string::npos) << run.out;
  const auto guessed = nlohmann::json::parse(file_text(*folder_ / "guessed.json"));
  EXPECT_EQ(guessed["chatter"]["operations"][0]["modes"], "beam");
}

}  // namespace
}  // namespace camber
