// camber post and camber posture as a user runs them.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/open_page.h"
#include "tests/support/run_camber.h"

namespace camber::tests {
namespace {

const std::string kMachine = CAMBER_SOURCE_DIR "/samples/12-five-axis/machine.toml";
const std::string kDome = CAMBER_SOURCE_DIR "/samples/12-five-axis/dome.nc";

TEST(PostCommand, WritesTheProgramAndItsFigures) {
  const TempFolder folder;
  const CamberRun run = run_camber(folder, "post " + kDome + " --machine " + kMachine + " -o out.nc --json r.json");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("tip        off its path by at most 0.0050 mm"), std::string::npos) << run.out;
  EXPECT_EQ(file_text(folder / "out.nc").find("G43.4"), std::string::npos);
  EXPECT_NE(file_text(folder / "r.json").find("\"target\": \"joints\""), std::string::npos);
  const CamberRun quiet = run_camber(folder, "post out.nc --machine " + kMachine + " --to tcp -o tip.nc -q");
  EXPECT_EQ(quiet.status, 0) << quiet.err;
  EXPECT_EQ(quiet.out, "");
  EXPECT_NE(file_text(folder / "tip.nc").find("G43.4 H1"), std::string::npos);
}

TEST(PostCommand, WritesNothingWhereAnAxisLeavesItsTravel) {
  const TempFolder folder;
  folder.write("p.nc",
               "G21 G17 G90 G94 G0\nG10 L2 P1 X0. Y0. Z-320.\nG10 L10 P1 R120.\nT1 M6\nG54 X0. Y0. Z150.\n"
               "G43.4 H1 X900. Y0. Z50. A10. C0.\nG1 X910. F600\nG49\nG53 Z0\nM30\n");
  const CamberRun run = run_camber(folder, "post p.nc --machine " + kMachine + " -o out.nc");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(
      run.err.substr(0, run.err.find('\n')),
      "p.nc:6:1: error: X goes to 910 mm in machine coordinates in this move and 5 more; -250 to 250 was expected "
      "(travel_mm of [axis.x]) [travel]");
  EXPECT_FALSE(std::filesystem::exists(folder / "out.nc"));
}

/// Over the pole of a nutating head that does not turn past the upright spindle; a beam across the table above the tool
/// at work, where the holder goes when the tool is lifted to turn.
TEST(PostCommand, LooksForCollisionsWhereAHeadTurnsAtItsPole) {
  const TempFolder folder;
  std::string machine = file_text(CAMBER_SOURCE_DIR "/samples/kinematics/nutating_head.toml");
  machine.replace(machine.find("[-185, 185]"), 11, "[0, 185]");
  folder.write("m.toml", machine);
  folder.write("beam.toml",
               machine + "[[body]]\nname = \"beam\"\non = \"bed\"\nbox_mm = [[15, -60, 20], [35, 60, 30]]\n");
  folder.write("p.nc",
               "G21 G17 G90 G94\nG10 L2 P1 X0. Y0. Z-100.\nG10 L10 P1 R80.\nG54\nT1 M6\nG0\n"
               "G43.5 H1 X0. Y-20. Z3. I0 J-0.3 K1.\nG1 Z0. F1000 I0 J-0.3 K1.\nY0. J0. K1.\nY20. J0.3 K1.\nM30\n");
  for (const char* name : {"m", "beam"})
    folder.write(
        std::string(name) + "_job.toml",
        "program = \"p.nc\"\nmachine = \"" + std::string(name) +
            ".toml\"\n[tool.1]\ntype = \"ball\"\ndiameter_mm = 6.0\nflutes = 2\noverhang_mm = 50.0\n"
            "holder_mm = [[40, 40, 30]]\n[material]\nktc_MPa = 1860.0\nkrc_MPa = 700.0\nkac_MPa = 0.0\nkte_N_per_mm = "
            "15.0\nkre_N_per_mm = 15.0\nkae_N_per_mm = 0.0\n[stock]\nbox_mm = [[-5, -25, -30], [5, 25, 0]]\n");
  const CamberRun free = run_camber(folder, "post p.nc --job m_job.toml -o free.nc");
  EXPECT_EQ(free.status, 0) << free.err;
  EXPECT_NE(free.out.find("turns back in a cut, which leaves a mark: C from "), std::string::npos) << free.out;
  const CamberRun beam = run_camber(folder, "post p.nc --job beam_job.toml -o beam.nc");
  EXPECT_EQ(beam.status, 1);
  EXPECT_EQ(
      beam.err.substr(0, beam.err.find('\n')),
      "p.nc:10:1: error: the holder of T1 meets the body \"beam\" where the tip of T1 is at X0.00 Y0.00 Z40.11; a "
      "path or a set-up that clears it was expected [collision-table]");
  EXPECT_FALSE(std::filesystem::exists(folder / "beam.nc"));
}

TEST(PostCommand, RefusesAMachineWithoutRotaryAxes) {
  const TempFolder folder;
  folder.write("m.toml", "[axis.x]\n[axis.y]\n[axis.z]\n");
  const CamberRun run = run_camber(folder, "post " + kDome + " --machine m.toml -o out.nc");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "m.toml: error: the machine has no [kinematics]; the chain of its axes was expected [kinematics]\n");
}

