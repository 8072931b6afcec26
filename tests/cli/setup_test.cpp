// A wrong set-up never looks like a perfect part: what check, predict, compensate and feed say of it, word for word.
#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/geometry.h"
#include "tests/support/csv_columns.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::CamberRun;
using tests::replaced;
using tests::run_camber;
using tests::TempFolder;

const std::string kMachine =
    "[axis.x]\nmax_velocity_mm_per_min = 3000\n[axis.y]\n[axis.z]\n[spindle]\nmax_rpm = 12000\n";
/// A slot of 2 mm along X through a block from x = 0 to 8.
const std::string kSlot =
    "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X-4 Y0 Z5\nG0 Z-2\nG1 X12 F900\nG0 Z5\nM30\n";
/// A slot in wax: in steel this end mill would bend by more than the model covers.
const std::string kJob =
    "program = \"p.nc\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"flat\"\ndiameter_mm = 4.0\nflutes = 2\n"
    "overhang_mm = 30.0\n[material]\nktc_MPa = 20.0\nkrc_MPa = 7.0\n[stock]\nbox_mm = [[0, -5, -5], [8, 5, 0]]\n"
    "[simulation]\nvoxel_mm = 0.2\ncoupling = \"rigid\"\n";

struct SetUp {
  std::string program = kSlot, job = kJob, machine = kMachine;
};

void write(const TempFolder& folder, const SetUp& set_up) {
  folder.write("p.nc", set_up.program);
  folder.write("job.toml", set_up.job);
  folder.write("machine.toml", set_up.machine);
}

/// predict and compensate refuse it with the same words and leave nothing; so does check.
void expect_refused(const SetUp& set_up, const std::string& message) {
  const TempFolder folder;
  write(folder, set_up);
  for (const char* command : {"predict job.toml -o result", "compensate job.toml -o out.nc"}) {
    const CamberRun run = run_camber(folder, command);
    EXPECT_EQ(run.status, 1) << command;
    EXPECT_EQ(run.err, message) << command;
    EXPECT_EQ(run.out, "") << command;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "result"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out.nc"));
  const CamberRun run = run_camber(folder, "check p.nc --job job.toml");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err, message);
}

/// feed and check refuse what does not suit the machine with the same words as predict.
void expect_refused_by_machine(const SetUp& set_up, const std::string& message) {
  expect_refused(set_up, message);
  const TempFolder folder;
  write(folder, set_up);
  for (const char* command : {"check p.nc --machine machine.toml", "feed p.nc --machine machine.toml -o feed.csv"}) {
    const CamberRun run = run_camber(folder, command);
    EXPECT_EQ(run.status, 1) << command;
    EXPECT_EQ(run.err, message) << command;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "feed.csv"));
}

TEST(SetUp, TheRightOneIsSaidNothingOf) {
  const TempFolder folder;
  write(folder, {});
  for (const char* command : {"check p.nc --job job.toml", "check p.nc --machine machine.toml",
                              "feed p.nc --machine machine.toml", "predict job.toml -o result"}) {
    const CamberRun run = run_camber(folder, command);
    EXPECT_EQ(run.status, 0) << command;
    EXPECT_EQ(run.err, "") << command;
  }
}

TEST(SetUp, AxisThatTheMachineDoesNotHave) {
  expect_refused_by_machine(
      {.program = replaced(kSlot, "G1 X12 F900", "G1 X12 Y0.5 F900"), .machine = replaced(kMachine, "[axis.y]\n", "")},
      "p.nc:6:1: error: Y moves here, but machine.toml has no [axis.y]; an axis with its limits was expected "
      "[axis-missing]\n    G1 X12 Y0.5 F900\n    ^\n");
}

/// What a control clamps is clamped, said once between two tool changes, and the command goes on.
TEST(SetUp, SpindleSpeedOverTheMachinesIsClamped) {
  const TempFolder folder;
  write(folder, {.program = replaced(kSlot, "S3000", "S20000")});
  const std::string warning =
      "p.nc:6:1: warning: up to S20000 here, but the spindle of machine.toml turns at up to 12000 rpm (max_rpm); it is "
      "clamped to that [spindle-limit]\n    G1 X12 F900\n    ^\n";
  for (const char* command : {"check p.nc --machine machine.toml", "feed p.nc --machine machine.toml -o f.csv",
                              "time p.nc --machine machine.toml", "predict job.toml -o over"}) {
    const CamberRun run = run_camber(folder, command);
    EXPECT_EQ(run.status, 0) << command << run.err;
    EXPECT_NE(run.err.find("[spindle-limit]"), std::string::npos) << command;
  }
  EXPECT_EQ(run_camber(folder, "check p.nc --machine machine.toml").err, warning);
  // The cut is that of the greatest speed.
  folder.write("p.nc", replaced(kSlot, "S3000", "S12000"));
  EXPECT_EQ(run_camber(folder, "predict job.toml -o at").status, 0);
  EXPECT_EQ(tests::file_text(folder / "over/forces.csv"), tests::file_text(folder / "at/forces.csv"));
}

