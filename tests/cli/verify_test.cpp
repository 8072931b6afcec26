// compensate --verify as a user meets it: an emitted program judged from its text, and the job that predict judges it
// by.
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/run_camber.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::file_text;
using tests::run_camber;
using tests::TempFolder;

/// Three passes of 10 mm along a wall, the second one deeper than the others.
const std::string kPasses =
    "%\nO1 (PASSES)\nG21 G90 G17 G40 G49 G80 G54\n(ROUGH)\nT1 M6\nS3000 M3\nG0 X-4. Y-3.\nG0 Z-1.\nG1 X14. F600\n"
    "G0 Z5.\nG0 X-4. Y-2.2\n(FINISH LOW)\nG0 Z-1.5\nG1 X14. F600\nG0 Z5.\nG0 X-4. Y-2.\n(FINISH WALL)\nG0 Z-1.\n"
    "G1 X6. F600\nX14.\nG0 Z5.\nM30\n%\n";

void write_job(const TempFolder& folder, const std::string& operations, const std::string& compensation = "",
               const std::string& part = "") {
  folder.write("p.nc", kPasses);
  folder.write("machine.toml",
               "[control]\ncorner = { law = \"blend\", tolerance_mm = 0.01 }\n[axis.x]\nacceleration_mm_per_s2 = 500\n"
               "[axis.y]\n[axis.z]\n");
  folder.write("job.toml",
               "program = \"p.nc\"\nmachine = \"machine.toml\"\n" + operations +
                   "[tool.1]\ntype = \"flat\"\ndiameter_mm = 4.0\nflutes = 2\noverhang_mm = 30.0\nflute_length_mm = "
                   "30.0\nroot_stiffness_N_per_um = inf\nhelix_deg = 30\n"
                   "[material]\nktc_MPa = 2000.0\nkrc_MPa = 700.0\n[stock]\nbox_mm = [[0, -0.5, -2], [10, 2, 0]]\n" +
                   part + "[simulation]\nvoxel_mm = 0.2\ncoupling = \"rigid\"\n[compensation]\ntolerance_um = 20.0\n" +
                   "max_rounds = 3\n" + compensation);
}

json json_of(const TempFolder& folder, const std::string& name) { return json::parse(file_text(folder / name)); }

/// Runs compensate, --verify and predict on the job that --verify writes.
void expect_the_same_figures(const TempFolder& folder, const std::string& options = "") {
  std::filesystem::create_directory(folder / "out");
  const auto made = run_camber(folder, "-q compensate job.toml -o out/moved.nc --json c.json " + options);
  ASSERT_TRUE(made.status == 0 || made.status == 3) << made.err;
  ASSERT_GT(json_of(folder, "c.json")["blocks"]["after"], json_of(folder, "c.json")["blocks"]["before"]);
  const auto verified = run_camber(folder, "compensate --verify out --json v.json");
  EXPECT_EQ(verified.status, made.status) << verified.err;
  const auto predicted = run_camber(folder, "-q predict out/moved.verify.toml -o p");
  ASSERT_EQ(predicted.status, 0) << predicted.err;
  const json c = json_of(folder, "c.json")["after"], v = json_of(folder, "v.json"),
             p = json_of(folder, "p/summary.json");
  constexpr double kRounded_um = 1e-6;  // units there and back
  for (const char* figure : {"rms", "p95", "min", "max", "area_mm2"}) {
    const double wanted = c["error_um"][figure];
    EXPECT_NEAR(v["emitted"]["error_um"][figure], wanted, kRounded_um) << figure;
    EXPECT_NEAR(v["judged_um"][figure], wanted, kRounded_um) << figure;
    EXPECT_NEAR(p["form_error_um"][figure], wanted, kRounded_um) << figure;
    EXPECT_NEAR(v["emitted"]["contour_um"][figure], c["contour_um"][figure], kRounded_um) << figure;
  }
  EXPECT_EQ(v["verdict"]["success"], json_of(folder, "c.json")["verdict"]["success"]);
  EXPECT_NEAR(v["into_part"]["gouge_depth_p999_um"],
              json_of(folder, "c.json")["into_part"]["after"]["gouge_depth_p999_um"].get<double>(), kRounded_um);
  EXPECT_NE(verified.out.find("judged, by compensate"), std::string::npos) << verified.out;
}

TEST(Verify, GivesCompensatesFiguresOfTheWholeProgram) {
  const TempFolder folder;
  write_job(folder, "");
  expect_the_same_figures(folder, "--header");
}

