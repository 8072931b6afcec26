// camber init: a job file from a program and tool tables.
#include <filesystem>
#include <regex>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::run_camber;
using tests::TempFolder;

void write_program(const TempFolder& folder) {
  folder.write("p.nc",
               "%\nG21 G90 G17 G40 G49 G80 G54\n(T1 D=6. - BALL END MILL)\nT1 M6\nS3000 M3\nG0 X0. Y0. Z3.\n"
               "G1 Z-0.3 F300\nX10. F900\nY5.\nG0 Z3.\nT2 M6\nS5000 M3\nG0 X0. Y0.\nG1 Z-1. F200\nG0 Z3.\nM30\n%\n");
  folder.write("tool.tbl", "T2 P2 D8.0 ;flat end mill 3 flutes\n");
}

constexpr const char* kExpected =
    R"(# A job for camber, begun by camber init. It runs as it stands: what no file says is an assumption, marked
# "typical" or CHECK and listed in "assumed". A "# key = value" is the default.
program = "p.nc"
machine = "m.toml"
# operations = { tools = [1, 2] } # only these are simulated and compensated

[tool.1]
# Line 4: 3 cutting moves, 18 mm; feed 300 to 900 mm/min, spindle 3000 rpm.
# p.nc:3: D=6. - BALL END MILL
type = "ball"
diameter_mm = 6.0
flutes = 2                        # typical: count them
helix_deg = 30.0                  # typical: see the tool's data sheet
overhang_mm = 21.0                # typical: holder face to tip; bending grows with its cube: measure it
# effective_diameter_ratio = 0.8  # bending diameter of the fluted part / diameter
# youngs_modulus_GPa = 600.0      # carbide; high-speed steel 210
root_stiffness_N_per_um = 20.0    # typical of holder and spindle, lateral: measure it (docs/guide/measure-force.md)
assumed = ["flutes", "helix_deg", "overhang_mm", "root_stiffness_N_per_um"] # results begin with these: take out what you have put in

[tool.2]
# Line 11: 1 cutting moves, 4 mm; feed 200 mm/min, spindle 5000 rpm.
# tool.tbl:1: flat end mill 3 flutes
type = "flat"
diameter_mm = 8.0
flutes = 3
helix_deg = 30.0                  # typical: see the tool's data sheet
overhang_mm = 27.0                # typical: holder face to tip; bending grows with its cube: measure it
# effective_diameter_ratio = 0.8  # bending diameter of the fluted part / diameter
# youngs_modulus_GPa = 600.0      # carbide; high-speed steel 210
root_stiffness_N_per_um = 20.0    # typical of holder and spindle, lateral: measure it (docs/guide/measure-force.md)
assumed = ["helix_deg", "overhang_mm", "root_stiffness_N_per_um"] # results begin with these: take out what you have put in
)";

TEST(Init, WritesWhatProgramAndTablesTell) {
  const TempFolder folder;
  write_program(folder);
  folder.write("m.toml", "[axis.x]\n[axis.y]\n[axis.z]\n");
  const auto run = run_camber(folder, "init p.nc --tools tool.tbl --machine m.toml -o job.toml");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(
      run.out,
      "warning: assumed, not given: material C45 (preset, krc_ratio, within 40 %); T1 flutes, helix_deg, overhang_mm, "
      "root_stiffness_N_per_um; T2 helix_deg, overhang_mm, root_stiffness_N_per_um; stock box_mm [assumed]\n"
      "note: T1 flute_length_mm = 18 [typical-value]\nnote: T2 flute_length_mm = 24 [typical-value]\n"
      "job.toml: 2 tools; what is assumed is marked \"typical\" or CHECK in it\n");
  const std::string job = tests::file_text(folder / "job.toml");
  EXPECT_EQ(job.substr(0, job.find("\n[material]")), kExpected);
  EXPECT_NE(job.find("# Its top: the program's Z0, below which all cutting lies.\n"
                     "box_mm = [[-6.0, -6.0, -2.0], [15.0, 10.0, 0.0]]\n"),
            std::string::npos)
      << job;
}

