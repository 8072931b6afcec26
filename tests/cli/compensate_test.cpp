// compensate as a user meets it: what is written and when, what is refused, and runs that end early.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <regex>
#include <vector>

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "test_paths.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::file_text;
using tests::run_camber;
using tests::TempFolder;

/// One short wall with a slender flat end mill, coarse voxels: a fraction of a second a round.
const std::string kWall =
    "%\nO1 (WALL)\nG21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X-4. Y-2.\nG0 Z-1.\nG1 X2. F600 "
    "(IN)\nX8.\nX12.\nG0 Z5.\n"
    "M30\n%\n";

void write_job(const TempFolder& folder, const std::string& more = "", const std::string& program = kWall) {
  folder.write("p.nc", program);
  folder.write("machine.toml", "[axis.x]\nacceleration_mm_per_s2 = 500\ntravel_mm = [-100, 100]\n[axis.y]\n[axis.z]\n");
  folder.write(
      "job.toml",
      "program = \"p.nc\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"flat\"\ndiameter_mm = 4.0\nflutes = 2\n"
      "overhang_mm = 30.0\nhelix_deg = 30\n[material]\nktc_MPa = 2000.0\nkrc_MPa = 700.0\n[stock]\n"
      "box_mm = [[0, -0.5, -2], [8, 2, 0]]\nallowance_mm = 0.1\n[simulation]\nvoxel_mm = 0.2\n"
      "coupling = \"rigid\"\n[compensation]\nlevers = [\"shift\"]\ntolerance_um = 10.0\nmax_overcut_um = "
      "6.0\nmax_rounds = 3\n" +
          more);
}

std::vector<std::string> files_of(const TempFolder& folder) {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    if (!entry.path().filename().string().starts_with("camber-")) out.push_back(entry.path().filename().string());
  std::sort(out.begin(), out.end());
  return out;
}
const std::vector<std::string> kInputs{"job.toml", "machine.toml", "p.nc"};

TEST(CompensateCommand, WritesProgramAndFiguresAndTheSameBytesAgain) {
  const TempFolder folder;
  write_job(folder);
  const auto run = run_camber(folder, "compensate job.toml -o a.nc --json a.json --threads 1");
  EXPECT_EQ(run.status, 0) << run.err << run.out;
  ASSERT_EQ(run_camber(folder, "compensate job.toml -o b.nc --threads 2 -q").status, 0);
  EXPECT_EQ(file_text(folder / "a.nc"), file_text(folder / "b.nc"));
  EXPECT_NE(file_text(folder / "a.nc"), kWall);
  const auto json = nlohmann::json::parse(file_text(folder / "a.json"));
  EXPECT_LT(json["after_um"]["rms"], json["before_um"]["rms"]);
  EXPECT_LT(json["split_after_um"]["correctable"], 0.3 * json["split_before_um"]["correctable"].get<double>());
  EXPECT_EQ(json["into_part"]["within_tolerance"], true);
  EXPECT_LE(json["into_part"]["without_bending"]["deepest_um"], 100);
  for (const char* row : {"a shift can correct", "with a rigid tool", "stopped: "})
    EXPECT_NE(run.out.find(row), std::string::npos) << row;
  std::size_t from = 0;
  while (from < run.out.size()) {
    const std::size_t end = run.out.find('\n', from);
    EXPECT_LE(end - from, 80u) << run.out.substr(from, end - from);
    from = end + 1;
  }
}

TEST(CompensateCommand, TakesLeversByNameAndSaysWhatIsInReachFirst) {
  const TempFolder folder;
  write_job(folder);
  const auto run = run_camber(folder, "compensate job.toml -o a.nc --levers shift,feed --json a.json");
  EXPECT_EQ(run.status, 0) << run.err;
  const auto json = nlohmann::json::parse(file_text(folder / "a.json"));
  EXPECT_EQ(json["achievable_um"]["given_p95"], json["before_um"]["p95"]);
  EXPECT_LT(json["achievable_um"]["p95"], json["before_um"]["p95"]);
  EXPECT_EQ(json["levers_used"]["blocks_changed"], json["blocks"]["changed"]);
  EXPECT_TRUE(run.out.starts_with("95th percentile as given ")) << run.out;
  EXPECT_NE(run.out.find("\nlevers used: shift to "), std::string::npos) << run.out;
  const auto wrong = run_camber(folder, "compensate job.toml -o b.nc --levers speed,shift");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_NE(
      wrong.err.find(
          "error: --levers: levers names \"speed\"; a list of \"shift\", \"feed\", \"passes\" and \"allowance\" was "
          "expected [value-choice]"),
      std::string::npos)
      << wrong.err;
  const auto idle = run_camber(folder, "compensate job.toml -o b.nc --levers shift --time-budget 5");
  EXPECT_EQ(idle.status, 1);
  EXPECT_NE(idle.err.find("a time budget of 5 % has no lever to use it"), std::string::npos) << idle.err;
  write_job(folder, "time_budget_percent = 20\n");  // of the job's levers, not of those on the command line
  EXPECT_EQ(run_camber(folder, "compensate job.toml -o b.nc --levers shift").status, 0);
}

