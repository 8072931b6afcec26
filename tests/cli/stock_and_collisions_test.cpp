// Blanks of every kind, one job's stock as the next one's blank, several tools, and collisions, as a user meets them.
#include <cmath>
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/triangle_mesh.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::run_camber;
using tests::TempFolder;

const std::string kFlat = "[tool.1]\ntype = \"flat\"\ndiameter_mm = 4.0\nflutes = 2\noverhang_mm = 30.0\n";

void write_job(const TempFolder& folder, const std::string& program, const std::string& tools, const std::string& stock,
               const std::string& simulation = "") {
  folder.write("p.nc", program);
  folder.write("machine.toml", "[axis.x]\nacceleration_mm_per_s2 = 500\n[axis.y]\n[axis.z]\n");
  folder.write("job.toml", "program = \"p.nc\"\nmachine = \"machine.toml\"\n" + tools +
                               "[material]\nktc_MPa = 20.0\nkrc_MPa = 7.0\n[stock]\n" + stock +
                               "\n[simulation]\nvoxel_mm = 0.2\ncoupling = \"rigid\"\n" + simulation);
}

double removed_mm3(const TempFolder& folder, const std::string& result) {
  return nlohmann::json::parse(tests::file_text(folder / (result + "/summary.json")))["removed_mm3"]["stock"];
}

const std::string kHead = "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\n";
/// A slot of 2 mm along X through a block from x = 0 to 8.
const std::string kSlot = kHead + "G0 X-4 Y0 Z5\nG0 Z-2\nG1 X12 F900\nG0 Z5\nM30\n";

TEST(StockOfAJob, CylinderLosesASlot) {
  const TempFolder folder;
  write_job(folder, kHead + "G0 X-10 Y0 Z5\nG0 Z-2\nG1 X10 F900\nG0 Z5\nM30\n", kFlat,
            "cylinder = { base_mm = [0, 0, -5], diameter_mm = 12, height_mm = 5 }");
  const auto run = run_camber(folder, "predict job.toml -o r");
  ASSERT_EQ(run.status, 0) << run.err;
  // A strip of width 4 through a circle of radius 6, 2 mm deep.
  const double strip = 2 * (2 * std::sqrt(32.0) + 36 * std::asin(2.0 / 6));
  EXPECT_NEAR(removed_mm3(folder, "r") / (2 * strip), 1, 0.006);
}

TEST(StockOfAJob, WhatOneJobLeavesIsTheNextOnesBlank) {
  const TempFolder folder;
  write_job(folder, kSlot, kFlat, "box_mm = [[0, -5, -5], [8, 5, 0]]");
  auto run = run_camber(folder, "predict job.toml -o r");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NEAR(removed_mm3(folder, "r"), 64, 0.4);
  // The same slot again takes nothing; a millimetre deeper takes half as much.
  write_job(folder, kHead + "G0 X-4 Y0 Z5\nG0 Z-2\nG1 X12 F900\nZ-3\nX-4\nG0 Z5\nM30\n", kFlat,
            "vdb = \"r/stock.vdb\"");
  run = run_camber(folder, "predict job.toml -o s");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NEAR(removed_mm3(folder, "s"), 32, 0.4);
}

/// By the tetrahedra that its triangles make with the origin; less than 0 where they show inwards.
double volume_mm3(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t i) { return Vec3(mesh.points[t[i]].cast<double>()); };
    sum += corner(0).dot(corner(1).cross(corner(2))) / 6;
  }
  return sum;
}

