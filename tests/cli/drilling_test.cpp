// Drilling cycles in predict and compensate: what they take, what later tools meet, and what is said about them.
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/run_camber.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::run_camber;
using tests::TempFolder;

const std::string kMill = "[tool.1]\ntype = \"flat\"\ndiameter_mm = 4.0\nflutes = 2\noverhang_mm = 12.0\n";
const std::string kDrill =
    "[tool.2]\ntype = \"drill\"\ndiameter_mm = 8.0\npoint_angle_deg = 140\nflutes = 2\noverhang_mm = 60.0\n";
const std::string kTap = "[tool.3]\ntype = \"flat\"\ndiameter_mm = 6.0\nflutes = 3\noverhang_mm = 60.0\n";
const std::string kHead = "G21 G90 G17 G40 G49 G80 G54\n";
const std::string kDrillHead = "T2 M6\nS2000 M3\nG0 X0 Y0 Z20\n";
const std::string kMillHead = "T1 M6\nS3000 M3\n";

void write_job(const TempFolder& folder, const std::string& program, const std::string& tools, const std::string& stock,
               const std::string& simulation = "coupling = \"rigid\"\n", double voxel_mm = 0.2) {
  folder.write("p.nc", program);
  folder.write(
      "machine.toml",
      "[axis.x]\nacceleration_mm_per_s2 = 500\nposition_gain_per_s = 40\n[axis.y]\n[axis.z]\nacceleration_mm_per_s2 = "
      "500\nposition_gain_per_s = 40\n");
  folder.write("job.toml", "program = \"p.nc\"\nmachine = \"machine.toml\"\n" + tools +
                               "[material]\nktc_MPa = 2000.0\nkrc_MPa = 700.0\n[stock]\n" + stock +
                               "\n[simulation]\nvoxel_mm = " + std::to_string(voxel_mm) + "\n" + simulation);
}

json summary(const TempFolder& folder, const std::string& result) {
  return json::parse(tests::file_text(folder / (result + "/summary.json")));
}

/// Cylinder and cone of a D8 140 drill that is fed to `depth` from the face.
double hole_mm3(double depth) {
  const double point = 4 / std::tan(70 * std::acos(-1.0) / 180);
  return std::acos(-1.0) * 16 * (depth - point + point / 3);
}

TEST(DrillingCycles, TakeCylinderAndConeAndTheChipsAgree) {
  const TempFolder folder;
  write_job(folder,
            kHead + kDrillHead + "G99 G81 X6 Y6 Z-6 R1 F240\nG83 X18 Y6 Z-7 R1 Q2\nG73 X30 Y6 Z-14 R1 Q3\nG80\nM30\n",
            kDrill, "box_mm = [[0, 0, -10], [36, 12, 0]]");
  const auto run = run_camber(folder, "predict job.toml -o r");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const double exact = hole_mm3(6) + hole_mm3(7) + std::acos(-1.0) * 160;
  const json j = summary(folder, "r");
  EXPECT_NEAR(j["removed_mm3"]["stock"].get<double>() / exact, 1, 0.005);
  EXPECT_NEAR(j["removed_mm3"]["path"].get<double>() / exact, 1, 0.01);
  EXPECT_EQ(j["holes"]["drilled"], 3);
  EXPECT_EQ(j["holes"]["tapped"], 0);
  EXPECT_EQ(j["holes"]["drilled_mm3"], j["removed_mm3"]["stock"]);
  // kc f D^2 / 8 and kr f D sin(p) / 2 at 0.12 mm a turn.
  EXPECT_NEAR(j["holes"]["torque_Nm"]["max"].get<double>(), 2.0 * 0.12 * 64 / 8, 0.04);
  EXPECT_NEAR(j["holes"]["thrust_N"]["max"].get<double>(), 700 * 0.12 * 8 * std::sin(1.2217) / 2, 6);
  EXPECT_EQ(j["form_error_um"]["area_mm2"], 0.0) << "nothing is milled";
  EXPECT_NE(run.out.find("3 holes drilled: "), std::string::npos) << run.out;
}