TEST(CompensateCommand, NothingIsWrittenWhereNothingIsBetter) {
  const TempFolder folder;
  write_job(folder);
  // Next to no error, and a tolerance below the decimals of the program.
  std::string job = std::regex_replace(file_text(folder / "job.toml"), std::regex("helix_deg = 30"),
                                       "helix_deg = 30\nyoungs_modulus_GPa = 1e9");
  job = std::regex_replace(job, std::regex("tolerance_um = 10.0"), "tolerance_um = 0.000001");
  folder.write("job.toml", job);
  const auto run = run_camber(folder, "compensate job.toml -o a.nc --json a.json");
  EXPECT_EQ(run.status, 3);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.nc"));
  EXPECT_NE(run.err.find("camber: error: no better program was found\n"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("camber: error: a.nc was not written; --keep-anyway writes"), std::string::npos) << run.err;
  const auto json = nlohmann::json::parse(file_text(folder / "a.json"));
  EXPECT_EQ(json["better_than_given"], false);
  EXPECT_EQ(json["verdict"]["success"], false);
  EXPECT_EQ(json["before_um"], json["after_um"]);
  EXPECT_EQ(run_camber(folder, "compensate job.toml -o a.nc --keep-anyway").status, 3);
  EXPECT_TRUE(std::filesystem::exists(folder / "a.nc"));
}

TEST(CompensateCommand, DryRunWritesNoProgram) {
  const TempFolder folder;
  write_job(folder);
  EXPECT_EQ(run_camber(folder, "compensate job.toml --dry-run").status, 0);
  EXPECT_EQ(files_of(folder), kInputs);
  const auto without = run_camber(folder, "compensate job.toml");
  EXPECT_EQ(without.status, 2);
  EXPECT_NE(without.err.find("-o OUT.nc or --dry-run"), std::string::npos) << without.err;
}

TEST(CompensateCommand, HeaderTellsWhatWasDoneAndOnlyAddsLines) {
  const TempFolder folder;
  write_job(folder);
  ASSERT_EQ(run_camber(folder, "compensate job.toml -o a.nc -q").status, 0);
  ASSERT_EQ(run_camber(folder, "compensate job.toml -o b.nc --header-hash -q").status, 0);
  const std::string plain = file_text(folder / "a.nc"), headed = file_text(folder / "b.nc");
  const std::size_t from = headed.find("(CAMBER"), to = headed.find("G21");
  ASSERT_NE(from, std::string::npos);
  EXPECT_EQ(headed.substr(0, from) + headed.substr(to), plain);
  const std::string header = headed.substr(from, to - from);
  EXPECT_NE(header.find("(T1 D4 OVERHANG 30 E 600 GPA, 2 FLUTES)\n"), std::string::npos) << header;
  EXPECT_NE(header.find("(INPUTS "), std::string::npos) << header;
  EXPECT_EQ(run_camber(folder, "check --strict b.nc").status, 0);
  write_job(folder, "max_angle_growth_deg = 2.9\n");  // another input, another hash
  ASSERT_EQ(run_camber(folder, "compensate job.toml -o c.nc --header-hash -q").status, 0);
  EXPECT_NE(file_text(folder / "c.nc").find("(INPUTS "), std::string::npos);
  EXPECT_NE(file_text(folder / "c.nc").substr(from, to - from), header);
}

TEST(CompensateCommand, RefusesWhatLeavesTheTravel) {
  const TempFolder folder;
  write_job(folder, "work_offset_mm = [95, 0, 0]\n");
  const auto run = run_camber(folder, "compensate job.toml -o a.nc");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "p.nc:9:1: error: X goes to 103.0000 in machine coordinates here; the axis travels from -100 to "
            "100 [travel]\n    X8.\n    ^\n");
  EXPECT_EQ(files_of(folder), kInputs);
}