TEST(Verify, FollowsTheBlocksThatSplitsHaveMoved) {
  const TempFolder folder;
  write_job(folder, "operations = { blocks = [[14, 14], [19, 20]] }\n");
  expect_the_same_figures(folder, "--header");
  // The emitted lines of the given lines 19 and 20 stand elsewhere: the given numbers would judge another cut.
  const std::string job = file_text(folder / "out/moved.verify.toml");
  EXPECT_EQ(job.find("\n[operations]\nblocks = [[14, 14], [19, 20]]"), std::string::npos) << job;
  EXPECT_NE(job.find("\n[part.operations]\nblocks = [[14, 14], [19, 20]]"), std::string::npos) << job;
}

TEST(Verify, FollowsOperationsByComment) {
  const TempFolder folder;
  write_job(folder, "operations = { comments = \"finish\" }\n");
  // The header has the word as well, which must not make a heading of it.
  expect_the_same_figures(folder, "--header");
}

TEST(Verify, JudgesTheSurfaceOfTheMovesThatWereCompensated) {
  const TempFolder folder;
  write_job(folder, "", "operations = { comments = \"wall\" }\n");
  expect_the_same_figures(folder);
  EXPECT_GT(json_of(folder, "v.json")["not_judged_mm2"], 1);
}

TEST(Verify, TakesTheProgramsNameToo) {
  const TempFolder folder;
  write_job(folder, "");
  ASSERT_NE(run_camber(folder, "-q compensate job.toml -o a.nc").status, 1);
  ASSERT_NE(run_camber(folder, "-q compensate job.toml -o b.nc").status, 1);
  auto run = run_camber(folder, "compensate --verify .");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            ".: error: has the records of 2 programs; one of them was expected: ./a.nc, ./b.nc [record-several]\n");
  run = run_camber(folder, "-q compensate --verify a.nc");
  EXPECT_NE(run.status, 1) << run.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "a.verify.toml"));
}

TEST(Verify, RefusesWhatItsRecordIsNotOf) {
  const TempFolder folder;
  write_job(folder, "");
  const auto error_of = [&](const std::string& place) {
    const auto run = run_camber(folder, "compensate --verify " + place);
    EXPECT_EQ(run.status, 1) << run.out;
    return run.err;
  };
  EXPECT_EQ(error_of("nowhere"),
            "nowhere: error: no such folder or program; the folder of a program that camber compensate wrote was "
            "expected [file-missing]\n");
  EXPECT_EQ(error_of("."),
            ".: error: has no record (*.record.json); the folder of a program that camber compensate wrote was "
            "expected [record-missing]\n");
  EXPECT_EQ(error_of("p.nc"),
            "p.nc: error: has no record beside it; a program that camber compensate wrote was expected "
            "[record-missing]\n");
  ASSERT_NE(run_camber(folder, "-q compensate job.toml -o a.nc").status, 1);
  const std::string emitted = file_text(folder / "a.nc"), record = file_text(folder / "a.nc.record.json");
  folder.write("a.nc", emitted + "(EDITED)\n");
  EXPECT_EQ(error_of("a.nc"),
            "a.nc: error: has changed since camber compensate wrote it, so the record no longer matches its lines; the "
            "unchanged program, or a new run of camber compensate, was expected [program-edited]\n");
  folder.write("a.nc", emitted);
  folder.write("p.nc", kPasses + "\n");
  EXPECT_NE(error_of("a.nc").find("has changed since it was compensated"), std::string::npos);
  folder.write("p.nc", kPasses);
  for (const std::string& bad : {std::string("{}"), record.substr(0, record.size() / 2), std::string()}) {
    folder.write("a.nc.record.json", bad);
    const std::string said = error_of("a.nc");
    EXPECT_NE(said.find("[record-format]"), std::string::npos) << said;
  }
  std::filesystem::remove(folder / "a.nc.record.json");
  EXPECT_NE(error_of("a.nc").find("[record-missing]"), std::string::npos);
}

TEST(Verify, TakesNoOtherOptions) {
  const TempFolder folder;
  write_job(folder, "");
  for (const char* arguments : {"compensate job.toml --verify .", "compensate --verify . -o a.nc", "compensate"})
    EXPECT_EQ(run_camber(folder, arguments).status, 2) << arguments;
}

}  // namespace
}  // namespace camber