/// A wall as in the user's guide: the tool goes down by a rapid beside it.
constexpr const char* kWall =
    "G21 G90 G17 G54\nT1 M6 (8. FLAT, 4 FLUTES)\nS4000 M3\nG0 Z10.\nX-7. Y7.\nZ-3.\nG3 X-4. Y4. I3. J0. F640\n"
    "G1 X16.\nG3 X19. Y7. I0. J3.\nG0 Z10.\nM30\n";

TEST(Init, ProposesABlankThatNoRapidRunsThrough) {
  const TempFolder folder;
  folder.write("wall.nc", kWall);
  folder.write("m.toml", "[axis.x]\n[axis.y]\n[axis.z]\n");
  ASSERT_EQ(run_camber(folder, "-q init wall.nc --machine m.toml --material C45 -o job.toml").status, 0);
  const std::string job = tests::file_text(folder / "job.toml");
  EXPECT_NE(job.find("# Sides are taken back from where rapids go down beside the part.\n"), std::string::npos) << job;
  const auto check = run_camber(folder, "check wall.nc --job job.toml");
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_NE(check.out.find("\nno warnings\n"), std::string::npos) << check.out << check.err;
}

TEST(Init, ProposesABlankBesideWhichAFaceMillGoesDown) {
  const TempFolder folder;
  folder.write(
      "faced.nc",
      "G21 G90 G17 G54\nT1 M6 (50. FACE MILL)\nS3000 M3\nG0 X60. Y0. Z5.\nG1 Z-1. F4000\nX-30.\nG0 Z20.\nM30\n");
  folder.write("m.toml", "[axis.x]\n[axis.y]\n[axis.z]\n");
  ASSERT_EQ(run_camber(folder, "-q init faced.nc --machine m.toml --material 6061 -o job.toml").status, 0);
  // The axis goes down at X60; its edges reach X35.
  const std::string job = tests::file_text(folder / "job.toml");
  EXPECT_NE(job.find("\nbox_mm = [[-57.0, -27.0, -2.0], [34."), std::string::npos) << job;
  const auto check = run_camber(folder, "check faced.nc --job job.toml");
  EXPECT_NE(check.out.find("\nno warnings\n"), std::string::npos) << check.out << check.err;
  folder.write("large.toml", std::regex_replace(job, std::regex("\\[34\\.[0-9]*,"), "[90.0,"));
  const auto large = run_camber(folder, "check faced.nc --job large.toml");
  EXPECT_NE(large.err.find("faced.nc:5:1: warning: T1 goes straight down into the stock"), std::string::npos)
      << large.err;
}

TEST(Init, MakesAJobThatRunsAsItStands) {
  const TempFolder folder;
  folder.write("wall.nc", kWall);
  ASSERT_EQ(run_camber(folder, "-q init wall.nc -o job.toml").status, 0);
  const std::string job = tests::file_text(folder / "job.toml");
  EXPECT_NE(job.find("\nmachine = \"preset:vmc-40\" "), std::string::npos) << job;
  EXPECT_NE(job.find("\n# CHECK: no file names it; the commonest. Or camber init --material NAME.\npreset = \"C45\" "),
            std::string::npos)
      << job;
  folder.write("job.toml", tests::replaced(job, "voxel_mm = 0.1 ", "coupling = \"rigid\"\nvoxel_mm = 0.4 "));
  const auto run = run_camber(folder, "predict job.toml -o out --json r.json");
  EXPECT_EQ(run.status, 0) << run.err;
  const std::string expected =
      "warning: assumed, not given: machine preset:vmc-40, typical values of its class; material C45 (preset, "
      "krc_ratio, within 40 %); T1 helix_deg, overhang_mm, root_stiffness_N_per_um; stock box_mm [assumed]\n";
  EXPECT_EQ(run.out.substr(0, expected.size()), expected);
  EXPECT_EQ(tests::file_text(folder / "r.json").find("{\n  \"assumed\": [\"machine preset:vmc-40"), 0u);
  EXPECT_NE(tests::file_text(folder / "out/report.html").find("assumed, not given: machine preset:vmc-40"),
            std::string::npos);
}