TEST(StockOfAJob, IsWrittenAsAMeshForPictures) {
  const TempFolder folder;
  const std::string cylinder = "cylinder = { base_mm = [5, 2, -5], diameter_mm = 12, height_mm = 5 }";
  write_job(folder, kSlot, kFlat, cylinder);
  ASSERT_EQ(run_camber(folder, "check --job job.toml --meshes c").status, 0);
  const TriangleMesh round = read_stl(folder / "c-blank.stl");
  EXPECT_TRUE(round.closed());
  EXPECT_NEAR(volume_mm3(round) / (kPi * 36 * 5), 1, 0.01);
  for (const auto& p : round.points) EXPECT_LT(std::hypot(p.x() - 5, p.y() - 2), 6.001);

  write_job(folder, kSlot, kFlat, "box_mm = [[0, -5, -5], [8, 5, 0]]");
  ASSERT_EQ(run_camber(folder, "predict job.toml -o r").status, 0);
  ASSERT_EQ(run_camber(folder, "check --job job.toml --meshes b").status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "b-blank.stl")) << "whoever reads the job sees the box";
  // The same slot a millimetre deeper, in what is left: 8 x 10 x 5 less 64.
  write_job(folder, kHead + "G0 X-4 Y0 Z5\nG0 Z-3\nG1 X12 F900\nG0 Z5\nM30\n", kFlat, "vdb = \"r/stock.vdb\"");
  const auto run = run_camber(folder, "check --job job.toml --meshes v");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NEAR(volume_mm3(read_stl(folder / "v-blank.stl")), 400 - 64, 4);

  write_job(folder, kSlot, kFlat, "mesh = \"c-blank.stl\"\n[part]\nmesh = \"c-blank.stl\"\nmove_mm = [0, 0, -2]");
  run_camber(folder, "check --job job.toml --meshes m");
  EXPECT_EQ(tests::file_text(folder / "m-blank.stl"), tests::file_text(folder / "c-blank.stl"));
  const TriangleMesh part = read_stl(folder / "m-part.stl");
  ASSERT_EQ(part.points.size(), round.points.size());
  for (std::size_t i = 0; i < part.points.size(); ++i)
    EXPECT_LT((part.points[i] - round.points[i] - Eigen::Vector3f(0, 0, -2)).norm(), 1e-6F);
}

TEST(StockOfAJob, RefusesAFileThatIsNoVdb) {
  const TempFolder folder;
  folder.write("x.vdb", "not a grid");
  write_job(folder, kSlot, kFlat, "vdb = \"x.vdb\"");
  const auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("x.vdb: error: cannot be read as .vdb"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("[vdb-format]"), std::string::npos) << run.err;
}

TEST(SeveralTools, EachCutsWithItsOwnShapeAndSignsItsPoints) {
  const TempFolder folder;
  const std::string program = kHead +
                              "G0 X-4 Y0 Z5\nG0 Z-2\nG1 X12 F900\nG0 Z5\nT2 M6\nS3000 M3\nG0 X-4 Y5 Z5\nG0 Z-1\n"
                              "G1 X12 F900\nG0 Z5\nM30\n";
  write_job(
      folder, program,
      kFlat + "[tool.2]\ntype = \"chamfer\"\ndiameter_mm = 6\npoint_angle_deg = 90\nflutes = 2\noverhang_mm = 30\n",
      "box_mm = [[0, -5, -5], [8, 10, 0]]");
  const auto run = run_camber(folder, "predict job.toml -o r");
  ASSERT_EQ(run.status, 0) << run.err;
  // 4 mm wide, 2 deep; and a V of 90 degrees, 1 deep.
  EXPECT_NEAR(removed_mm3(folder, "r"), 64 + 8, 0.5);
  const std::string csv = tests::file_text(folder / "r/form_error.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "x_mm,y_mm,z_mm,nx,ny,nz,error_um,deflection_um,contour_um,total_error_um,area_mm2,block,tool,valid");
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  std::size_t of_slot = 0, of_groove = 0;
  while (std::getline(lines, line)) {
    const std::string known = line.substr(0, line.find_last_of(','));
    const std::string maker = known.substr(known.find_last_of(',', known.find_last_of(',') - 1) + 1);
    if (maker == "6,1")
      ++of_slot;
    else if (maker == "12,2")
      ++of_groove;
    else
      FAIL() << line;
    const double y = std::stod(line.substr(line.find(',') + 1));
    EXPECT_EQ(maker == "12,2", y > 3) << line;
  }
  EXPECT_GT(of_slot, 1000u);
  EXPECT_GT(of_groove, 300u);
}

TEST(Collisions, RapidThroughMaterialIsAnErrorWithBlockAndTime) {
  const TempFolder folder;
  write_job(folder, kHead + "G0 X-4 Y0 Z5\nG0 Z-2\nG1 X12 F900\nG0 Y4\nG0 X-4\nG0 Z5\nM30\n", kFlat,
            "box_mm = [[0, -8, -5], [8, 8, 0]]");
  auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("p.nc:8:1: error: rapid through material: the cutter of T1 in stock at X"), std::string::npos)
      << run.err;
  EXPECT_NE(run.err.find("s into the program; a rapid clear of the stock was expected [collision-rapid]"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(run.err.find("p.nc:7"), std::string::npos) << "beside the block a rapid is free: " << run.err;
  write_job(folder, tests::file_text(folder / "p.nc"), kFlat, "box_mm = [[0, -8, -5], [8, 8, 0]]",
            "collisions = \"off\"\n");
  run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 0) << run.err;
  write_job(folder, tests::file_text(folder / "p.nc"), kFlat, "box_mm = [[0, -8, -5], [8, 8, 0]]",
            "collisions = \"warning\"\n");
  run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 0);
  EXPECT_NE(run.err.find("p.nc:8:1: warning: rapid through material"), std::string::npos) << run.err;
}