TEST(SetUp, FeedOverAnAxisIsClampedAndSaidOnceInEachOperation) {
  const TempFolder folder;
  write(folder, {.program = "G21 G90\nT1 M6\nS3000 M3\nG0 X0 Y0 Z0\nG1 X10 F9000\nX20\nG0 Y5\nT2 M6\nS3000 M3\n"
                            "G1 X0 F6000\nM30\n"});
  const CamberRun check = run_camber(folder, "check p.nc --machine machine.toml");
  EXPECT_EQ(check.status, 0);
  EXPECT_EQ(check.err,
            "p.nc:5:1: warning: the feed requires up to 9000 mm/min of X in this move and 1 more, but machine.toml "
            "allows 3000 (max_velocity_mm_per_min of [axis.x]); it is clamped to that [feed-limit]\n"
            "    G1 X10 F9000\n    ^\n"
            "p.nc:10:1: warning: the feed requires up to 6000 mm/min of X, but machine.toml allows 3000 "
            "(max_velocity_mm_per_min of [axis.x]); it is clamped to that [feed-limit]\n"
            "    G1 X0 F6000\n    ^\n");
  EXPECT_EQ(run_camber(folder, "time p.nc --machine machine.toml").status, 0);
  // Along the diagonal each axis moves more slowly than the tool.
  write(folder, {.program = "G21 G90\nT1 M6\nS3000 M3\nG0 X0 Y0 Z0\nG1 X10 Y10 F4200\nM30\n"});
  EXPECT_EQ(run_camber(folder, "check p.nc --machine machine.toml").err, "");
  // In an arc the feed comes to be along X, wherever it begins.
  folder.write("p.nc",
               "G21 G90 G17\nT1 M6\nS3000 M3\nG0 X0 Y0 Z0\nG2 X10 Y10 I10 J0 F4200\nG2 X10 Y-10 I0 J-10\nM30\n");
  EXPECT_EQ(run_camber(folder, "check p.nc --machine machine.toml").err,
            "p.nc:5:1: warning: the feed requires up to 4200 mm/min of X in this move and 1 more, but machine.toml "
            "allows 3000 (max_velocity_mm_per_min of [axis.x]); it is clamped to that [feed-limit]\n"
            "    G2 X10 Y10 I10 J0 F4200\n"
            "    ^\n");
}

TEST(SetUp, MissingSpindleSpeed) {
  expect_refused_by_machine({.program = replaced(kSlot, "S3000 M3", "M3")},
                            "p.nc:6:1: error: T1 cuts here with the spindle at S0; S above zero and M3 were expected "
                            "[spindle-stopped]\n    G1 X12 F900\n    ^\n");
}

TEST(SetUp, MissingStartOfTheSpindle) {
  expect_refused_by_machine({.program = replaced(kSlot, "S3000 M3", "S3000")},
                            "p.nc:6:1: error: T1 cuts here with the spindle stopped; S above zero and M3 were expected "
                            "[spindle-stopped]\n    G1 X12 F900\n    ^\n");
}

TEST(SetUp, AnMFunctionOfTheMachineMayStartTheSpindle) {
  const TempFolder folder;
  write(folder, {.program = replaced(kSlot, "S3000 M3", "S3000 M203")});
  for (const char* command : {"check p.nc --machine machine.toml", "check --job job.toml"}) {
    const CamberRun run = run_camber(folder, command);
    EXPECT_EQ(run.status, 0) << command << run.err;
    EXPECT_NE(run.err.find("[spindle-assumed]"), std::string::npos) << command << run.err;
  }
}