TEST(PostureCommand, WritesAProgramThatPostReads) {
  const TempFolder folder;
  const std::string sample = CAMBER_SOURCE_DIR "/samples/16-die-cavity/";
  const CamberRun run = run_camber(folder, "posture " + sample + "finish.nc --job " + sample +
                                               "job.toml --mode normal --max-tilt-deg 0 -o up.nc "
                                               "--report up.html --json up.json");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("rotary axes turn 0 degrees"), std::string::npos) << run.out;
  EXPECT_NE(file_text(folder / "up.html").find("Before and after"), std::string::npos);
  const auto report = nlohmann::json::parse(file_text(folder / "up.json"));
  EXPECT_EQ(report["before"]["mean_angle_deg"], report["mean_angle_deg"]);  // it stays upright
  EXPECT_EQ(report["before"]["compliance_um_per_N"], report["compliance_um_per_N"]);
  const CamberRun near =
      run_camber(folder, "posture " + sample + "finish.nc --job " + sample + "job.toml --mode normal -o normal.nc");
  EXPECT_EQ(near.status, 3);
  EXPECT_NE(near.err.find("posture: the tool is nearer than 1 mm, or swings, at "), std::string::npos) << near.err;
  const CamberRun joints = run_camber(
      folder, "post normal.nc --machine " CAMBER_SOURCE_DIR "/samples/machines/linuxcnc_five_axis.toml -o joints.nc");
  EXPECT_EQ(joints.status, 0) << joints.err;
  EXPECT_EQ(file_text(folder / "joints.nc").find("M428"), std::string::npos);
}

/// rows.toml of the die cavity, to be read from anywhere, with one text replaced.
std::string rows_job(const std::string& from, const std::string& to) {
  const std::string sample = CAMBER_SOURCE_DIR "/samples/16-die-cavity/";
  std::string job = file_text(sample + "rows.toml");
  const auto set = [&job](const std::string& old, const std::string& text) {
    job.replace(job.find(old), old.size(), text);
  };
  set(from, to);
  for (const char* name : {"rows.nc", "part.stl", "rows_stock.stl"})
    if (job.find(std::string("\"") + name) != std::string::npos) set(name, sample + name);
  if (job.find("../machines") != std::string::npos) set("../machines", CAMBER_SOURCE_DIR "/samples/machines");
  return job;
}

TEST(PostureCommand, WritesNothingWhereTheToolMeetsTheMachine) {
  const TempFolder folder;
  folder.write("m.toml", file_text(CAMBER_SOURCE_DIR "/samples/machines/linuxcnc_five_axis.toml") +
                             "[[body]]\nname = \"post\"\non = \"bed\"\nbox_mm = [[20, -20, 60], [30, -10, 80]]\n");
  folder.write("job.toml", rows_job("../machines/linuxcnc_five_axis.toml", "m.toml"));
  const CamberRun run = run_camber(folder, "posture " CAMBER_SOURCE_DIR
                                           "/samples/16-die-cavity/rows.nc --job job.toml -o out.nc "
                                           "--mode normal --max-tilt-deg 0");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("rows.nc:10:1: error: the shank of T1 meets the body \"post\" where the tip of T1 is at X0.00 "
                         "Y0.00 Z30.00; a path or a set-up that clears it was expected [collision-table]\n"),
            std::string::npos)
      << run.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "out.nc"));
}