TEST(Init, NamesMaterialsAsEveryStandardDoes) {
  const TempFolder folder;
  folder.write("wall.nc", kWall);
  const auto material_of = [&](const std::string& name) {
    std::filesystem::remove(folder / "job.toml");
    const auto run = run_camber(folder, "-q init wall.nc --material '" + name + "' -o job.toml");
    EXPECT_EQ(run.status, 0) << run.err;
    const std::string job = tests::file_text(folder / "job.toml");
    const std::size_t from = job.find("[material]"), end = job.find("\n[stock]");
    return job.substr(from, end - from);
  };
  const std::string skd61 = material_of("SKD61");
  for (const char* text :
       {"\npreset = \"SKD61\" ", "# hot work steel X37CrMoV5-1, annealed; within 25 %\nkrc_ratio = 0.4 ",
        "\nassumed = [\"krc_ratio\"] "})
    EXPECT_NE(skd61.find(text), std::string::npos) << skd61;
  EXPECT_EQ(skd61.find("CHECK"), std::string::npos) << skd61;
  EXPECT_NE(material_of("1.2379 60 HRC")
                .find("# CHECK: \"1.2379 60 HRC\": values of hardened-60HRC, the class of "
                      "steel nearest to 654 HB.\npreset = \"1.2379 60 HRC\" "),
            std::string::npos);
  const auto unknown = run_camber(folder, "init wall.nc --material unobtainium -o other.toml");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("nothing is known of a material \"unobtainium\""), std::string::npos) << unknown.err;
}

/// Rows of a ball end mill, 0.5 mm apart, along a floor 12 mm below the top of the blank.
std::string deep_rows() {
  std::string out;
  for (int row = 0; row <= 20; ++row)
    out += fmt::format("G0 X{} Y{:.1f} Z3.\nG1 Z-12. F300\nX{} F900\nG0 Z3.\n", row % 2 == 0 ? 0 : 20, 0.5 * row,
                       row % 2 == 0 ? 20 : 0);
  return out;
}

/// A flat end mill that takes the same floor out in steps of `step_mm`.
std::string levels(double step_mm) {
  std::string out = "(T1 D=8. - FLAT END MILL)\nT1 M6\nS4000 M3\n";
  for (double z = -step_mm; z > -12.1; z -= step_mm)
    for (int row = 0; row <= 3; ++row)
      out += fmt::format("G0 X-8. Y{} Z3.\nG1 Z{:.1f} F300\nX28. F900\nG0 Z3.\n", 4 * row - 1, z);
  return out;
}

const std::string kBallTool = "(T2 D=6. - BALL END MILL)\nT2 M6\nS4000 M3\n";

std::string job_of_program(const TempFolder& folder, const std::string& moves) {
  folder.write("p.nc", "G21 G90 G17 G40 G49 G80 G54\n" + moves + "M30\n");
  const auto run = run_camber(folder, "-q init p.nc -o job.toml");
  EXPECT_EQ(run.status, 0) << run.err;
  std::string job = tests::file_text(folder / "job.toml");
  job = job.substr(job.find("# Its top"));
  return job.substr(0, job.find("\n\n"));
}