TEST(CompensateCommand, RefusesBlocksUnderCutterRadiusCompensation) {
  const TempFolder folder;
  std::string program = kWall;
  program.replace(program.find("G1 X2."), 6, "G10 L12 P1 R0.5\nG1 G42 D1 X2.");
  program.replace(program.find("G0 Z5.\nM30"), 6, "G1 G40 X16.\nG0 Z5.");
  write_job(folder, "", program);
  const auto run = run_camber(folder, "compensate job.toml -o a.nc");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("p.nc:9:1: error: 3 moves to compensate run under cutter radius compensation (G41, G42), from "
                         "here on: the control computes their path"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(files_of(folder), kInputs);
}

TEST(CompensateCommand, UncertaintyGivesABandAndASafeShare) {
  const TempFolder folder;
  write_job(folder);
  folder.write("fit.json", R"({"parameters":[{"name":"ktc_MPa","value":2000,"unit":"MPa","std_error":100},
                               {"name":"krc_MPa","value":700,"unit":"MPa","std_error":50},
                               {"name":"runout_um","value":3,"unit":"um","std_error":1}]})");
  const auto run =
      run_camber(folder, "compensate job.toml -o a.nc --json a.json --uncertainty 10 --uncertainty fit.json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err,
            "camber: warning: --uncertainty: runout_um is not a parameter of the job; ignored [uncertainty]\n");
  const auto band = nlohmann::json::parse(file_text(folder / "a.json"))["uncertainty"];
  ASSERT_EQ(band["groups"].size(), 3u);
  // In rigid coupling the deflection is the force times the compliance: ten per cent of either is ten of the error.
  const double before = nlohmann::json::parse(file_text(folder / "a.json"))["before_um"]["rms"];
  EXPECT_NEAR(band["groups"][0]["rms_um"].get<double>() / before, 0.1, 0.05);
  EXPECT_NEAR(band["groups"][1]["rms_um"].get<double>() / before, 0.1, 0.05);
  EXPECT_GT(band["sigma_rms_um"], band["groups"][0]["rms_um"]);
  EXPECT_GE(band["safe_share"], 0);
  EXPECT_LE(band["safe_share"], 1);
  const auto wrong = run_camber(folder, "compensate job.toml -o b.nc --uncertainty machine.toml");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_EQ(wrong.err,
            "machine.toml: error: has no standard error; output of fit-force or fit-feed (with -o or --json), or a "
            "percentage, was expected [uncertainty]\n");
}

TEST(CompensateCommand, MeasuredPointsSetTheModelRight) {
  const TempFolder folder;
  write_job(folder);
  // The truth bends by 1.3 of what the job says.
  std::string truth = file_text(folder / "job.toml");
  truth.replace(truth.find("overhang_mm"), 0, "youngs_modulus_GPa = 461.538461538\n");
  folder.write("truth.toml", truth);
  ASSERT_EQ(run_camber(folder, "predict truth.toml -o t -q").status, 0);
  const auto run = run_camber(folder, "compensate job.toml -o a.nc --json a.json --measured t/form_error.csv");
  ASSERT_EQ(run.status, 0) << run.err << run.out;
  const auto measured = nlohmann::json::parse(file_text(folder / "a.json"))["measured"];
  EXPECT_NEAR(measured["deflection_scale"], 1.3, 0.02);
  EXPECT_LT(measured["std_error"], 0.01);
  // Points beside the part tell nothing; neither does a table without normals.
  folder.write("far.csv", "x y z nx ny nz error\n50 0 0 0 0 1 5\n51 0 0 0 0 1 5\n");
  const auto far = run_camber(folder, "compensate job.toml -o b.nc --measured far.csv");
  EXPECT_EQ(far.status, 1);
  EXPECT_EQ(far.err,
            "far.csv: error: 0 of 2 points lie on a surface that the job machines; three or more were expected "
            "[measured-not-identifiable]\n");
  folder.write("bad.csv", "x,y,z,nx,ny,nz,error\n1,2,3,0,0,1,five\n");
  const auto bad = run_camber(folder, "compensate job.toml -o b.nc --measured bad.csv");
  EXPECT_EQ(bad.status, 1);
  EXPECT_EQ(bad.err,
            "bad.csv:2:13: error: error_um is \"five\"; a number was expected [measured-number]\n    1,2,3,0,0,1,five\n"
            "                ^\n");
}

