// [workpiece] of job.toml.
#include <gtest/gtest.h>

#include "machine/job_file.h"
#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

using tests::replaced;
using tests::TempFolder;

struct WorkpieceResult {
  Job job;
  std::string messages, written;
};

/// Reads a job with these lines in its last table, [workpiece], whose name is in line 13.
WorkpieceResult read_workpiece_lines(std::string_view lines) {
  constexpr std::string_view kJob = R"(program = "finish.nc"
machine = "machine.toml"
[tool.1]
type = "ball"
diameter_mm = 6.0
flutes = 2
overhang_mm = 40.0
[material]
ktc_MPa = 2000.0
krc_MPa = 700.0
[stock]
box_mm = [[0, 0, -20], [50, 40, 5]]
[workpiece]
)";
  const TempFolder folder;
  folder.write("finish.nc", "G21\nM30\n");
  folder.write("jaws.stl", "solid\n");
  folder.write("machine.toml", "[spindle]\nmax_rpm = 12000\n");
  const std::string path = folder.write("job.toml", std::string(kJob) + std::string(lines));
  WorkpieceResult out;
  Diagnostics diagnostics;
  try {
    out.job = read_job(path, diagnostics);
    for (const auto& d : diagnostics.all()) out.messages += to_string(d) + "\n";
    out.written = to_toml(out.job);
  } catch (const InputError& problem) {
    out.messages = problem.what();
  }
  out.messages = replaced(out.messages, folder.path() + "/", "");
  out.written = replaced(out.written, folder.path() + "/", "");
  return out;
}

TEST(WorkpieceKeys, StandsOnItsBottomUnlessToldOtherwise) {
  const auto r = read_workpiece_lines("youngs_modulus_GPa = 70.0\n");
  EXPECT_EQ(r.messages, "");
  ASSERT_TRUE(r.job.workpiece);
  EXPECT_EQ(r.job.workpiece->youngs_modulus_MPa, 70000);
  EXPECT_EQ(r.job.workpiece->poisson_ratio, 0.33);
  EXPECT_TRUE(r.job.workpiece->fixed_bottom);
  EXPECT_EQ(r.job.workpiece->fixture_stiffness_N_per_mm, kNoLimit);
}

TEST(WorkpieceKeys, BoxesMayBeOneOrSeveral) {
  const auto one = read_workpiece_lines("youngs_modulus_GPa = 70.0\nfixed = [[9, 0, -20], [0, 40, -10]]\n");
  EXPECT_EQ(one.messages, "");
  ASSERT_EQ(one.job.workpiece->fixed_boxes.size(), 1u);
  EXPECT_FALSE(one.job.workpiece->fixed_bottom);
  EXPECT_EQ(one.job.workpiece->fixed_boxes[0].min_mm, Vec3(0, 0, -20));
  EXPECT_EQ(one.job.workpiece->fixed_boxes[0].max_mm, Vec3(9, 40, -10));
  const auto two = read_workpiece_lines(
      "youngs_modulus_GPa = 70.0\nfixed = [[[0, 0, -20], [9, 40, -10]], [[40, 0, -20], [50, 40, -10]]]\n");
  EXPECT_EQ(two.messages, "");
  ASSERT_EQ(two.job.workpiece->fixed_boxes.size(), 2u);
  EXPECT_EQ(two.job.workpiece->fixed_boxes[1].min_mm, Vec3(40, 0, -20));
}

TEST(WorkpieceKeys, WrittenAsTheyAreRead) {
  const auto r = read_workpiece_lines(
      "youngs_modulus_GPa = 110.0\npoisson_ratio = 0.3\nfixed = \"jaws.stl\"\nfixture_stiffness_N_per_um = 50\n"
      "cell_mm = 2.0\n");
  EXPECT_EQ(r.messages, "");
  EXPECT_NE(r.written.find("[workpiece]\nyoungs_modulus_GPa = 110\nfixed = \"jaws.stl\"\npoisson_ratio = 0.3\n"
                           "fixture_stiffness_N_per_um = 50\ncell_mm = 2\n"),
            std::string::npos)
      << r.written;
}

TEST(WorkpieceKeys, RefusesWhatIsNoPlace) {
  EXPECT_EQ(
      read_workpiece_lines("youngs_modulus_GPa = 70.0\nfixed = [[0, 0, -20]]\n").messages,
      "job.toml:15:9: error: fixed is not a list of boxes; \"bottom\", a list of boxes such as [[[x, y, z], [x, y, "
      "z]]], or the path of an STL file in quotes was expected [value-type]\n"
      "    fixed = [[0, 0, -20]]\n"
      "            ^");
  EXPECT_EQ(read_workpiece_lines("youngs_modulus_GPa = 70.0\nfixed = \"top\"\n").messages,
            "job.toml:15:9: error: fixed: no such file: top (paths are relative to the job's folder) [file-missing]\n"
            "    fixed = \"top\"\n"
            "            ^");
}

TEST(WorkpieceKeys, RefusesNumbersThatNoMaterialHas) {
  const std::string message = read_workpiece_lines("youngs_modulus_GPa = 70.0\npoisson_ratio = 0.5\n").messages;
  EXPECT_NE(message.find("job.toml:15:17: error: poisson_ratio"), std::string::npos) << message;
  EXPECT_NE(read_workpiece_lines("poisson_ratio = 0.3\n").messages.find("youngs_modulus_GPa"), std::string::npos);
}

}  // namespace
}  // namespace camber::machine
