// camber init: a job file from a program and tool tables.
#include <gtest/gtest.h>

#include "machine/material_presets.h"
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
    R"(# A job for camber, begun by camber init. What stands as "# key =" is not known: fill it in. What is marked
# "typical" is an assumption: put in your own value. A "# key = value" is the default.
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
overhang_mm = 24.0                # typical: holder face to tip; bending grows with its cube: measure it
# effective_diameter_ratio = 0.8  # bending diameter of the fluted part / diameter
# youngs_modulus_GPa = 600.0      # carbide; high-speed steel 210
root_stiffness_N_per_um = 20.0    # typical of holder and spindle, lateral: measure it (docs/guide/measure-force.md)

[tool.2]
# Line 11: 1 cutting moves, 4 mm; feed 200 mm/min, spindle 5000 rpm.
# tool.tbl:1: flat end mill 3 flutes
type = "flat"
diameter_mm = 8.0
flutes = 3
helix_deg = 30.0                  # typical: see the tool's data sheet
overhang_mm = 32.0                # typical: holder face to tip; bending grows with its cube: measure it
# effective_diameter_ratio = 0.8  # bending diameter of the fluted part / diameter
# youngs_modulus_GPa = 600.0      # carbide; high-speed steel 210
root_stiffness_N_per_um = 20.0    # typical of holder and spindle, lateral: measure it (docs/guide/measure-force.md)
)";

TEST(Init, WritesWhatProgramAndTablesTell) {
  const TempFolder folder;
  write_program(folder);
  const auto run = run_camber(folder, "init p.nc --tools tool.tbl --machine m.toml -o job.toml");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out, "job.toml: 2 tools; fill in the keys left as \"# key =\", check what is marked \"typical\"\n");
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

TEST(Init, MakesAJobThatRunsWithEveryPreset) {
  const TempFolder folder;
  folder.write("wall.nc", kWall);
  folder.write("m.toml", "[axis.x]\n[axis.y]\n[axis.z]\n");
  const std::string help = run_camber(folder, "init --help").out;
  int presets = 0;
  for (const auto& preset : machine::material_presets()) {
    const std::string name(preset.name);
    EXPECT_NE(help.find(name), std::string::npos) << name;
    ASSERT_EQ(
        run_camber(folder, "-q init wall.nc --machine m.toml --material " + name + " -o " + name + ".toml").status, 0);
    const std::string job = tests::replaced(tests::file_text(folder / (name + ".toml")), "voxel_mm = 0.1 ",
                                            "coupling = \"rigid\"\nvoxel_mm = 0.4 ");
    folder.write(name + ".toml", job);
    const auto run = run_camber(folder, "predict " + name + ".toml -o out");
    EXPECT_EQ(run.status, 0) << name << run.err;
    ++presets;
  }
  EXPECT_EQ(presets, 11);
}

TEST(Init, SaysWhichUnitTheProgramWasReadIn) {
  const TempFolder folder;
  folder.write("p.nc", "T1 M6 (D=0.25 - FLAT END MILL)\nS3000 M3\nG0 X0 Y0 Z1\nG1 Z-0.1 F10\nX1.\nM30\n");
  ASSERT_EQ(run_camber(folder, "-q init p.nc --units inch -o job.toml").status, 0);
  const std::string job = tests::file_text(folder / "job.toml");
  EXPECT_NE(job.find("\nunits = \"inch\" "), std::string::npos) << job;
  EXPECT_NE(job.find("\ndiameter_mm = 6.35\n"), std::string::npos) << job;
}

TEST(Init, MakesAJobThatWaitsForWhatNobodySaid) {
  const TempFolder folder;
  write_program(folder);
  folder.write("m.toml", "[axis.x]\nacceleration_mm_per_s2 = 500\n");
  ASSERT_EQ(run_camber(folder, "-q init p.nc --tools tool.tbl --machine m.toml -o job.toml").status, 0);
  const auto empty = run_camber(folder, "predict job.toml -o out --effective-config");
  EXPECT_EQ(empty.status, 1);
  EXPECT_NE(empty.err.find("[material]"), std::string::npos) << empty.err;
  folder.write("job.toml", tests::replaced(tests::replaced(tests::file_text(folder / "job.toml"),
                                                           "# preset =", "preset = \"S55C\""),
                                           "# krc_ratio", "krc_ratio"));
  const auto filled = run_camber(folder, "predict job.toml -o out --effective-config");
  EXPECT_EQ(filled.status, 0) << filled.err;
  EXPECT_NE(filled.out.find("diameter_mm = 8"), std::string::npos) << filled.out;
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

}  // namespace
}  // namespace camber