// --- runs that end early
// ----------------------------------------------------------------------------------------------

TEST(CompensateCommand, AFullDiskLeavesTheOldFile) {
  const TempFolder folder;
  write_job(folder);
  folder.write("a.nc", "OLD\n");
  folder.write("r.json", "OLD\n");
  const std::string command = "cd '" + folder.path() +
                              "' && { (ulimit -f 0; exec '" CAMBER_EXECUTABLE
                              "' compensate job.toml -o a.nc --json r.json -q); echo status $?; } 2>&1 | cat > said";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(file_text(folder / "a.nc"), "OLD\n");
  EXPECT_EQ(file_text(folder / "r.json"), "OLD\n");
  EXPECT_EQ(file_text(folder / "said"),
            "a.nc: error: could not be written to its end (is the disk full?) [file-unwritable]\n"
            "r.json: error: could not be written to its end (is the disk full?) [file-unwritable]\nstatus 1\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.nc.part"));
}

TEST(CompensateCommand, AReadOnlyFolderIsSaidAndNothingIsWritten) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const TempFolder folder;
  write_job(folder);
  std::filesystem::create_directory(folder / "locked");
  chmod((folder / "locked").c_str(), 0500);
  const auto run = run_camber(folder, "compensate job.toml -o locked/a.nc -q");
  chmod((folder / "locked").c_str(), 0700);
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err, "locked/a.nc: error: cannot be written: Permission denied [file-unwritable]\n");
}

TEST(CompensateCommand, ATargetThatIsAFolderIsSaidAndNothingIsLeft) {
  const TempFolder folder;
  write_job(folder);
  std::filesystem::create_directory(folder / "a.nc");
  const auto run = run_camber(folder, "compensate job.toml -o a.nc -q");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "a.nc: error: cannot be written: it is a folder; the name of a file was expected [file-unwritable]\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.nc.part"));
}

/// Where one output cannot be written, the others are, and the figures are printed.
TEST(CompensateCommand, WhatFitsOnTheDiskIsWritten) {
  const TempFolder folder;
  write_job(folder);
  constexpr const char* kSmall = "16";  // blocks of 512 bytes: the program and the figures fit, the page does not
  const std::string command = "cd '" + folder.path() + "' && { (ulimit -f " + kSmall +
                              "; exec '" CAMBER_EXECUTABLE
                              "' compensate job.toml -o a.nc --json r.json --report r.html); echo status $?; } 2>&1 | "
                              "cat > said";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const std::string said = file_text(folder / "said");
  EXPECT_NE(said.find("largest shift"), std::string::npos) << said;
  EXPECT_NE(said.find("r.html: error: could not be written to its end (is the disk full?) [file-unwritable]\n"),
            std::string::npos)
      << said;
  EXPECT_TRUE(said.ends_with("status 1\n")) << said;
  EXPECT_TRUE(file_text(folder / "a.nc").ends_with("M30\n%\n"));
  EXPECT_TRUE(nlohmann::json::accept(file_text(folder / "r.json")));
  EXPECT_FALSE(std::filesystem::exists(folder / "r.html"));
  EXPECT_FALSE(std::filesystem::exists(folder / "r.html.part"));
}

/// Ends camber while it works.
void expect_nothing_written_after(int signal, int milliseconds) {
  const TempFolder folder;
  write_job(folder);
  folder.write("a.nc", "OLD\n");
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    std::signal(signal, SIG_DFL);  // a shell's background jobs ignore SIGINT, and so would camber
    if (chdir(folder.path().c_str()) != 0) _exit(99);
    execl(CAMBER_EXECUTABLE, CAMBER_EXECUTABLE, "compensate", "job.toml", "-o", "a.nc", "-q",
          static_cast<char*>(nullptr));
    _exit(99);
  }
  usleep(static_cast<useconds_t>(1000 * milliseconds));
  kill(child, signal);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(file_text(folder / "a.nc"), "OLD\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.nc.part"));
}

TEST(CompensateCommand, AnInterruptedRunLeavesTheOldFile) {
  for (const int milliseconds : {0, 15, 40}) expect_nothing_written_after(SIGINT, milliseconds);
}
TEST(CompensateCommand, AnEndedRunLeavesTheOldFile) {
  for (const int milliseconds : {0, 15, 40}) expect_nothing_written_after(SIGTERM, milliseconds);
}

}  // namespace
}  // namespace camber