TEST(PostureCommand, TheStockIsAnObstacle) {
  const TempFolder folder;
  folder.write("job.toml", rows_job("mesh = \"rows_stock.stl\"", "box_mm = [[-50, -40, -50], [50, 40, 1]]"));
  const std::string command = "posture " CAMBER_SOURCE_DIR "/samples/16-die-cavity/rows.nc --job job.toml -o out.nc -q";
  const CamberRun run = run_camber(folder, command);
  EXPECT_EQ(run.status, 3);
  EXPECT_EQ(run.err,
            "posture: no direction of the tool is clear of part, stock and fixtures by 1 mm in line 20; nothing was "
            "written\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "out.nc"));
  const CamberRun without = run_camber(folder, command + " --no-stock");
  EXPECT_EQ(without.status, 0) << without.err;
}

TEST(PostureCommand, ThePageShowsTheMachineAlongTheNewProgram) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  const std::string sample = CAMBER_SOURCE_DIR "/samples/16-die-cavity/";
  const CamberRun run = run_camber(folder, "posture " + sample + "rows.nc --job " + sample +
                                               "rows.toml --overhang 20 -o out.nc -q --report page.html --json r.json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(open_page("machine", folder / "page.html", folder / "r.json"), "");
}

TEST(PostureCommand, WritesTheOverhangOfTheLeastErrorWhereThatIsAskedFor) {
  const TempFolder folder;
  const std::string sample = CAMBER_SOURCE_DIR "/samples/16-die-cavity/";
  const std::string command =
      "posture " + sample + "rows.nc --job " + sample + "rows.toml --overhang 20 --json r.json ";
  const CamberRun shortest = run_camber(folder, command + "-o shortest.nc");
  ASSERT_EQ(shortest.status, 0) << shortest.err;
  EXPECT_EQ(nlohmann::json::parse(file_text(folder / "r.json"))["overhang_mm"], 20);
  const CamberRun least = run_camber(folder, command + "-o least.nc --least-error");
  ASSERT_EQ(least.status, 0) << least.err;
  const auto report = nlohmann::json::parse(file_text(folder / "r.json"));
  ASSERT_EQ(report["overhangs"].size(), 3);
  double error_um = 1e9, overhang_mm = 0;
  for (const auto& row : report["overhangs"])
    if (row["error_um"] < error_um) error_um = row["error_um"], overhang_mm = row["overhang_mm"];
  EXPECT_EQ(report["error_um"], error_um);
  EXPECT_EQ(report["overhang_mm"], overhang_mm);
  EXPECT_GT(overhang_mm, 20);  // axes follow less late in another direction, which takes a longer tool
  EXPECT_NE(shortest.out.find("the least error is that of 40 mm; --least-error writes its program\n"),
            std::string::npos)
      << shortest.out;
  EXPECT_NE(least.out.find("the program is that of 40 mm, which has the least error; 20 mm are clear, too\n"),
            std::string::npos)
      << least.out;
  EXPECT_NE(file_text(folder / "shortest.nc"), file_text(folder / "least.nc"));
  const CamberRun alone =
      run_camber(folder, "posture " + sample + "rows.nc --job " + sample + "rows.toml -o alone.nc --least-error");
  EXPECT_EQ(alone.status, 2);
  EXPECT_NE(alone.err.find("--least-error requires --overhang"), std::string::npos) << alone.err;
}

/// A block whose top falls from z0 at x = 0 to z1 at x = 20, as an ASCII STL file.
std::string sloped_block(double z0, double z1) {
  const auto corner = [&](int i) {
    const int x = (i & 1) * 20, y = (i >> 1 & 1) * 12;
    return "vertex " + std::to_string(x) + " " + std::to_string(y) + " " +
           std::to_string(i < 4    ? -15.0
                          : x == 0 ? z0
                                   : z1) +
           "\n";
  };
  std::string out = "solid block\n";
  for (const char* face : {"021", "123", "456", "657", "014", "154", "263", "367", "042", "246", "135", "375"}) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (int k = 0; k < 3; ++k) out += corner(face[k] - '0');
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid block\n";
}

/// The job of the copy names no program: the raster is what camber copy has written.
TEST(PostureCommand, TiltsTheToolOfARasterThatCopyMade) {
  const TempFolder folder;
  folder.write("part.stl", sloped_block(0, -6));
  folder.write("stock.stl", sloped_block(0.3, -5.7));
  folder.write("job.toml",
               "machine = \"" CAMBER_SOURCE_DIR
               "/samples/machines/linuxcnc_five_axis.toml\"\n[part]\nmesh = "
               "\"part.stl\"\n[stock]\nmesh = \"stock.stl\"\n[tool.1]\ntype = \"ball\"\ndiameter_mm = 6.0\nflutes = 2\n"
               "overhang_mm = 30.0\nflute_length_mm = 10.0\nholder_mm = [[20, 24, 20]]\n[material]\nktc_MPa = "
               "1860.0\nkrc_MPa = 700.0\nkac_MPa = 0.0\nkte_N_per_mm = 15.0\nkre_N_per_mm = 15.0\nkae_N_per_mm = "
               "0.0\n[simulation]\nvoxel_mm = 0.25\n[[copy]]\ntool = 1\nmode = \"scanning-line\"\nscallop_mm = 0.3\n"
               "spindle_rpm = 12000\nfeed_mm_per_min = 1500\nallowance_mm = 0\nregion = { box_mm = [[4, 3], [16, 9]], "
               "z_mm = [-10, 2] }\n");
  const CamberRun copied = run_camber(folder, "copy job.toml -o raster.nc -q");
  ASSERT_EQ(copied.status, 0) << copied.err;
  const CamberRun run = run_camber(folder,
                                   "posture raster.nc --job job.toml -o tilted.nc --json r.json --tool-length 1=120 "
                                   "--work-offset G54=0,0,-100");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto report = nlohmann::json::parse(file_text(folder / "r.json"));
  EXPECT_GT(report["contacts"], 20);
  EXPECT_EQ(report["unclear"], 0);
  EXPECT_LT(report["compliance_um_per_N"], report["before"]["compliance_um_per_N"]);
  EXPECT_NE(file_text(folder / "tilted.nc").find("M428"), std::string::npos);
}

}  // namespace
}  // namespace camber::tests
