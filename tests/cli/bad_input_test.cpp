// A user's first run: every wrong input is met with its place, what is wrong and what was expected, and leaves no file.
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/ball_job.h"
#include "tests/support/run_camber.h"
#include "tests/support/wall_job.h"

namespace camber {
namespace {

using tests::CamberRun;
using tests::run_camber;
using tests::TempFolder;

constexpr const char* kHeader = "G21 G90 G17 G40 G49 G80 G54\n";
constexpr const char* kCut = "G0 X5. Y1. Z5.\nG1 Z-0.2 F300\nX-1. F900\nG0 Z5.\nM30\n";

/// A small job with the given lines between the header and the cut.
void write_job(const TempFolder& folder, const std::string& start, const std::string& job = tests::ball_job()) {
  folder.write("p.nc", kHeader + start + kCut);
  folder.write("machine.toml", "[axis.x]\n[axis.y]\n[axis.z]\n[spindle]\nmax_rpm = 12000\n");
  folder.write("job.toml", job);
}

CamberRun check(std::string_view program) {
  const TempFolder folder;
  folder.write("p.nc", program);
  return run_camber(folder, "check -q p.nc");
}

/// What predict says about a wrong job; it must not have made its folder.
std::string predict_error(const TempFolder& folder) {
  const auto run = run_camber(folder, "predict job.toml -o result");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.out, "");
  EXPECT_FALSE(std::filesystem::exists(folder / "result"));
  return run.err;
}

/// What fit-feed says about a wrong trace; no machine file may be left.
std::string trace_error(std::string_view trace) {
  const TempFolder folder;
  folder.write("p.nc", "G21 G90 G17 G94\nG0 X0 Y0 Z0\nG1 X1. F600\nM2\n");
  folder.write("machine.toml", "[axis.x]\nmax_velocity_mm_per_min = 6000\n");
  folder.write("t.csv", trace);
  const auto run = run_camber(folder, "fit-feed --program p.nc --trace t.csv --machine machine.toml -o fitted.toml");
  EXPECT_EQ(run.status, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "fitted.toml"));
  EXPECT_FALSE(std::filesystem::exists(folder / "fitted.toml.part"));
  return run.err;
}

TEST(BadInput, FitFeedDrawsNoSpeedsOfATableOfTimes) {
  const TempFolder folder;
  folder.write("p.nc", "G21 G90 G17 G94\nG0 X0 Y0 Z0\nG1 X1. F600\nM2\n");
  folder.write("machine.toml", "[axis.x]\nmax_velocity_mm_per_min = 6000\n");
  folder.write("t.csv", "first_line,last_line,time_s\n3,3,0.2\n");
  const auto run =
      run_camber(folder, "fit-feed --program p.nc --trace t.csv --machine machine.toml -o f.toml --report f.html");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "t.csv: error: has no speeds by line; --report needs a servo trace that names its lines [fit-report]\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "f.toml"));
}

TEST(BadInput, MissingAndEmptyFiles) {
  const TempFolder folder;
  folder.write("empty.nc", "");
  folder.write("empty.toml", "\n");
  EXPECT_EQ(run_camber(folder, "check none.nc").err, "none.nc: error: no such file [file-missing]\n");
  EXPECT_EQ(run_camber(folder, "check .").err, ".: error: is a folder; a file was expected [file-unreadable]\n");
  const auto empty = run_camber(folder, "check empty.nc");
  EXPECT_EQ(empty.status, 1);
  EXPECT_EQ(empty.err, "empty.nc: error: the file is empty; an NC program was expected [empty-program]\n");
  EXPECT_EQ(run_camber(folder, "predict none.toml -o result").err, "none.toml: error: no such file [file-missing]\n");
  EXPECT_EQ(run_camber(folder, "predict empty.toml -o result").err,
            "empty.toml: error: the file is empty; a job description (program, machine, [tool.1], [material], "
            "[stock] ...) was expected [file-empty]\n");
}

TEST(BadInput, NotANumberInAProgram) {
  const auto run = check("G21\nG1 Xnan F100\nM30\n");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "p.nc:2:4: error: XNAN is not a number; a number such as X12.5 was expected [not-a-number]\n"
            "    G1 Xnan F100\n"
            "       ^\n");
}

TEST(BadInput, UnknownWords) {
  const auto run = check("G21 G90\nG0 X0 Y0 Z0\nG1 X1. F100\n@foo\nM30\n");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "p.nc:4:1: error: `@` is not expected here; a word (a letter and a number) or a comment was expected "
            "[unexpected-character]\n"
            "    @foo\n"
            "    ^\n");
}

TEST(BadInput, CuttingWithoutFeed) {
  const auto run = check("G21 G90\nG0 X0 Y0 Z0\nG1 X1.\nM30\n");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "p.nc:3:1: error: G1 without a feed; F greater than zero was expected before or in this block "
            "[feed-missing]\n"
            "    G1 X1.\n"
            "    ^\n");
}