TEST(Init, SaysOfAProgramThatFinishesAloneWhatRoughingHasLeft) {
  EXPECT_EQ(job_of_program(TempFolder(), kBallTool + deep_rows()),
            R"(# Its top: the program's Z0, below which all cutting lies.
box_mm = [[-5.0, -5.0, -13.0], [25.0, 15.0, 0.0]]
# CHECK: this program finishes alone: in the whole blank a ball end mill of 6 mm would cut up to 12.0 mm deep.
# So the blank is taken as roughed along the same path, this much short of it; take the key out where the
# program does rough, or give the roughed part: mesh = "roughed.stl".
allowance_mm = 0.3                # typical: what roughing leaves for finishing
assumed = ["box_mm", "allowance_mm"] # results begin with these: take out what you have put in)");
}

TEST(Init, SaysNothingOfThatWhereTheProgramRoughs) {
  for (const std::string& moves : {levels(3) + kBallTool + deep_rows(),  // finishing after it
                                   levels(12),                           // a whole-depth cut of 1.5 diameters
                                   kBallTool + "G0 X0. Y0. Z3.\nG1 Z-2. F300\nX20. F900\nG0 Z3.\n"})
    EXPECT_EQ(job_of_program(TempFolder(), moves).find("\nallowance_mm"), std::string::npos) << moves;
}

TEST(Init, WritesAPresetAsAMachineFile) {
  const TempFolder folder;
  const auto run = run_camber(folder, "init --machine preset:router -o machine.toml");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(tests::file_text(folder / "machine.toml").find("acceleration_mm_per_s2 = 500.0          # 50 to 2000: "),
            std::string::npos);
  folder.write("p.nc", "G21 G90\nS9000 M3\nG0 X0 Y0 Z1\nG1 X20 F2000\nM30\n");
  const auto feed = run_camber(folder, "feed p.nc --machine machine.toml --json f.json");
  EXPECT_EQ(feed.status, 0) << feed.err;
  EXPECT_EQ(
      feed.out.find("warning: assumed, not given: machine preset:router, typical values of its class [assumed]\n"), 0u)
      << feed.out;
  const auto time = run_camber(folder, "time p.nc --machine preset:vmc-linear");
  EXPECT_EQ(time.status, 0) << time.err;
  EXPECT_EQ(time.out.find("warning: assumed, not given: machine preset:vmc-linear"), 0u) << time.out;
  EXPECT_EQ(run_camber(folder, "init --machine preset:lathe -o m2.toml").status, 2);
  EXPECT_EQ(run_camber(folder, "init --machine machine.toml -o m2.toml").status, 2);
}

/// A program of each CAM system that has no T word, or whose blank its comments give.
TEST(Init, TakesToolsAndBlankFromComments) {
  const TempFolder folder;
  folder.write("carbide.nc",
               "(stockMin:0.00mm, 0.00mm, -12.00mm)\n(stockMax:60.00mm, 40.00mm, 0.00mm)\n"
               "(STOCK/BLOCK,60.00, 40.00, 12.00,0.00, 0.00, 12.00)\nG90\nG21\nM05\n"
               "(TOOL/MILL,6.35, 0.00, 19.05, 0.00)\nM6T201\nM03S18000\nG0X5Y5Z5\nG1Z-1F300\nX55F1000\nG0Z5\nM30\n");
  ASSERT_EQ(run_camber(folder, "-q init carbide.nc -o job.toml").status, 0);
  const std::string job = tests::file_text(folder / "job.toml");
  EXPECT_NE(job.find("\nmachine = \"preset:router\" "), std::string::npos) << job;
  EXPECT_NE(job.find("\n[tool.201]\n"), std::string::npos) << job;
  EXPECT_NE(job.find("\nflute_length_mm = 19.05\n"), std::string::npos) << job;
  EXPECT_NE(job.find("\n[stock]\n# Cutting moves of the tip: X 5.0 to 55.0, Y 5.0 to 5.0, Z -1.0 to 5.0 mm.\n"
                     "# carbide.nc:1: (stockMin:0.00mm, 0.00mm, -12.00mm)\n"
                     "box_mm = [[0.0, 0.0, -12.0], [60.0, 40.0, 0.0]]\n\n"),
            std::string::npos)
      << job;
  folder.write("fusion.nc",
               "(T12  D=12 CR=0 - flat end mill)\nG21 G90\nS6000 M3\nG0 X0 Y0 Z5\nG1 Z-1 F300\nX30 F800\n"
               "G0 Z5\nM30\n");
  ASSERT_EQ(run_camber(folder, "-q init fusion.nc -o fusion.toml").status, 0);
  const std::string fusion = tests::file_text(folder / "fusion.toml");
  EXPECT_NE(fusion.find("\n[tool.0]\n"), std::string::npos) << fusion;
  EXPECT_NE(fusion.find("\ndiameter_mm = 12.0\n"), std::string::npos) << fusion;
  EXPECT_EQ(run_camber(folder, "check fusion.nc --job fusion.toml").status, 0);
}

TEST(Init, TakesToolsFromTheirNames) {
  const TempFolder folder;
  const auto lines = [&](const std::string& name, bool klartext) {
    const std::string file = klartext ? "p.h" : "p.mpf", quoted = '"' + name + '"';
    folder.write(file, klartext ? "BEGIN PGM P MM\nTOOL CALL " + quoted +
                                      " Z S6000\nL X+0 Y+0 Z+2 R0 FMAX M3\nL Z-1 F500\nL X+50\nL Y+50\nEND PGM P MM\n"
                                : "G710 G17 G90 G54\nT=" + quoted +
                                      " D1\nM6\nS6000 M3\nG0 X0 Y0 Z2\nG1 Z-1 F500\nX50\nY50\nM30\n");
    std::filesystem::remove(folder / "job.toml");
    EXPECT_EQ(run_camber(folder, "-q init " + file + " -o job.toml").status, 0);
    const std::string job = tests::file_text(folder / "job.toml");
    const std::size_t type = job.find("\ntype = ") + 1, end = job.find('\n', job.find("\ndiameter_mm = ", type) + 1);
    return job.substr(type, end - type);
  };
  EXPECT_EQ(lines("BALL_D6", false), "type = \"ball\"\ndiameter_mm = 6.0");
  EXPECT_EQ(lines("SCHAFT_D12_N_AP30", true), "type = \"flat\"\ndiameter_mm = 12.0");
  for (const char* silent : {"4711", "HS06000000680246", "SF-12-1.5"})
    EXPECT_NE(lines(silent, true).find("diameter_mm = 10.0 "), std::string::npos) << silent;
}

TEST(Init, GuessesWhatNoCommentSays) {
  const TempFolder folder;
  folder.write("face.nc",
               "G21 G90\nT1 M6 (UGT0212 004)\nS1000 M3\nG0 X-40 Y0 Z5\nG1 Z-1 F500\nX140\nY37.2\nX-40\nY74.4\nX140\n"
               "Y111.6\nX-40\nG0 Z5\nM30\n");
  ASSERT_EQ(run_camber(folder, "-q init face.nc -o job.toml").status, 0);
  const std::string job = tests::file_text(folder / "job.toml");
  EXPECT_NE(
      job.find("\ntype = \"flat\"                     # CHECK: no comment names the tool\n"
               "diameter_mm = 50.0                # CHECK: no comment gives it; by the distance between passes, else "
               "10\nflutes = 5 "),
      std::string::npos)
      << job;
  EXPECT_NE(job.find("\noverhang_mm = 40.0 "), std::string::npos) << job;  // not four diameters
}

/// A pocket of 9 mm: the usual cutter of 10 mm does not fit, and the one of a comment counts before any other.
TEST(Init, ProposesCuttersThatFitThePocketsOfCycles) {
  const TempFolder folder;
  const auto program = [](const char* comment) {
    return fmt::format(
        "BEGIN PGM P MM\nBLK FORM 0.1 Z X-20 Y-20 Z-10\nBLK FORM 0.2 X+20 Y+20 Z+0\n{}TOOL CALL 3 Z S6000\n"
        "L Z+50 R0 FMAX M3\nCYCL DEF 251 Q215=0 Q218=9 Q219=9 Q220=2 Q368=0 Q224=0 Q367=0 Q207=300 Q351=1 Q201=-2 "
        "Q202=2 Q369=0 Q206=100 Q338=0 Q200=2 Q203=0 Q204=50 Q370=1 Q366=0 Q385=300\nL X+0 Y+0 FMAX M99\n"
        "L Z+50 FMAX M30\nEND PGM P MM\n",
        comment);
  };
  folder.write("p.h", program(""));
  folder.write("told.h", program("; T3 D=5 - FLAT END MILL\n"));
  ASSERT_EQ(run_camber(folder, "-q init p.h -o p.toml").status, 0);
  ASSERT_EQ(run_camber(folder, "-q init told.h -o told.toml").status, 0);
  EXPECT_NE(
      tests::file_text(folder / "p.toml")
          .find("\ndiameter_mm = 8.0                 # CHECK: no comment gives it; a usual one that fits the cycles\n"),
      std::string::npos)
      << tests::file_text(folder / "p.toml");
  EXPECT_NE(tests::file_text(folder / "told.toml").find("\ndiameter_mm = 5.0\n"), std::string::npos)
      << tests::file_text(folder / "told.toml");
  for (const char* job : {"p.toml", "told.toml"})
    EXPECT_EQ(run_camber(folder, fmt::format("check --job {}", job)).status, 0) << job;
}

/// A contour round a blank that is as large as the part, as posts write it for the graphics: a guess, no error.
TEST(Init, TakesABlankBesideThePathForAGuess) {
  const TempFolder folder;
  folder.write("p.h",
               "BEGIN PGM P MM\nBLK FORM 0.1 Z X+0 Y+0 Z-10\nBLK FORM 0.2 X+40 Y+30 Z+0\n; T3 D=10 - FLAT END MILL\n"
               "TOOL CALL 3 Z S6000\nL X-20 Y-20 R0 FMAX M3\nL Z-9 FMAX\nL X-5 Y-5 F900\nL Y+35\nL X+45\nL Y-5\nL "
               "X-5\nL Z+50 FMAX M30\nEND PGM P MM\n");
  ASSERT_EQ(run_camber(folder, "-q init p.h -o p.toml").status, 0);
  const std::string job = tests::file_text(folder / "p.toml");
  EXPECT_NE(job.find("\nmachine = \"preset:tnc-640\" "), std::string::npos) << job;
  EXPECT_NE(job.find("# Its place: CHECK: 100 % of the cutting path runs beside or above it.\nbox_mm = [[0.0, 0.0, "
                     "-10.0], [40.0, 30.0, 0.0]]\n"),
            std::string::npos)
      << job;
}

/// M91 on a machine of a class leads to no known place, least of all into the part.
TEST(Init, JobsOfFiveAxesRetractInMachineCoordinates) {
  const TempFolder folder;
  folder.write(
      "p.h",
      "BEGIN PGM P MM\nBLK FORM 0.1 Z X-20 Y-20 Z-20\nBLK FORM 0.2 X+20 Y+20 Z+0\n; T3 D=10 R=5 - BALL END "
      "MILL\nTOOL CALL 3 Z S6000\nL Z-1 FMAX M91\nL X-30 Y+0 R0 FMAX M3\nFUNCTION TCPM F TCP AXIS POS PATHCTRL "
      "AXIS\nL X-30 Y+0 Z+20 A-10 C+0 FMAX\nL Z-1 F900\nL X+30 A-12\nL Z+40 FMAX\nFUNCTION RESET TCPM\nL Z-1 "
      "FMAX M91\nL X-300 Y-1 FMAX M91\nM30\nEND PGM P MM\n");
  ASSERT_EQ(run_camber(folder, "-q init p.h -o p.toml").status, 0);
  const auto check = run_camber(folder, "check --job p.toml");
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_EQ((check.err + check.out).find("collision"), std::string::npos) << check.err;
}

TEST(Init, SaysWhichUnitTheProgramWasReadIn) {
  const TempFolder folder;
  folder.write("p.nc", "T1 M6 (D=0.25 - FLAT END MILL)\nS3000 M3\nG0 X0 Y0 Z1\nG1 Z-0.1 F10\nX1.\nM30\n");
  ASSERT_EQ(run_camber(folder, "-q init p.nc --units inch -o job.toml").status, 0);
  const std::string job = tests::file_text(folder / "job.toml");
  EXPECT_NE(job.find("\nunits = \"inch\" "), std::string::npos) << job;
  EXPECT_NE(job.find("\ndiameter_mm = 6.35\n"), std::string::npos) << job;
}

TEST(Init, WritesOverNothing) {
  const TempFolder folder;
  write_program(folder);
  folder.write("job.toml", "mine");
  const auto run = run_camber(folder, "init p.nc -o job.toml");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err, "job.toml: error: already exists; a new name was expected [file-exists]\n");
  EXPECT_EQ(tests::file_text(folder / "job.toml"), "mine");
}