/// x and the largest force across the axis of a tool's rows in forces.csv from a line on.
std::vector<std::pair<double, double>> lateral_forces(const TempFolder& folder, const std::string& file,
                                                      std::size_t block) {
  std::istringstream lines(tests::file_text(folder / file));
  std::string line;
  std::getline(lines, line);
  std::vector<std::string> names;
  std::istringstream head(line);
  for (std::string name; std::getline(head, name, ',');) names.push_back(name);
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  std::vector<std::pair<double, double>> out;
  while (std::getline(lines, line)) {
    std::vector<double> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    if (static_cast<std::size_t>(row.at(column("block"))) != block) continue;
    out.emplace_back(row.at(column("x_mm")), std::hypot(row.at(column("fx_max_N")), row.at(column("fy_max_N"))));
  }
  return out;
}

TEST(DrillingCycles, LeaveAirForTheEndMillThatComesAfter) {
  const TempFolder folder;
  write_job(folder,
            kHead + kDrillHead + "G98 G81 X12 Y6 Z-8 R1 F240\nG80\n" + kMillHead +
                "G0 X-4 Y6 Z5\nG0 Z-2\nG1 X28 F900\nG0 Z5\nM30\n",
            kMill + kDrill, "box_mm = [[0, 0, -10], [24, 12, 0]]");
  const auto run = run_camber(folder, "predict job.toml -o r");
  ASSERT_EQ(run.status, 0) << run.err;
  std::size_t in_hole = 0, in_stock = 0;
  for (const auto& [x, force] : lateral_forces(folder, "r/forces.csv", 11)) {
    if (std::abs(x - 12) < 1.5) {
      EXPECT_LT(force, 1e-9) << x;
      ++in_hole;
    } else if (std::abs(x - 12) > 7 && x > 3 && x < 21) {
      EXPECT_GT(force, 50) << x;
      ++in_stock;
    }
  }
  EXPECT_GT(in_hole, 5u);
  EXPECT_GT(in_stock, 10u);
  // Slot and hole less what both would take: the hole's cylinder where the slot is, a strip of width 4 of a circle of
  // radius 4.
  const double strip = 2 * (2 * std::sqrt(12.0) + 16 * std::asin(0.5)), exact = hole_mm3(8) + 2 * (24 * 4 - strip);
  EXPECT_NEAR(summary(folder, "r")["removed_mm3"]["stock"].get<double>() / exact, 1, 0.005);
}

TEST(DrillingCycles, DoNotTouchTheFormErrorOfTheMilledSurface) {
  const TempFolder folder;
  const std::string stock = "box_mm = [[0, 0, -6], [24, 12, 0]]";
  const std::string mill = kMillHead + "G0 X-4 Y-1.5 Z5\nG0 Z-3\nG1 X28 F600\nG0 Z5\n";
  write_job(folder, kHead + mill + "M30\n", kMill, stock);
  ASSERT_EQ(run_camber(folder, "predict job.toml -o plain").status, 0);
  write_job(folder, kHead + kDrillHead + "G81 X12 Y7 Z-8 R1 F240\nG80\n" + mill + "M30\n", kMill + kDrill, stock);
  ASSERT_EQ(run_camber(folder, "predict job.toml -o drilled").status, 0);
  const json plain = summary(folder, "plain"), drilled = summary(folder, "drilled");
  constexpr double kRounding_um = 1e-5;  // of marks, which are made in single precision
  for (const char* figure : {"min", "max", "mean", "rms", "p95", "area_mm2"})
    EXPECT_NEAR(drilled["form_error_um"][figure].get<double>(), plain["form_error_um"][figure].get<double>(),
                kRounding_um)
        << figure;
  EXPECT_NEAR(drilled["holes"]["not_judged_mm2"].get<double>() / (std::acos(-1.0) * 8 * 6), 0.93, 0.05)
      << "less a voxel at both rims";
  // Drilled through the milled floor afterwards: the floor around it keeps its error.
  write_job(folder, kHead + mill + kDrillHead + "G81 X12 Y0 Z-9 R1 F240\nG80\nM30\n", kMill + kDrill, stock);
  ASSERT_EQ(run_camber(folder, "predict job.toml -o through").status, 0);
  const json through = summary(folder, "through");
  EXPECT_LT(through["form_error_um"]["area_mm2"].get<double>(),
            0.95 * plain["form_error_um"]["area_mm2"].get<double>());
  EXPECT_NEAR(through["form_error_um"]["max"].get<double>(), plain["form_error_um"]["max"].get<double>(), 0.5);
  EXPECT_NEAR(through["form_error_um"]["min"].get<double>(), plain["form_error_um"]["min"].get<double>(), 0.5);
}