TEST(Collisions, ThatThePathHasAreNotCompensatedOver) {
  const TempFolder folder;
  write_job(folder, kHead + "G0 X-4 Y0 Z5\nG0 Z-2\nG1 X12 F900\nG0 Y4\nG0 X-4\nG0 Z5\nM30\n", kFlat,
            "box_mm = [[0, -8, -5], [8, 8, 0]]");
  const auto run = run_camber(folder, "compensate job.toml -o moved.nc");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("p.nc:8:1: error: rapid through material: the cutter of T1 in stock at X"), std::string::npos)
      << run.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "moved.nc"));
}

TEST(Collisions, RapidBackThroughTheSlotJustCutIsFree) {
  const TempFolder folder;
  write_job(folder, kHead + "G0 X-4 Y0 Z5\nG0 Z-2\nG1 X12 F900\nG0 X-4\nG0 Z5\nM30\n", kFlat,
            "box_mm = [[0, -8, -5], [8, 8, 0]]");
  const auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
}

/// A block from the origin to X20 Y20, and a machine that bends rapids or not.
struct DogLeg {
  std::string away;  ///< the rapid, from X-6 Y2 at depth, or to there
  bool hits_bent, hits_straight;
};

TEST(Collisions, RapidsFollowTheWayOfTheControl) {
  const std::string to_depth = "G0 Z-2\nG1 X3 F900\nX-6\n";
  // Away: 45 degrees first, through the block; its straight line passes the corner at X0 Y20 by 2.35 mm (cutter: 2 mm).
  // Back: the straight line enters the block at Y20, the dog-leg comes down at X-6.
  for (const auto& [away, bent, straight] :
       {DogLeg{"G0 X-6 Y2 Z5\n" + to_depth + "G0 X14 Y102\nG0 Z5\n", true, false},
        DogLeg{"G0 X-6 Y2 Z5\n" + to_depth + "G0 Y102\nX54\nG0 X-6 Y2\nG0 Z5\n", false, true}}) {
    for (const std::string path : {"dogleg", "linear"}) {
      const TempFolder folder;
      write_job(folder, kHead + away + "M30\n", kFlat, "box_mm = [[0, 0, -5], [20, 20, 0]]");
      std::string machine = "[cycle]\nrapid_path = \"" + path + "\"\n";
      for (const char* axis : {"x", "y", "z"})
        machine += std::string("[axis.") + axis + "]\nmax_velocity_mm_per_min = 20000\nacceleration_mm_per_s2 = 5000\n";
      folder.write("machine.toml", machine);
      const auto run = run_camber(folder, "predict job.toml -o r");
      const bool hits = path == "dogleg" ? bent : straight;
      EXPECT_EQ(run.status, hits ? 1 : 0) << path << away << run.err;
      EXPECT_EQ(run.err.find("[collision-rapid]") != std::string::npos, hits) << path << away << run.err;
    }
  }
}