TEST(SetUp, AToolMayLeaveTheCutWithTheSpindleStopped) {
  const TempFolder folder;
  write(folder, {.program = replaced(kSlot, "G0 Z5\nM30", "M5\nG1 Z5 F2000\nM30")});
  for (const char* command : {"check p.nc --machine machine.toml", "check --job job.toml"}) {
    const CamberRun run = run_camber(folder, command);
    EXPECT_EQ(run.status, 0) << command;
    EXPECT_EQ(run.err, "") << command;
  }
  write(folder, {.program = replaced(kSlot, "G0 Z5\nM30", "M5\nG1 X6 Z5 F2000\nM30")});
  EXPECT_EQ(run_camber(folder, "check --job job.toml").status, 1);
}

TEST(SetUp, SpindleTheWrongWay) {
  expect_refused_by_machine({.program = replaced(kSlot, "M3\n", "M4\n")},
                            "p.nc:6:1: error: T1 cuts here under M4, but cutters are right-hand; M3 was expected "
                            "[spindle-direction]\n    G1 X12 F900\n    ^\n");
}

TEST(SetUp, WithoutAToolNumberNobodyKnowsWhatM4Turns) {
  const TempFolder folder;
  folder.write("m4.nc", "G21 G90\nS3000 M4\nG0 X0 Y0 Z0\nG1 X10 F600\nM30\n");
  const CamberRun run = run_camber(folder, "check m4.nc");
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err,
            "m4.nc:4:1: warning: T0 cuts here under M4, but cutters are right-hand; M3 was expected "
            "[spindle-direction]\n    G1 X10 F600\n    ^\n");
}

TEST(SetUp, ProgramThatRunsInAirIsWarnedOfAndTimed) {
  const TempFolder folder;
  write(folder, {.program = "G21 G90\nG0 X0 Y0 Z0\nG1 X10 F600\nM30\n"});
  for (const char* command : {"check p.nc --machine machine.toml", "feed p.nc --machine machine.toml"}) {
    const CamberRun run = run_camber(folder, command);
    EXPECT_EQ(run.status, 0) << command;
    EXPECT_EQ(run.err,
              "p.nc:3:1: warning: the program never starts a spindle; S above zero and M3 were expected, unless it "
              "runs in air [spindle-stopped]\n    G1 X10 F600\n    ^\n")
        << command;
  }
}

TEST(SetUp, ChecksOfAProgramAlone) {
  const TempFolder folder;
  folder.write("m4.nc", "G21\nT1 M6\nS1000 M4\nG0 X0 Y0 Z0\nG1 X10 F9995000\nX20\nM30\n");
  const CamberRun wrong = run_camber(folder, "check m4.nc");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_EQ(wrong.err,
            "m4.nc:5:1: warning: the feed is 9995000 mm/min at most in this move and 1 more; no more than 100000 was "
            "expected of a milling machine (unit? G93 or G95?) [feed-absurd]\n    G1 X10 F9995000\n    ^\n"
            "m4.nc:5:1: error: T1 cuts here under M4, but cutters are right-hand; M3 was expected "
            "[spindle-direction]\n    G1 X10 F9995000\n    ^\n");
  folder.write("s0.nc", "G21\nT1 M6\nM3\nG0 X0 Y0 Z0\nG1 X10 F100\nM30\n");
  EXPECT_EQ(run_camber(folder, "check s0.nc").err,
            "s0.nc:5:1: error: T1 cuts here with the spindle at S0; S above zero and M3 were expected "
            "[spindle-stopped]\n    G1 X10 F100\n    ^\n");
}

TEST(SetUp, CheckOfAJobFindsCollisionsAsPredictDoes) {
  const TempFolder folder;
  write(folder, {.program = replaced(kSlot, "G0 X-4 Y0 Z5\nG0 Z-2", "G0 X-4 Y0 Z5\nG0 X4 Y0 Z5\nG0 Z-2\nG0 X-4")});
  const CamberRun check = run_camber(folder, "check p.nc --job job.toml"),
                  predict = run_camber(folder, "predict job.toml -o result");
  EXPECT_EQ(check.status, 1);
  EXPECT_EQ(check.err, predict.err);
  EXPECT_NE(check.err.find("[collision-rapid]"), std::string::npos) << check.err;
}

TEST(SetUp, StockThatLiesElsewhere) {
  expect_refused({.job = replaced(kJob, "[[0, -5, -5], [8, 5, 0]]", "[[100, -5, -5], [108, 5, 0]]")},
                 "p.nc: error: nothing is removed: the tip of the tool cuts from X-4.00 Y0.00 Z-2.00 to X12.00 Y0.00 "
                 "Z-2.00, the stock lies from X100.00 Y-5.00 Z-5.00 to X108.00 Y5.00 Z0.00; moves through the stock "
                 "were expected [nothing-removed]\n");
}