TEST(DrillingCycles, TappingIsCarvedWithoutChipsAndTheBalanceStays) {
  const TempFolder folder;
  write_job(folder,
            kHead +
                "T2 M6\nS2000 M3\nG0 X0 Y0 Z20\nG98 G81 X6 Y6 Z-8 R1 F240\nG80\nT3 M6\nS300 M3\nG0 X0 Y0 Z20\n"
                "G98 G84 X18 Y6 Z-5 R2 F300\nG80\nM30\n",
            kDrill + kTap, "box_mm = [[0, 0, -10], [24, 12, 0]]");
  const auto run = run_camber(folder, "predict job.toml -o r");
  ASSERT_EQ(run.status, 0) << run.err;
  const json j = summary(folder, "r");
  EXPECT_EQ(j["holes"]["tapped"], 1);
  EXPECT_NEAR(j["holes"]["tapped_mm3"].get<double>() / (std::acos(-1.0) * 9 * 5), 1, 0.006);
  EXPECT_NEAR(j["removed_mm3"]["stock"].get<double>() / hole_mm3(8), 1, 0.005);
  EXPECT_NEAR(j["removed_mm3"]["path"].get<double>() / j["removed_mm3"]["stock"].get<double>(), 1, 0.01);
  EXPECT_TRUE(lateral_forces(folder, "r/forces.csv", 10).empty()) << "no rows of the tap";
  EXPECT_FALSE(lateral_forces(folder, "r/forces.csv", 5).empty());
}

TEST(DrillingCycles, AMissingDrillIsSaidWhereItDrills) {
  const TempFolder folder;
  write_job(folder, kHead + kDrillHead + "G98 G81 X6 Y6 Z-8 R1 F240\nG80\nM30\n", kMill,
            "box_mm = [[0, 0, -10], [24, 12, 0]]");
  const auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "p.nc:5:1: error: T2 drills here (G81), but the job has no [tool.2]; its type, diameter_mm, flutes and "
            "overhang_mm, or operations without it, were expected [tool-missing]\n"
            "    G98 G81 X6 Y6 Z-8 R1 F240\n"
            "    ^\n");
}

TEST(DrillingCycles, ADrillStillMustNotMill) {
  const TempFolder folder;
  write_job(folder, kHead + kDrillHead + "G1 Z-2 F240\nG1 X9\nG0 Z5\nM30\n", kDrill,
            "box_mm = [[0, 0, -10], [24, 12, 0]]");
  const auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("p.nc:6:1: error: T2 is a drill in the job, but mills here"), std::string::npos) << run.err;
}

TEST(DrillingCycles, BackBoringStaysInTheStockWithAWarning) {
  const TempFolder folder;
  write_job(folder, kHead + kDrillHead + "G98 G81 X6 Y6 Z-12 R1 F240\nG87 X6 Y6 Z-5 R-12 Q1\nG80\nM30\n", kDrill,
            "box_mm = [[0, 0, -10], [24, 12, 0]]");
  const auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err,
            "p.nc:6:1: warning: the holes of G87 are not carved; a cycle that feeds straight down along Z was expected "
            "[cycle-not-carved]\n"
            "    G87 X6 Y6 Z-5 R-12 Q1\n"
            "    ^\n");
  EXPECT_NEAR(summary(folder, "r")["removed_mm3"]["stock"].get<double>() / (std::acos(-1.0) * 160), 1, 0.005);
}