TEST(Collisions, AreWarningsWhereAPartOfTheProgramIsLeftOut) {
  const TempFolder folder;
  write_job(folder, kHead + "G0 X-4 Y0 Z5\nG0 Z-2\nG1 X12 F900\nG0 X-4\nY6\nG1 X12\nG0 Z5\nM30\n",
            "operations = { blocks = [[9, 9]] }\n" + kFlat, "box_mm = [[0, -8, -5], [8, 8, 0]]");
  const auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("p.nc:7:1: warning: 1 collision in moves outside the job's operations, the first one in line "
                         "7: rapid through material: the cutter of T1 in stock at X"),
            std::string::npos)
      << run.err;
}

TEST(Collisions, OfMovesOutsideTheOperationsAreOneLine) {
  const TempFolder folder;
  std::string program = kHead;
  for (int y = -6; y <= 6; y += 3)
    program += "G0 X-4 Y" + std::to_string(y) + " Z5\nG0 Z-2\nG1 X12 F900\nG0 X4\nG0 Z5\n";
  program += "M30\n";
  // Line 19, a cut of the region; every pass begins with a rapid down to Z-2 beside the block and ends with one back.
  write_job(folder, program, "operations = { blocks = [[14, 18]] }\n" + kFlat, "box_mm = [[0, -8, -5], [8, 8, 0]]");
  const auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("p.nc:7:1: warning: 4 collisions in moves outside the job's operations, the first one in line "
                         "7: rapid through material: the cutter of T1 in stock at X"),
            std::string::npos)
      << run.err;
  std::size_t lines = 0;
  for (std::size_t at = run.err.find("[collision"); at != std::string::npos; at = run.err.find("[collision", at + 1))
    ++lines;
  EXPECT_EQ(lines, 1u) << run.err;
}

TEST(Collisions, ShankAndHolderAgainstStockAreErrors) {
  const TempFolder folder;
  // Beside the block, cutting 1 mm of its wall 5 mm deep with flutes of 6 mm.
  const std::string program = kHead + "G0 X-4 Y-6 Z9\nG0 Z-8\nG1 X12 F900\nG0 Z9\nM30\n";
  const std::string stock = "box_mm = [[0, -5, -9], [8, 5, 0]]";
  write_job(folder, program, kFlat + "flute_length_mm = 6\nshank_diameter_mm = 4\n", stock);
  auto run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("p.nc:6:1: error: the shank of T1 in stock at X"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("a longer overhang or less depth was expected [collision-shank]"), std::string::npos);
  // A neck clears the wall where the cut before has left no more than the flutes reach.
  write_job(folder, kHead + "G0 X-4 Y-6 Z9\nG0 Z-4\nG1 X12 F900\nG0 Z9\nX-4\nG0 Z-8\nG1 X12\nG0 Z9\nM30\n",
            kFlat + "flute_length_mm = 6\nneck_diameter_mm = 2.5\nneck_length_mm = 20\nshank_diameter_mm = 4\n", stock);
  run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 0) << run.err;
  // A holder 7 mm above the tip does not.
  std::string tool = kFlat;
  tool.replace(tool.find("30.0"), 4, "7.0");
  write_job(folder, program, tool + "holder_mm = [[20, 20, 10]]\n", stock);
  run = run_camber(folder, "predict job.toml -o r");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("p.nc:6:1: error: the holder of T1 in stock at X"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace camber