TEST(SetUp, PathAboveTheStock) {
  expect_refused({.program = replaced(kSlot, "G0 Z-2", "G0 Z0.5")},
                 "p.nc: error: nothing is removed: the tip of the tool cuts from X-4.00 Y0.00 Z0.50 to X12.00 Y0.00 "
                 "Z0.50, the stock lies from X0.00 Y-5.00 Z-5.00 to X8.00 Y5.00 Z0.00; moves through the stock were "
                 "expected [nothing-removed]\n");
}

TEST(SetUp, ProgramInInchesReadAsMillimetres) {
  // 100 mm from the zero, so that the figures in inches pass the stock by.
  expect_refused({.program = replaced(replaced(kSlot, "G0 X-4 Y0 Z5", "G0 X3.7 Y0 Z0.2"), "X12 F900", "X4.5 F36"),
                  .job = replaced(kJob, "[[0, -5, -5], [8, 5, 0]]", "[[95, -5, -60], [115, 5, 0]]")},
                 "p.nc: error: nothing is removed: the tip of the tool cuts from X3.70 Y0.00 Z-2.00 to X4.50 Y0.00 "
                 "Z-2.00, the stock lies from X95.00 Y-5.00 Z-60.00 to X115.00 Y5.00 Z0.00; the program would fit at "
                 "25.4 times its size: are its figures inches (G20, units = \"inch\")? [nothing-removed]\n");
}

TEST(SetUp, StockInInches) {
  expect_refused({.program = replaced(replaced(kSlot, "G0 X-4 Y0 Z5", "G0 X94 Y0 Z5"), "X12 F900", "X116 F900"),
                  .job = replaced(kJob, "[[0, -5, -5], [8, 5, 0]]", "[[3.74, -0.2, -0.2], [4.53, 0.2, 0]]")},
                 "p.nc: error: nothing is removed: the tip of the tool cuts from X94.00 Y0.00 Z-2.00 to X116.00 Y0.00 "
                 "Z-2.00, the stock lies from X3.74 Y-0.20 Z-0.20 to X4.53 Y0.20 Z0.00; the stock would fit at 25.4 "
                 "times its size: is it in inches? [nothing-removed]\n");
  // The same where both begin at zero and the path cuts the small stock away.
  const std::string rows = replaced(kSlot, "G1 X12 F900", "G1 X12 F900\nG1 Y10\nG1 X-4");
  expect_refused({.program = rows, .job = replaced(kJob, "[[0, -5, -5], [8, 5, 0]]", "[[0, 0, -0.2], [0.4, 0.4, 0]]")},
                 "p.nc: error: the stock is as large as the program at 25.4 times its size: the tip of the tool cuts "
                 "from X-4.00 Y0.00 Z-2.00 to X12.00 Y10.00 Z-2.00, the stock lies from X0.00 Y0.00 Z-0.20 to X0.40 "
                 "Y0.40 Z0.00; a stock in mm was expected [stock-units]\n");
}

