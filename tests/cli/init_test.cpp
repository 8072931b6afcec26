// camber init: a job file from a program and tool tables.
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
    R"(# A job for camber, begun by camber init. What nobody has said yet stands as "# key =": fill it in.
# A "# key = value" is the default.
program = "p.nc"
machine = "m.toml"
# operations = { tools = [1, 2] } # only these are simulated and compensated

[tool.1]
# Line 4: 3 cutting moves, 18 mm; feed 300 to 900 mm/min, spindle 3000 rpm.
# p.nc:3: D=6. - BALL END MILL
type = "ball"
diameter_mm = 6.0
# flutes =
# helix_deg = 0.0
# overhang_mm =                   # holder face to tip: measure it
# effective_diameter_ratio = 0.8  # bending diameter of the fluted part / diameter
# youngs_modulus_GPa = 600.0      # carbide; high-speed steel 210
# root_stiffness_N_per_um = inf   # holder and spindle: measure it

[tool.2]
# Line 11: 1 cutting moves, 4 mm; feed 200 mm/min, spindle 5000 rpm.
# tool.tbl:1: flat end mill 3 flutes
type = "flat"
diameter_mm = 8.0
flutes = 3
# helix_deg = 0.0
# overhang_mm =                   # holder face to tip: measure it
# effective_diameter_ratio = 0.8  # bending diameter of the fluted part / diameter
# youngs_modulus_GPa = 600.0      # carbide; high-speed steel 210
# root_stiffness_N_per_um = inf   # holder and spindle: measure it
)";

TEST(Init, WritesWhatProgramAndTablesTell) {
  const TempFolder folder;
  write_program(folder);
  const auto run = run_camber(folder, "init p.nc --tools tool.tbl --machine m.toml -o job.toml");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out, "job.toml: 2 tools that cut; fill in the keys left as \"# key =\"\n");
  const std::string job = tests::file_text(folder / "job.toml");
  EXPECT_EQ(job.substr(0, job.find("\n[material]")), kExpected);
  EXPECT_NE(job.find("# Cutting moves of the tip: X 0.0 to 10.0, Y 0.0 to 5.0, Z -1.0 to 3.0 mm.\n"
                     "# box_mm = [[-4.0, -4.0, -2.0], [14.0, 9.0, 3.0]]\n"),
            std::string::npos)
      << job;
}

TEST(Init, MakesAJobThatWaitsForWhatNobodySaid) {
  const TempFolder folder;
  write_program(folder);
  folder.write("m.toml", "[axis.x]\nacceleration_mm_per_s2 = 500\n");
  ASSERT_EQ(run_camber(folder, "-q init p.nc --tools tool.tbl --machine m.toml -o job.toml").status, 0);
  const auto empty = run_camber(folder, "predict job.toml -o out --effective-config");
  EXPECT_EQ(empty.status, 1);
  EXPECT_NE(empty.err.find("overhang_mm"), std::string::npos) << empty.err;
  std::string job = tests::file_text(folder / "job.toml");
  job = tests::replaced(job, "# flutes =\n", "flutes = 2\n");
  job = tests::replaced(job, "# overhang_mm = ", "overhang_mm = 30.0");
  job = tests::replaced(job, "# box_mm", "box_mm");
  job = tests::replaced(job, "# preset =", "preset = \"S55C\"\nkrc_ratio = 0.4");
  folder.write("job.toml", job);
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