TEST(BadInput, FeedOfZeroWithCarriageReturns) {
  const auto run = check("G21 G90\r\nG0 X0 Y0 Z0\r\nG1 X1. F0\r\nM30\r\n");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "p.nc:3:8: error: F0 on a cutting move (G1); the feed must be greater than zero [feed-zero]\n"
            "    G1 X1. F0\n"
            "           ^\n");
}

TEST(BadInput, ArcRadiiThatDiffer) {
  const auto run = check("G21 G90 G17\nG0 X0 Y0 Z0\nG2 X10. Y0 I4. J0 F100\nM30\n");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "p.nc:3:1: error: the radius of the arc is 4.0000 mm at its start and 6.0000 mm at its end; a difference "
            "below 0.05 mm was expected [arc-radius]\n"
            "    G2 X10. Y0 I4. J0 F100\n"
            "    ^\n");
}

TEST(BadInput, ToolThatTheJobDoesNotHave) {
  const TempFolder folder;
  write_job(folder, "T2 M6\nS3000 M3\n");
  EXPECT_EQ(predict_error(folder),
            "p.nc:5:1: error: T2 cuts here, but the job has no [tool.2] [tool-missing]\n"
            "    G1 Z-0.2 F300\n"
            "    ^\n");
}

TEST(BadInput, CuttingWithoutSpindle) {
  const TempFolder folder;
  write_job(folder, "T1 M6\nS0 M3\n");
  EXPECT_EQ(predict_error(folder),
            "p.nc:5:1: error: T1 cuts here with the spindle at S0; S above zero and M3 were expected "
            "[spindle-stopped]\n"
            "    G1 Z-0.2 F300\n"
            "    ^\n");
}

TEST(BadInput, SpindleTheWrongWay) {
  const TempFolder folder;
  write_job(folder, "T1 M6\nS3000 M4\n");
  EXPECT_EQ(predict_error(folder),
            "p.nc:5:1: error: T1 cuts here under M4, but cutters are right-hand; M3 was expected [spindle-direction]\n"
            "    G1 Z-0.2 F300\n"
            "    ^\n");
}

TEST(BadInput, NotANumberInAJob) {
  const TempFolder folder;
  write_job(folder, "T1 M6\nS3000 M3\n", tests::replaced(tests::ball_job(), "voxel_mm = 0.2", "voxel_mm = nan"));
  EXPECT_EQ(predict_error(folder),
            "job.toml:14:12: error: voxel_mm is nan; a number greater than zero was expected [value-range]\n"
            "    voxel_mm = nan\n"
            "               ^\n");
}

TEST(BadInput, VoxelsThatNeedMoreMemoryThanThereIs) {
  const TempFolder folder;
  std::string job = tests::replaced(tests::ball_job(), "[[0, 0, -2], [4, 2, 0]]", "[[0, 0, -200], [400, 200, 0]]");
  job = tests::replaced(std::move(job), "voxel_mm = 0.2", "voxel_mm = 0.0001");
  write_job(folder, "T1 M6\nS3000 M3\n", job);
  const std::string message = predict_error(folder);
  // How much is free differs from computer to computer.
  const std::string begin = "job.toml:14:12: error: voxel_mm = 0.0001 needs about ";
  EXPECT_EQ(message.substr(0, begin.size()), begin);
  EXPECT_NE(message.find(" GB for a stock of 400 x 200 x 200 mm and "), std::string::npos) << message;
  EXPECT_NE(message.find(" GB are available; voxel_mm = "), std::string::npos) << message;
  EXPECT_NE(message.find(" or a smaller stock was expected [voxel-memory]\n"), std::string::npos) << message;
}

TEST(BadInput, MoreMemoryThanTheJobAllows) {
  const TempFolder folder;
  write_job(folder, "T1 M6\nS3000 M3\n",
            tests::replaced(tests::ball_job(), "voxel_mm = 0.2\n", "voxel_mm = 0.2\nmax_memory_GB = 0.01\n"));
  const std::string message = predict_error(folder);
  EXPECT_NE(message.find("job.toml:14:12: error: voxel_mm = 0.2 needs about "), std::string::npos) << message;
  EXPECT_NE(message.find(", but 0.01 GB are allowed (max_memory_GB); "), std::string::npos) << message;
}

TEST(BadInput, MeshThatIsNoStl) {
  const TempFolder folder;
  write_job(folder, "T1 M6\nS3000 M3\n",
            tests::replaced(tests::ball_job(), "box_mm = [[0, 0, -2], [4, 2, 0]]", "mesh = \"blank.stl\""));
  folder.write("blank.stl", "hello\n");
  EXPECT_EQ(predict_error(folder),
            "blank.stl: error: is not an STL file: neither 84 + 50 n bytes nor the word 'facet' [stl-format]\n");
  folder.write("blank.stl", "");
  EXPECT_EQ(predict_error(folder), "blank.stl: error: is empty; an STL file was expected [stl-empty]\n");
}