TEST(Init, NamesPathsAsTheJobSeesThem) {
  const TempFolder folder;
  write_program(folder);
  std::filesystem::create_directory(folder / "jobs");
  ASSERT_EQ(run_camber(folder, "-q init p.nc -o jobs/job.toml").status, 0);
  EXPECT_NE(tests::file_text(folder / "jobs/job.toml").find("program = \"../p.nc\"\n"), std::string::npos);
}

/// TRAORI with A and C: a class of machines that has them, with which the job is read as it stands.
TEST(Init, TakesAFiveAxisMachineForAProgramThatTurnsItsAxes) {
  const TempFolder folder;
  folder.write("tip.mpf",
               "G710 G17 G90 G54\nT1 M6 D1 ; D=6 CR=3 BALL\nS5000 M3 F1000\nTRAORI\nG0 X0 Y0 Z50 A0 C0\nG1 Z0\n"
               "X10 A10 C20\nX20 Y5\nTRAFOOF\nM30\n");
  folder.write("upright.mpf",
               "G710 G17 G90 G54\nT1 M6 D1\nS5000 M3 F1000\nTRAORI\nG0 X0 Y0 Z50 A0 C0\nG1 Z0\nX10\nTRAFOOF\nM30\n");
  const auto machine_of = [&](const std::string& name) {
    const auto run = run_camber(folder, "-q init " + name + ".mpf -o " + name + ".toml");
    EXPECT_EQ(run.status, 0) << run.err;
    const std::string job = tests::file_text(folder / (name + ".toml"));
    const std::size_t at = job.find("machine = \"");
    return at == std::string::npos ? job : job.substr(at + 11, job.find('"', at + 11) - at - 11);
  };
  EXPECT_EQ(machine_of("tip"), "preset:five-axis-trunnion");
  folder.write("bc.mpf",
               "G710 G17 G90 G54\nT1 M6 D1 ; D=6 CR=3 BALL\nS5000 M3 F1000\nTRAORI\nG0 X0 Y0 Z50 B0 C0\nG1 Z0\n"
               "X10 B10 C20\nX20 Y5\nTRAFOOF\nCYCLE800(1,\"T\",0,57,0,0,0,0,30,0,0,0,0,1)\nG0 X0 Y0 Z50\n"
               "CYCLE800()\nM30\n");
  EXPECT_EQ(machine_of("bc"), "preset:five-axis-trunnion-bc");
  const auto check_bc = run_camber(folder, "check --job bc.toml");
  EXPECT_EQ(check_bc.status, 0) << check_bc.err;
  EXPECT_EQ(machine_of("upright"), "preset:sinumerik-840d");
  const auto check = run_camber(folder, "check --job tip.toml");
  EXPECT_EQ(check.status, 0) << check.err;
}

/// As for routers whose spindle is set by hand: the job runs all the same, and says what it assumes.
TEST(Init, AProgramWithoutASpindleGetsAJobThatRuns) {
  const TempFolder folder;
  folder.write("p.nc", "G21 G90\nT1 M6 (FLAT D6)\nG0 X0 Y0 Z20\nG1 Z-1 F200\nX20 F600\nG0 Z20\nM30\n");
  EXPECT_EQ(run_camber(folder, "-q init p.nc -o job.toml").status, 0);
  const auto check = run_camber(folder, "check --job job.toml");
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_NE(check.err.find("p.nc:4:1: warning: the program names no spindle speed; by the feed, 4200 rpm for T1 are "
                           "assumed; S in the program was expected [spindle-assumed]"),
            std::string::npos)
      << check.err;
}

}  // namespace
}  // namespace camber