TEST(DrillingCollisions, TheRapidsInsideAHoleAreFree) {
  const TempFolder folder;
  // Deeper than the flutes, whose shank is as thick as they are; pecks by both cycles, boring with a shift, tapping.
  write_job(folder,
            kHead + kDrillHead +
                "G98 G83 X6 Y6 Z-18 R1 Q3 F240\nG73 X18 Y6 Z-18 R1 Q3\nG76 X30 Y6 Z-8 R1 Q0.6\nG85 X42 Y6 Z-8 R1\nG80\n"
                "T3 M6\nS300 M3\nG0 X0 Y0 Z20\nG98 G84 X30 Y6 Z-9 R2 F300\nG80\nM30\n",
            kDrill + "flute_length_mm = 10\n" + kTap, "box_mm = [[0, 0, -20], [48, 12, 0]]");
  const auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
}

TEST(DrillingCollisions, ARetractLevelInTheStockIsARapidThroughMaterial) {
  const TempFolder folder;
  write_job(folder, kHead + kDrillHead + "G98 G81 X6 Y6 Z-8 R-3 F240\nG80\nM30\n", kDrill,
            "box_mm = [[0, 0, -10], [24, 12, 0]]");
  const auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("p.nc:5:1: error: rapid through material: the cutter of T2 in stock at X"), std::string::npos)
      << run.err;
}

TEST(DrillingCollisions, AThickerShankMeetsTheHolesRim) {
  const TempFolder folder;
  write_job(folder, kHead + kDrillHead + "G98 G83 X6 Y6 Z-9 R1 Q3 F240\nG80\nM30\n",
            kDrill + "flute_length_mm = 6\nshank_diameter_mm = 10\n", "box_mm = [[0, 0, -10], [24, 12, 0]]");
  const auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("p.nc:5:1: error: the shank of T2 in stock at X"), std::string::npos) << run.err;
}

TEST(DrillingCollisions, AHoleThatIsCarvedLetsALaterRapidThrough) {
  const TempFolder folder;
  const std::string after = kMillHead + "G0 X6 Y6 Z5\nG0 Z-4\nG1 X20 F900\nG0 Z5\nM30\n";
  write_job(folder, kHead + kDrillHead + "G98 G81 X6 Y6 Z-8 R1 F240\nG80\n" + after, kMill + kDrill,
            "box_mm = [[0, 0, -10], [24, 12, 0]]");
  auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  write_job(folder, kHead + after, kMill + kDrill, "box_mm = [[0, 0, -10], [24, 12, 0]]");
  run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 1) << "without the hole";
  EXPECT_NE(run.err.find("p.nc:5:1: error: rapid through material: the cutter of T1"), std::string::npos) << run.err;
}

TEST(DrillingCompensation, MovesTheWallAndLeavesTheCyclesAsTheyStand) {
  const TempFolder folder;
  const std::string cycles = kDrillHead + "G98 G83 X12 Y6 Z-8 R1 Q3 F240\nX20\nG80\n";
  write_job(folder, kHead + cycles + kMillHead + "G0 X-4 Y-1.5 Z5\nG0 Z-3\nG1 X28 F600\nG0 Z5\nM30\n",
            tests::replaced(kMill, "12.0", "20.0") + kDrill, "box_mm = [[0, 0, -6], [24, 12, 0]]",
            "coupling = \"rigid\"\n[compensation]\nlevers = [\"shift\"]\ntolerance_um = 0.5\nmax_overcut_um = 10\n");
  const auto run = run_camber(folder, "compensate job.toml -o c.nc --json c.json");
  ASSERT_TRUE(run.status == 0 || run.status == 3) << run.err;
  const std::string text = tests::file_text(folder / "c.nc");
  EXPECT_EQ(text.substr(0, kHead.size() + cycles.size()), kHead + cycles);
  const json c = json::parse(tests::file_text(folder / "c.json"));
  EXPECT_LT(c["after_um"]["rms"].get<double>(), 0.9 * c["before_um"]["rms"].get<double>());
  ASSERT_EQ(c["operations"].size(), 1u) << "the drill is no operation of the surface";
}

}  // namespace
}  // namespace camber