/// A closed box.
std::string box_stl(const Vec3& lo, const Vec3& hi) {
  const auto corner = [&](int i) {
    return "vertex " + std::to_string(i & 1 ? hi.x() : lo.x()) + " " + std::to_string(i & 2 ? hi.y() : lo.y()) + " " +
           std::to_string(i & 4 ? hi.z() : lo.z()) + "\n";
  };
  constexpr int kTriangles[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                     {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  std::string out = "solid box\n";
  for (const auto& t : kTriangles) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const int c : t) out += corner(c);
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid box\n";
}

TEST(SetUp, PartInInches) {
  const TempFolder folder;
  write(folder, {.job = kJob + "[part]\nmesh = \"part.stl\"\n"});
  folder.write("part.stl", box_stl(Vec3(0, -5, -5) / 25.4, Vec3(8, 5, -1) / 25.4));
  const std::string message =
      "part.stl: error: the part is as large as the stock at 25.4 times its size: the part is 0.31 x 0.39 x 0.16 mm, "
      "the stock 8.00 x 10.00 x 5.00 mm; a mesh in mm was expected [part-units]\n";
  for (const char* command :
       {"check p.nc --job job.toml", "predict job.toml -o result", "compensate job.toml -o o.nc"}) {
    const CamberRun run = run_camber(folder, command);
    EXPECT_EQ(run.status, 1) << command;
    EXPECT_EQ(run.err, message) << command;
  }
}

TEST(SetUp, AllowanceLargerThanTheCut) {
  expect_refused(
      {.job = replaced(kJob, "[simulation]", "allowance_mm = 2.5\n[simulation]")},
      "job.toml: error: allowance_mm = 2.5: the cut before, with the cutter smaller by this much, removes nothing from "
      "the stock; an allowance smaller than the depth of cut was expected [allowance-too-large]\n");
}

TEST(SetUp, CutAboveTheFlutes) {
  const std::string neck = "flute_length_mm = 1.0\nneck_diameter_mm = 2.0\nneck_length_mm = 20\n[material]";
  expect_refused({.job = replaced(kJob, "[material]", neck) + "collisions = \"off\"\n"},
                 "p.nc:6:1: error: T1 meets material 2.0 mm above its tip, but flute_length_mm = 1; a cut that its "
                 "flutes reach was expected [cut-above-flutes]\n    G1 X12 F900\n    ^\n");
}

TEST(SetUp, CutAboveTheOverhang) {
  expect_refused({.job = replaced(kJob, "overhang_mm = 30.0", "overhang_mm = 1.5")},
                 "job.toml: warning: T1: overhang_mm = 1.5 is less than its diameter, 4 mm; at least that was expected "
                 "(holder face to tip) [tool-slender]\n"
                 "p.nc:6:1: error: T1 meets material 2.0 mm above its tip, but overhang_mm = 1.5; a cut that ends "
                 "below the holder was expected [cut-above-overhang]\n    G1 X12 F900\n    ^\n");
}

TEST(SetUp, AnAssumedOverhangRefusesNothing) {
  const TempFolder folder;
  write(folder, {.program = replaced(kSlot, "G1 X12 F900", "G1 X6 F900\nX12"),
                 .job = replaced(kJob, "overhang_mm = 30.0", "overhang_mm = 1.5\nassumed = [\"overhang_mm\"]")});
  const CamberRun run = run_camber(folder, "check --job job.toml");
  EXPECT_EQ(run.status, 0);
  EXPECT_NE(run.err.find("p.nc:6:1: warning: T1 meets material 2.0 mm above its tip, but overhang_mm = 1.5, which is "
                         "assumed; the length that the tool has was expected, or a stock that is cut so far "
                         "[cut-above-overhang]\n    G1 X6 F900\n    ^\n"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(run.err.find("[cut-above-overhang]"), run.err.rfind("[cut-above-overhang]")) << run.err;
}

TEST(SetUp, AnAssumedBlankRefusesNothing) {
  const TempFolder folder;
  std::string job = replaced(kJob, "overhang_mm = 30.0", "overhang_mm = 30.0\nflute_length_mm = 1.5");
  job = replaced(job, "[stock]", "[stock]\nassumed = [\"box_mm\"]") + "collisions = \"warning\"\n";
  write(folder, {.program = replaced(kSlot, "G1 X12 F900", "G1 X6 F900\nX12"), .job = job});
  const CamberRun run = run_camber(folder, "check --job job.toml");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("p.nc:6:1: warning: T1 meets material 2.0 mm above its tip, but flute_length_mm = 1.5, in a "
                         "blank that is assumed; the blank as it is at that line was expected [cut-above-flutes]\n"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(run.err.find("[cut-above-flutes]"), run.err.rfind("[cut-above-flutes]")) << run.err;
}

TEST(SetUp, SecondCutMayGoDeeperThanTheFlutes) {
  const TempFolder folder;
  write(folder, {.program = replaced(kSlot, "G1 X12 F900", "G1 X12 F900\nG0 Z5\nX-4\nZ-4\nG1 X12"),
                 .job = replaced(kJob, "[material]",
                                 "flute_length_mm = 2.5\nneck_diameter_mm = 3.0\nneck_length_mm = 20\n[material]")});
  const CamberRun run = run_camber(folder, "predict job.toml -o result");
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err, "");
}

TEST(SetUp, SlenderToolIsRefused) {
  expect_refused(
      {.job = replaced(kJob, "overhang_mm = 30.0", "overhang_mm = 61.0")},
      "job.toml: error: T1: overhang_mm = 61 is 15.2 times its diameter; no more than 15 times was expected: "
      "a longer tool is no static beam (diameter_mm and overhang_mm are in mm) [tool-slender]\n");
}

TEST(SetUp, DeflectionBeyondTheModelHasNoFigures) {
  const TempFolder folder;
  write(folder, {.job = replaced(kJob, "ktc_MPa = 20.0", "ktc_MPa = 2000.0")});
  const CamberRun run = run_camber(folder, "predict job.toml -o result");
  EXPECT_EQ(run.status, 3);
  const auto json = nlohmann::json::parse(tests::file_text(folder / "result/summary.json"));
  const auto& beyond = json["beyond_model"];
  EXPECT_GT(beyond["deflection_um"]["max"], beyond["deflection_um"]["limit"]);
  EXPECT_EQ(run.err, "camber: error: in " + std::to_string(beyond["tooth_passings"].get<int>()) +
                         " tooth passings the tool deflects further than the model covers, by up to " +
                         std::to_string(std::lround(beyond["deflection_um"]["max"].get<double>())) + " um where " +
                         std::to_string(std::lround(beyond["deflection_um"]["limit"].get<double>())) +
                         " um are covered, in line 6: no figures; a shorter or thicker tool or a smaller cut was "
                         "expected\n");
  EXPECT_NE(run.out.find("force, deflection and form error: beyond the model's range\n"), std::string::npos) << run.out;
}

/// A slot as deep as the model bends the tool, and a shallow one that is longer.
TEST(SetUp, WhatIsBeyondTheModelIsInNoFigure) {
  const TempFolder folder;
  write(folder, {.program = replaced(kSlot, "G0 Z-2\nG1 X12 F900\nG0 Z5",
                                     "G0 Z-2\nG1 X4 F900\nG0 Z5\nX-4 Y8\nZ-0.2\nG1 X24\nG0 Z5"),
                 .job = replaced(replaced(kJob, "[[0, -5, -5], [8, 5, 0]]", "[[0, -5, -5], [20, 12, 0]]"),
                                 "ktc_MPa = 20.0", "ktc_MPa = 2000.0")});
  const CamberRun run = run_camber(folder, "predict job.toml -o result");
  EXPECT_EQ(run.status, 3) << run.err;
  const auto json = nlohmann::json::parse(tests::file_text(folder / "result/summary.json"));
  const auto& beyond = json["beyond_model"];
  const double share = beyond["share"];
  EXPECT_GT(share, 0.1);
  EXPECT_LT(share, 0.5);
  EXPECT_EQ(beyond["lines"], nlohmann::json::array({6}));
  // The figures again from the rows that are valid.
  double area = 0, invalid = 0, squares = 0;
  auto points = tests::columns_of(tests::file_text(folder / "result/form_error.csv"));
  for (std::size_t i = 0; i < points["valid"].size(); ++i) {
    area += points["area_mm2"][i];
    if (points["valid"][i] == 0) {
      invalid += points["area_mm2"][i];
      EXPECT_LT(points["y_mm"][i], 5) << "the shallow slot is valid";
    } else {
      squares += points["area_mm2"][i] * std::pow(points["error_um"][i], 2);
    }
  }
  EXPECT_NEAR(invalid / area, share, 1e-4);
  EXPECT_NEAR(std::sqrt(squares / (area - invalid)), json["form_error_um"]["rms"], 0.01);
  double force = 0;
  auto rows = tests::columns_of(tests::file_text(folder / "result/forces.csv"));
  for (std::size_t i = 0; i < rows["valid"].size(); ++i) {
    EXPECT_TRUE(rows["valid"][i] == 1 || rows["block"][i] == 6) << "the shallow slot is valid";
    if (rows["valid"][i] == 1) force = std::max(force, rows["f_max_N"][i]);
  }
  EXPECT_NEAR(force, json["force_N"]["max"], 0.01);
  EXPECT_NE(run.err.find(" of the surface and "), std::string::npos) << run.err;
  EXPECT_NE(run.out.find("beyond the model, in no figure: "), std::string::npos) << run.out;
}

TEST(SetUp, NothingLeftToJudge) {
  const TempFolder folder;
  write(folder, {.program = replaced(kSlot, "G0 Z-2", "G0 Z-6"),
                 .job = replaced(kJob, "[[0, -5, -5], [8, 5, 0]]", "[[0, -1, -5], [8, 1, 0]]")});
  const CamberRun run = run_camber(folder, "predict job.toml -o result");
  EXPECT_EQ(run.status, 3);
  const std::string ending =
      "camber: error: the program leaves no surface in the stock, so there is no form error to judge; a stock of which "
      "material remains was expected\n";
  EXPECT_TRUE(run.err.ends_with(ending)) << run.err;
}

}  // namespace
}  // namespace camber