TEST(BadInput, CompensateLeavesNothingBehind) {
  const TempFolder folder;
  write_job(folder, "T1 M6\nS0 M3\n");
  const auto run = run_camber(folder, "compensate job.toml -o out.nc --report r.html --json r.json");
  EXPECT_EQ(run.status, 1);
  for (const char* name : {"out.nc", "out.nc.part", "r.html", "r.html.part", "r.json", "r.json.part"})
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
}

TEST(BadInput, OutputThatIsAnInput) {
  const TempFolder folder;
  write_job(folder, "T1 M6\nS3000 M3\n");
  const std::string before = tests::file_text(folder / "p.nc");
  const auto run = run_camber(folder, "compensate job.toml -o ./p.nc");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "./p.nc: error: would be overwritten, but it is an input; another name was expected [output-is-input]\n");
  EXPECT_EQ(tests::file_text(folder / "p.nc"), before);
}

TEST(BadInput, TracesThatAreNone) {
  EXPECT_EQ(trace_error(""),
            "t.csv: error: the trace is empty; a header line that names the columns is expected [trace-empty]\n");
  EXPECT_EQ(trace_error("t_s,x_act_mm\n0,1\n"),
            "t.csv: error: the trace has 1 samples; at least two are needed [trace-empty]\n");
}

TEST(BadInput, NotANumberInATrace) {
  EXPECT_EQ(trace_error("t_s,x_cmd_mm,x_act_mm,line\n0,0,0,2\n0.001,nan,0,3\n0.002,0,0,3\n"),
            "t.csv:3:7: error: x_cmd_mm is \"nan\"; a number is expected [trace-number]\n"
            "    0.001,nan,0,3\n"
            "          ^\n");
}

TEST(BadInput, GapInATraceIsAWarningAndAnErrorWhenStrict) {
  const TempFolder folder;
  folder.write("p.nc", "G21 G90 G17 G94\nG0 X0 Y0 Z0\nG1 X1. F600\nM2\n");
  folder.write("machine.toml", "[axis.x]\nmax_velocity_mm_per_min = 6000\n");
  std::string trace = "t_s,x_cmd_mm,x_act_mm,line\n";
  for (int i = 0; i < 100; ++i)
    if (i < 40 || i >= 60) trace += "0.0" + std::string(i < 10 ? "0" : "") + std::to_string(i) + ",0,0,2\n";
  folder.write("t.csv", trace);
  const auto run =
      run_camber(folder, "--strict fit-feed --program p.nc --trace t.csv --machine machine.toml -o f.toml");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "t.csv:42:1: error: 0.02 s are missing before 0.06 s (the samples are 0.001 s apart); the parts before and "
            "after are used separately [trace-gap]\n"
            "    0.060,0,0,2\n"
            "    ^\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "f.toml"));
}

TEST(StandardOutput, ThatIsFullIsAnError) {
  const TempFolder folder;
  folder.write("p.nc", std::string(kHeader) + "T1 M6\nS3000 M3\n" + kCut);
  const CamberRun run = run_camber(folder, "check p.nc > /dev/full 2> said.txt < /dev/null #");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(tests::file_text(folder / "said.txt"),
            "camber: error: standard output cannot be written to its end (is the disk full?) [file-unwritable]\n");
}

/// A folder stands where one table should go. The stock, whose loops run beside the writing of that table, is that of a
/// run without it.
TEST(Outputs, AreWholeBesideOneThatFails) {
  const TempFolder folder;
  tests::write_wall(folder);
  ASSERT_EQ(run_camber(folder, "-q predict job.toml -o whole").status, 0);
  for (const std::string name : {"form_error.csv", "form_error.vtp", "forces.csv", "form_error.ply"}) {
    std::filesystem::create_directories(folder / ("beside-" + name + "/" + name + "/x"));
    const CamberRun run = run_camber(folder, "-q predict job.toml -o beside-" + name);
    EXPECT_EQ(run.status, 1);
    EXPECT_EQ(run.err,
              "beside-" + name + "/" + name + ": error: cannot be written: Is a directory [file-unwritable]\n");
    for (const std::string other : {"stock.vdb", "feed.csv", "form_error.csv", "form_error.vtp", "form_error.ply"}) {
      if (other == name) continue;
      EXPECT_EQ(tests::file_text(folder / ("beside-" + name + "/" + other)),
                tests::file_text(folder / ("whole/" + other)))
          << name << " " << other;
    }
  }
}

}  // namespace
}  // namespace camber
