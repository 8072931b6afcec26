// camber check on machines with rotary axes.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/geometry.h"
#include "tests/support/ball_job.h"
#include "tests/support/csv_columns.h"
#include "tests/support/open_page.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::run_camber;
using tests::TempFolder;

const std::string kSamples = CAMBER_SOURCE_DIR "/samples/kinematics/";
const std::string kFiveAxis = CAMBER_SOURCE_DIR "/samples/12-five-axis/";

void copy_machine(const TempFolder& folder, const std::string& name) {
  std::filesystem::copy_file(kSamples + name + ".toml", folder / "m.toml");
}

TEST(ExplainKinematics, PrintsEverySampleMachine) {
  const TempFolder folder;
  for (const auto& entry : std::filesystem::directory_iterator(kSamples)) {
    const auto run = run_camber(folder, "check --explain-kinematics '" + entry.path().string() + "'");
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.err, "");
    EXPECT_NE(run.out.find("└ spindle, tool along +Z\n"), std::string::npos) << run.out;
  }
}

TEST(ExplainKinematics, WritesJson) {
  const TempFolder folder;
  copy_machine(folder, "table_bc");
  const auto run = run_camber(folder, "check --explain-kinematics m.toml --json r.json");
  EXPECT_EQ(run.status, 0) << run.err;
  const auto json = nlohmann::json::parse(tests::file_text(folder / "r.json"));
  EXPECT_EQ(json["machine"], "m.toml");
  EXPECT_EQ(json["machine_type"], "table-table");
  ASSERT_EQ(json["axes"].size(), 5U);
  EXPECT_EQ(json["axes"][0]["axis"], "C");
  EXPECT_EQ(json["axes"][0]["axis_type"], "rotary");
  EXPECT_EQ(json["axes"][0]["carried_by"], "table");
  EXPECT_EQ(json["axes"][4]["carried_by"], "head");
  EXPECT_NE(run.out.find(json["axes"][1]["positive"].get<std::string>()), std::string::npos);
  EXPECT_EQ(json["reach"].size(), 2U);
}

TEST(ExplainKinematics, TakesTheMachineOfAJob) {
  const TempFolder folder;
  copy_machine(folder, "head_head");
  folder.write("p.nc", "G21\nM30\n");
  folder.write("job.toml", tests::ball_job({.machine = "m.toml"}));
  const auto run = run_camber(folder, "check --explain-kinematics job.toml");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out.find("m.toml: head-head\n"), 0U) << run.out;
}

TEST(ExplainKinematics, SaysWhatIsMissing) {
  const TempFolder folder;
  folder.write("m.toml", "[axis.x]\n");
  auto run = run_camber(folder, "check --explain-kinematics m.toml");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(run.err,
            "m.toml: error: [kinematics] is missing; a chain from the part to the spindle was expected "
            "[kinematics-missing]\n");
  run = run_camber(folder, "check --explain-kinematics none.toml");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("none.toml: error: "), std::string::npos) << run.err;
  EXPECT_NE(run_camber(folder, "check").status, 0);
  EXPECT_NE(run_camber(folder, "check p.nc --explain-kinematics m.toml").status, 0);
}

constexpr const char* kProgram = R"(G21 G90 G17 G40 G49 G80
G10 L2 P1 X10. Y5. Z-300.
G54 G0 X0 Y0 Z100. S5000 M3
G234 H1
G1 X20. B30. C90. F500
X450.
G49
M30
)";

TEST(CheckFiveAxes, ReadsTheProgramAndChecksTheTravel) {
  const TempFolder folder;
  copy_machine(folder, "table_bc");
  folder.write("p.nc", kProgram);
  const auto run = run_camber(folder, "check p.nc --machine m.toml --tool-length 1=100");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(
      run.err,
      "p.nc:6:1: error: Y goes to -445 mm in machine coordinates; -400 to 400 was expected (travel_mm of [axis.y]) "
      "[travel]\n    X450.\n    ^\n");
  const auto bad = run_camber(folder, "check p.nc --machine m.toml --tool-length 1:100");
  EXPECT_NE(bad.status, 0);
  EXPECT_NE(bad.err.find("1:100: a number of H and a length in mm were expected, such as 1=80"), std::string::npos);
}

/// G43 and G43.4 alone move nothing: the length counts from the next move on, which starts where the machine is.
TEST(CheckFiveAxes, TakesTheToolLengthFromWhereTheMachineIs) {
  const TempFolder folder;
  folder.write("m.toml", tests::file_text(kFiveAxis + "machine.toml"));
  for (const char* code : {"G43", "G43.4"}) {
    folder.write("p.nc", std::string("G21 G90 G94\nG10 L2 P1 X0 Y0 Z-320.\nG10 L10 P1 R120.\nT1 M6\n"
                                     "G54 G0 X0 Y0 Z310. S900 M3\n") +
                             code + " H1\nG0 X10. Y0 Z150.\nG1 X20. A10. F500\nM30\n");
    const auto run = run_camber(folder, "check p.nc --machine m.toml");  // Z has 10 mm left: 310 + 120 would be beyond
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.err, "");
  }
  folder.write("p.nc",
               "G21 G90 G94\nG10 L2 P1 X0 Y0 Z-320.\nG10 L10 P1 R120.\nT1 M6\nG54 G0 X0 Y0 Z310. S900 M3\n"
               "G43 H1\nG0 X10. Y0 Z210.\nG1 X20. A10. F500\nM30\n");
  const auto run = run_camber(folder, "check p.nc --machine m.toml");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "p.nc:7:1: error: Z goes to 10 mm in machine coordinates in this move and 1 more; -400 to 0 was expected "
            "(travel_mm of [axis.z]) [travel]\n    G0 X10. Y0 Z210.\n    ^\n");
}

TEST(CheckFiveAxes, SaysWhatItCannotCheck) {
  const TempFolder folder;
  copy_machine(folder, "table_bc");
  folder.write("p.nc", kProgram);
  const auto run = run_camber(folder, "check p.nc --machine m.toml");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("the travel of X, Y and Z is not checked, as the tool length (--tool-length) is not known "
                         "[travel-unchecked]"),
            std::string::npos)
      << run.err;
  EXPECT_NE(
      run.err.find("p.nc:5:1: error: the joints of this move under tool-centre-point control depend on the length "
                   "of tool T0, which is not known; --tool-length H=MM, or its value (G10 L1) in the program, was "
                   "expected [tool-length]\n    G1 X20. B30. C90. F500\n    ^\n"),
      std::string::npos)
      << run.err;
  const auto known = run_camber(folder, "check p.nc --machine m.toml --tool-length 1=100");
  EXPECT_EQ(known.err.find("[tool-length]"), std::string::npos) << known.err;
}

/// Without tool-centre-point control the travel alone needs a length.
TEST(CheckFiveAxes, NeedsNoToolLengthWithoutTipControl) {
  const TempFolder folder;
  copy_machine(folder, "table_bc");
  folder.write("p.nc",
               "G21 G90 G94 G17 G40 G49 G80\nG10 L2 P1 X10. Y5. Z-300.\nG54 G0 X0 Y0 Z100. S5000 M3\nG43 H1\n"
               "G1 X20. B30. C90. F500\nM30\n");
  const auto run = run_camber(folder, "check p.nc --machine m.toml");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("[travel-unchecked]"), std::string::npos) << run.err;
}

// --- check, time and feed

/// A fan on the machine of samples/machines/linuxcnc_five_axis.toml.
const char* const kFan =
    "G21 G90 G94\nG64 P0.01\nG10 L2 P1 X25 Y-15 Z5\nG54 T1 M6 S1000 M3\nG43 H1\nM428\n"
    "G0 X-20 Y5 Z10 A0 C15\nG1 X20 A-45 F600\nG1 A-40 F600\nG93 G1 X10 F30\nM429\nM2\n";

void write_fan(const TempFolder& folder) {
  folder.write("m.toml", tests::file_text(CAMBER_SOURCE_DIR "/samples/machines/linuxcnc_five_axis.toml"));
  folder.write("p.nc", kFan);
}

TEST(CheckFiveAxes, SaysWhatFCounts) {
  const TempFolder folder;
  write_fan(folder);
  const auto run = run_camber(folder, "check p.nc --machine m.toml --tool-length 1=80 --json r.json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("F         mm/min of the tip in the part's frame: 1 block, first in line 8\n"
                         "F         degrees/min of the rotary axes: 1 block, first in line 9\n"
                         "F         1/min of the block (G93): 1 block, first in line 10\n"),
            std::string::npos)
      << run.out;
  const auto json = nlohmann::json::parse(tests::file_text(folder / "r.json"));
  ASSERT_EQ(json["feed_meanings"].size(), 3U);
  EXPECT_EQ(json["feed_meanings"][1]["meaning"], "degrees");
  EXPECT_EQ(json["feed_meanings"][1]["moves"], 1);
  EXPECT_EQ(json["feed_meanings"][1]["first_line"], 9);
}

TEST(FeedFiveAxes, WritesJointsAndPoses) {
  const TempFolder folder;
  write_fan(folder);
  const auto run = run_camber(folder, "feed p.nc --machine m.toml --tool-length 1=80 -o feed.csv --json r.json");
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string csv = tests::file_text(folder / "feed.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "t_s,block,x_mm,y_mm,z_mm,vx_mm_per_min,vy_mm_per_min,vz_mm_per_min,feed_cmd_mm_per_min,feed_mm_per_min,"
            "a_deg,c_deg,tip_x_mm,tip_y_mm,tip_z_mm,axis_x,axis_y,axis_z");
  const auto columns = camber::tests::columns_of(csv);
  const std::size_t last = columns.at("t_s").size() - 1;
  EXPECT_NEAR(columns.at("a_deg")[last], -40, 1e-4);
  EXPECT_NEAR(columns.at("tip_x_mm")[last], 10, 1e-4);
  EXPECT_NEAR(columns.at("tip_z_mm")[last], 10, 1e-4);
  EXPECT_NEAR(columns.at("axis_z")[last], std::cos(40 * std::acos(-1.0) / 180), 1e-7);
  const auto json = nlohmann::json::parse(tests::file_text(folder / "r.json"));
  EXPECT_GE(json["contour"]["tip_max_um"], 0);
  // time agrees to the microsecond
  const auto time = run_camber(folder, "time p.nc --machine m.toml --tool-length 1=80 --json t.json");
  ASSERT_EQ(time.status, 0) << time.err;
  const auto timed = nlohmann::json::parse(tests::file_text(folder / "t.json"));
  const double positioning = timed["positioning_s"], cutting = timed["cutting_s"];
  EXPECT_NEAR(positioning + cutting, json["time_s"], 1e-6);
}

/// Tool-centre-point control is switched with turned axes: the tip goes on from where the axes are.
TEST(FeedFiveAxes, AxesDoNotJump) {
  const TempFolder folder;
  std::filesystem::copy(CAMBER_SOURCE_DIR "/samples/12-five-axis", folder / "s");
  const auto run = run_camber(folder, "feed s/dome.nc --machine s/machine.toml -o feed.csv --report r.html");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto columns = camber::tests::columns_of(tests::file_text(folder / "feed.csv"));
  const auto& block = columns.at("block");
  for (const char* axis : {"x_mm", "y_mm", "z_mm", "a_deg", "c_deg"}) {
    const auto& q = columns.at(axis);
    for (std::size_t i = 1; i < q.size(); ++i)
      ASSERT_LT(std::abs(q[i] - q[i - 1]), 0.5) << axis << " in line " << block[i];
  }
  const std::string page = tests::file_text(folder / "r.html");
  EXPECT_NE(page.find("Feed of s/dome.nc"), std::string::npos);
  EXPECT_NE(page.find("time, s"), std::string::npos);
  EXPECT_EQ(page.find("The positions of the axes are not known"), std::string::npos);
}

/// From sample to sample, with the speeds of samples/12-five-axis.
void expect_no_jumps(const std::map<std::string, std::vector<double>>& columns) {
  constexpr double kPeriodS = 0.001, kRounding = 2e-5;
  const std::map<std::string, double> max_per_s{
      {"x_mm", 500}, {"y_mm", 500}, {"z_mm", 400}, {"a_deg", 100}, {"c_deg", 14000.0 / 60}};
  for (const auto& [axis, speed] : max_per_s) {
    const auto& q = columns.at(axis);
    for (std::size_t i = 1; i < q.size(); ++i)
      ASSERT_LE(std::abs(q[i] - q[i - 1]), speed * kPeriodS + kRounding)
          << axis << " in line " << columns.at("block")[i];
  }
}

/// Whatever switches what X, Y and Z mean, the axes go on from where they are.
TEST(FeedFiveAxes, AxesDoNotJumpWhereverTheirMeaningIsSwitched) {
  const TempFolder folder;
  std::filesystem::copy(CAMBER_SOURCE_DIR "/samples/12-five-axis", folder / "s");
  const std::string start = "G21 G90 G94\nG10 L2 P1 X0 Y0 Z-320.\nG10 L10 P1 R120.\nT1 M6\nG54 S9000 M3\n";
  const std::vector<std::string> programs{
      "G0 X5 Y5\nG53 Z0\nG43.4 H1\nG0 X0 Y0 Z50.\nG1 A20. C30. F900\nX20.\nG49\nG0 X0 Y0 Z150.\nG53 Z0\n",
      "G0 X5 Y5 Z160.\nG68.2 X1 Y2 Z3 I20. J30. K10.\nG53.1\nG43 H1\nG0 X9.\nZ30.\nG1 X20. F900\nG69\nG49\nG28 Z0\n"
      "G0 X1. Y1. Z170.\nA0 C0\n",
      "G0 X5 Y5 Z160.\nG43 H1\nG0 X0 Z40.\nG254\nG0 A20. C10.\nX0 Y0 Z40.\nG1 X20. F900\nG255\nG53 Z0\nG30 X0\n",
      "G53 X10. Y10.\nG53 Z-10.\nG43 H1\nG0 X0\nG0 Y5. Z30. A15.\nG49\nX5.\nG43 H1 Z30.\nG28 A0 C0\nG28 X0 Y0 Z30.\n"};
  for (const std::string& program : programs) {
    SCOPED_TRACE(program);
    folder.write("p.nc", start + program + "M30\n");
    const auto run = run_camber(folder, "feed p.nc --machine s/machine.toml -o feed.csv");
    ASSERT_EQ(run.status, 0) << run.err;
    expect_no_jumps(camber::tests::columns_of(tests::file_text(folder / "feed.csv")));
  }
}

/// Two faces in tilted frames: every move takes its time, the last pose is where check says that the machine ends.
TEST(FeedFiveAxes, ReadsTiltedFrames) {
  const TempFolder folder;
  std::filesystem::copy(CAMBER_SOURCE_DIR "/samples/12-five-axis", folder / "s");
  const auto run = run_camber(folder, "feed s/faces.nc --machine s/machine.toml -o feed.csv --json f.json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const auto columns = camber::tests::columns_of(tests::file_text(folder / "feed.csv"));
  expect_no_jumps(columns);
  EXPECT_NEAR(columns.at("t_s").back(), 59.206, 0.05);
  EXPECT_EQ(columns.at("block").back(), 73);
  EXPECT_EQ(columns.at("z_mm").front(), 0);  // where G53 Z0 in line 8 leaves it
  const auto time = run_camber(folder, "time s/faces.nc --machine s/machine.toml --json t.json --report t.html");
  ASSERT_EQ(time.status, 0) << time.err;
  EXPECT_EQ(time.err, "");
  const auto feed = nlohmann::json::parse(tests::file_text(folder / "f.json")),
             timed = nlohmann::json::parse(tests::file_text(folder / "t.json"));
  const double positioning = timed["positioning_s"], cutting = timed["cutting_s"];
  EXPECT_NEAR(positioning + cutting, feed["time_s"], 1e-6);
  EXPECT_NEAR(timed["index_s"], 3 * 2 * 0.4, 1e-9);  // M11 and M13, three times
  EXPECT_EQ(timed["notes"].size(), 1U);              // tool changes take no time on this machine
  EXPECT_GT(feed["contour"]["tip_max_um"], 0);
  const std::string page = tests::file_text(folder / "t.html");
  EXPECT_NE(page.find("id=\"machine\""), std::string::npos);
  EXPECT_NE(page.find("<h2>Where the time goes</h2>"), std::string::npos);
  EXPECT_NE(page.find("<h2>Axes</h2>"), std::string::npos);
}

/// A way of which the end is not known takes that to where the axis is next known, and is named.
TEST(TimeFiveAxes, NamesWaysToUnknownReferencePoints) {
  const TempFolder folder;
  folder.write("m.toml", tests::file_text(kFiveAxis + "machine.toml"));
  const std::string start = "G21 G90 G94\nG10 L2 P1 X0 Y0 Z-320.\nG54 S9000 M3\nG0 X0 Y0 Z0\n";
  folder.write("p.nc", start + "G28 G91 Z0\nG90 A10. C20.\nG0 Z160.\nG30 G91 X0 Y0\nG90 G0 X0 Y0\nM30\n");
  const std::string warning =
      "p.nc:5:1: warning: Z goes to a reference point that is not known; this move, like 1 more to such points, takes "
      "the time of the shortest way to where the axes are next known. z_mm of [tool_change] in m.toml was expected "
      "[reference-unknown]\n    G28 G91 Z0\n    ^\n";
  for (const char* command : {"check p.nc --machine m.toml", "time p.nc --machine m.toml --json t.json",
                              "feed p.nc --machine m.toml -o feed.csv"}) {
    const auto run = run_camber(folder, command);
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.err, warning) << command;
  }
  expect_no_jumps(camber::tests::columns_of(tests::file_text(folder / "feed.csv")));
  const auto timed = nlohmann::json::parse(tests::file_text(folder / "t.json"));
  EXPECT_EQ(timed["notes"].size(), 0U);
  EXPECT_GE(timed["unplaced_moves"], 3);
  const auto positioning_s = [&](const std::string& program) {
    folder.write("p.nc", start + program);
    EXPECT_EQ(run_camber(folder, "time p.nc --machine m.toml --json t.json").status, 0);
    return nlohmann::json::parse(tests::file_text(folder / "t.json"))["positioning_s"].get<double>();
  };
  const std::string program = tests::file_text(folder / "p.nc").substr(start.size());
  const double up_s = positioning_s("G0 Z160.\nA10. C20.\nM30\n");
  EXPECT_NEAR(timed["positioning_s"].get<double>(), up_s, 1e-3);
  const double higher_s = positioning_s("G0 Z320.\nZ0\nZ320.\nA10. C20.\nG0 Z160.\nM30\n") -
                          positioning_s("G0 Z320.\nM30\n");  // Z stands at 320 before the program
  folder.write("m.toml", tests::file_text(kFiveAxis + "machine.toml") +
                             "[tool_change]\nz_mm = 320\n[reference_point.2]\nx_mm = 0\ny_mm = 0\n");
  folder.write("p.nc", start + program);
  EXPECT_EQ(run_camber(folder, "check p.nc --machine m.toml").err, "");
  EXPECT_EQ(run_camber(folder, "time p.nc --machine m.toml --json t.json").err, "");
  const auto known = nlohmann::json::parse(tests::file_text(folder / "t.json"));
  EXPECT_NEAR(known["positioning_s"].get<double>(), higher_s, 1e-3);
}

TEST(TimeFiveAxes, ThePageSaysWhyItHasNoMachine) {
  const TempFolder folder;
  write_fan(folder);
  folder.write("p.nc", "G21 G90 G94\nG0 X0 Y0 Z0\nG1 X1 A5 F100\nM2\n");
  const auto run = run_camber(folder, "time p.nc --machine m.toml --report t.html");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("note: the machine is not drawn: the work offset (G10 L2 in the program, or --work-offset) or "
                         "the tool length (--tool-length) is not known\n"),
            std::string::npos)
      << run.out;
  const std::string page = tests::file_text(folder / "t.html");
  EXPECT_EQ(page.find("id=\"machine\""), std::string::npos);
  EXPECT_NE(page.find("The path"), std::string::npos);
}

TEST(TimeFiveAxes, ShowsTheMachineAlongTheProgram) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  const auto run = run_camber(folder, "time '" + kFiveAxis + "dome.nc' --machine '" + kFiveAxis +
                                          "machine.toml' --report r.html --json r.json");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(tests::open_page("machine", folder / "r.html"), "");
}

TEST(FeedFiveAxes, ThePageTurnsThePartAndMovesTheAxes) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  for (const char* command : {"time", "feed"}) {
    const auto run = run_camber(folder, std::string(command) + " '" + kFiveAxis + "faces.nc' --machine '" + kFiveAxis +
                                            "machine.toml' --report r.html");
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(tests::open_page("faces", folder / "r.html"), "") << command;
  }
}

TEST(FeedFiveAxes, ThePageNeedsRotaryMotion) {
  const TempFolder folder;
  write_fan(folder);
  folder.write("p.nc", "G21 G90 G94\nG0 X0 Y0 Z0\nG1 X1 F100\nM2\n");
  const auto run = run_camber(folder, "feed p.nc --machine m.toml --report r.html");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("p.nc: error: turns no rotary axis of the machine, and the page of feed shows those; camber "
                         "check --report shows programs of three axes [no-rotary-motion]"),
            std::string::npos)
      << run.err;
}

TEST(FeedFiveAxes, BadInputByWholeMessage) {
  const TempFolder folder;
  write_fan(folder);
  const auto error_of = [&](const std::string& command) { return run_camber(folder, command).err; };
  EXPECT_EQ(error_of("feed p.nc --machine m.toml"),
            "p.nc:8:1: error: the joints of this move under tool-centre-point control depend on the length of tool T1, "
            "which is not known; --tool-length H=MM, or its value (G10 L1) in the program, was expected [tool-length]\n"
            "    G1 X20 A-45 F600\n    ^\n");
  folder.write("p.nc", "G21 G90 G94\nS1000 M3\nG43 H1\nM428\nG0 X0 Y0 Z0\nG1 X1 A-5 F100\nM2\n");
  EXPECT_EQ(error_of("time p.nc --machine m.toml --tool-length 1=80"), "");
  EXPECT_EQ(
      error_of("feed p.nc --machine m.toml --tool-length 1=80"),
      "p.nc:6:1: error: the joints of this move under tool-centre-point control depend on the work offset, which "
      "is not known; its value (G10 L2, or --work-offset) was expected [work-offset]\n    G1 X1 A-5 F100\n    ^\n");
  const std::string tilted = "G68.2 J30.\nG53.1\nG43 H1\nG0 X0 Y0 Z0\nG1 X9 F100\nM2\n";
  folder.write("p.nc", "G21 G90 G94\nG10 L2 P1 X0 Y0 Z0\nG54 G0 X0 Y0 Z50\n" + tilted);
  EXPECT_EQ(error_of("time p.nc --machine m.toml"),
            "p.nc:7:1: error: the joints of this move in a tilted frame (G68.2) depend on the length of tool T0, which "
            "is not known; --tool-length H=MM, or its value (G10 L1) in the program, was expected [tool-length]\n"
            "    G0 X0 Y0 Z0\n    ^\n");
  folder.write("p.nc", "G21 G90 G94\nG0 X0 Y0 Z50\n" + tilted);
  EXPECT_EQ(
      error_of("time p.nc --machine m.toml --tool-length 1=80"),
      "p.nc:4:1: error: the joints of this move in a tilted frame (G68.2) depend on the work offset, which is not "
      "known; its value (G10 L2, or --work-offset) was expected [work-offset]\n    G53.1\n    ^\n");
  folder.write("p.nc", "G21 G90 G93\nG0 X0 Y0 Z0\nG1 X1 A1 F10\nG1 X2 A2\nM2\n");
  EXPECT_EQ(error_of("time p.nc --machine m.toml"),
            "p.nc:4:1: error: G1 in inverse time (G93) without F; every cutting block needs its own F [feed-missing]\n"
            "    G1 X2 A2\n    ^\n");
  folder.write("p.nc", "G21 G90 G94\nM428\nG0 X0 Y0 Z0 A-5\nM2\n");
  EXPECT_EQ(error_of("time p.nc --machine m.toml"),
            "p.nc:2:1: warning: M428 without G43: tool-centre-point control with a tool length of 0 [tool-length]\n"
            "    M428\n    ^\n");
  folder.write("p.nc", "G21 G90 G94\nG10 L2 P1 X0 Y0 Z0\nG54\nG43 H1\nM428\nG0 X0 Y0 Z0 A-1\nG1 X1 C180 F3000\nM2\n");
  EXPECT_EQ(error_of("time p.nc --machine m.toml --tool-length 1=80"),
            "p.nc:7:1: warning: the feed asks up to 540000 degrees/min of C, but m.toml allows 6000 "
            "(max_velocity_deg_per_min of [axis.c]); the control slows down here [rotary-speed]\n    G1 X1 C180 F3000\n"
            "    ^\n");
  folder.write("m.toml", tests::file_text(kSamples + "table_ac_linuxcnc.toml"));
  EXPECT_NE(error_of("time p.nc --machine m.toml --tool-length 1=80")
                .find("p.nc:7:1: warning: C turns here, but [axis.c] of m.toml has no max_velocity_deg_per_min and no "
                      "acceleration_deg_per_s2; the axis is taken to turn without that limit [rotary-limits]\n"),
            std::string::npos);
}

/// check, time and feed say the same of the same input, and write nothing where it is wrong.
TEST(FiveAxisCommands, SayTheSameOfBadInput) {
  const TempFolder folder;
  write_fan(folder);
  const std::string machine = tests::file_text(folder / "m.toml");
  const auto with = [&](const std::string& key, const std::string& line) {
    const auto from = machine.find(key), to = machine.find('\n', from);
    return machine.substr(0, from) + line + machine.substr(to);
  };
  const std::string head = "G21 G90 G94 S1000 M3\nG10 L2 P1 X0 Y0 Z0\nG54\nG43 H1\nM428\nG0 X0 Y0 Z0 A-1\n";
  const struct {
    std::string machine, program, message;
    bool refused = true;
  } cases[] = {
      {with("chain = ", "chain = [\"part\", \"c\", \"a\", \"bed\", \"x\", \"y\", \"spindle\"]"), "M2\n",
       "m.toml:14:9: error: axis z is missing in the chain; x, y and z were expected [chain-axis]\n    chain = "
       "[\"part\", "
       "\"c\", \"a\", \"bed\", \"x\", \"y\", \"spindle\"]\n            ^\n"},
      {machine, "G21 G90 G93 S1000 M3\nG0 X0 Y0 Z0\nG1 X1 A1 F10\nG1 X2 A2\nM2\n",
       "p.nc:4:1: error: G1 in inverse time (G93) without F; every cutting block needs its own F [feed-missing]\n"
       "    G1 X2 A2\n    ^\n"},
      {machine, "G21 G90 G94 S1000 M3\nM428\nG0 X0 Y0 Z0 A-5\nM2\n",
       "p.nc:2:1: warning: M428 without G43: tool-centre-point control with a tool length of 0 [tool-length]\n"
       "    M428\n    ^\n",
       false},
      {with("[axis.y]", "[axis.y]\ntravel_mm = [-10, 10]"), head + "G1 X1 C30 F100\nM2\n",
       "p.nc:7:1: error: Y goes to -12.787 mm in machine coordinates; -10 to 10 was expected (travel_mm of [axis.y]) "
       "[travel]\n    G1 X1 C30 F100\n    ^\n"},
      {machine, head + "G1 X1 C180 F3000\nM2\n",
       "p.nc:7:1: warning: the feed asks up to 540000 degrees/min of C, but m.toml allows 6000 "
       "(max_velocity_deg_per_min of [axis.c]); the control slows down here [rotary-speed]\n    G1 X1 C180 F3000\n"
       "    ^\n",
       false}};
  for (const auto& one : cases) {
    folder.write("m.toml", one.machine);
    folder.write("p.nc", one.program);
    for (const char* command : {"check p.nc", "time p.nc --json out", "feed p.nc -o out"}) {
      std::filesystem::remove(folder / "out");
      const auto run = run_camber(folder, std::string(command) + " --machine m.toml --tool-length 1=80");
      EXPECT_EQ(run.status, one.refused ? 1 : 0) << command;
      EXPECT_EQ(run.err, one.message) << command;
      EXPECT_EQ(std::filesystem::exists(folder / "out"), !one.refused && command[0] != 'c') << command;
    }
  }
}

TEST(CheckFiveAxes, OtherCommandsRefuseTheProgramByName) {
  const TempFolder folder;
  copy_machine(folder, "table_bc");
  folder.write("p.nc", kProgram);
  for (const char* command : {"resegment p.nc --machine m.toml --tolerance-mm 0.01 -o out.nc", "check p.nc"}) {
    const auto run = run_camber(folder, command);
    EXPECT_EQ(run.status, 1) << command;
    EXPECT_NE(run.err.find("p.nc:4:1: error: G234 (tool-centre-point control) is read on a machine with [kinematics], "
                           "by camber check, time, feed, fit-feed, predict, compensate and post [not-read]"),
              std::string::npos)
        << run.err;
    EXPECT_NE(
        run.err.find("p.nc:5:9: error: rotary axis B is read on a machine with [kinematics], by camber check, time, "
                     "feed, fit-feed, predict, compensate and post; X, Y and Z were expected [rotary-axis]"),
        std::string::npos)
        << run.err;
  }
}

TEST(CheckFiveAxes, CountsRotaryMovesOfTheSample) {
  const TempFolder folder;
  for (const char* name : {"dome", "faces"}) {
    const auto run = run_camber(
        folder, "check '" + kFiveAxis + name + ".nc' --machine '" + kFiveAxis + "machine.toml' --json r.json");
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.err, "");
    const auto moves = nlohmann::json::parse(tests::file_text(folder / "r.json"))["moves"];
    const bool dome = name == std::string("dome");
    EXPECT_GT(moves["rotary"], dome ? 300 : 2);
    EXPECT_EQ(moves["tip_control"] > 0, dome);
    EXPECT_EQ(moves["tilted_frame"] > 0, !dome);
    EXPECT_NE(run.out.find(" of them turning rotary axes\n"), std::string::npos) << run.out;
    EXPECT_NE(run.out.find(dome ? "under tool-centre-point control" : "in a tilted frame (G68.2)"), std::string::npos);
  }
}

TEST(CheckFiveAxes, TakesTheWorkOffsetFromTheCommandLine) {
  const TempFolder folder;
  copy_machine(folder, "table_bc");
  std::string text = kProgram;
  text.erase(text.find("G10"), text.find("G54") - text.find("G10"));
  folder.write("p.nc", text);
  const std::string command = "check p.nc --machine m.toml --tool-length 1=100 --work-offset ";
  const auto run = run_camber(folder, command + "G54=10,5,-300");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("p.nc:5:1: error: Y goes to -445 mm in machine coordinates"), std::string::npos) << run.err;
  EXPECT_EQ(run_camber(folder, command + "G54=-40,5,-300").status, 0);
  const auto tip = run_camber(folder, command + "G54=-40,5,-300,0,0,5");
  EXPECT_NE(tip.err.find("tool-centre-point control with a work offset of a rotary axis is not supported; offsets A0 "
                         "B0 C0 were expected (and 1 more like it) [rotary-offset]"),
            std::string::npos)
      << tip.err;
  for (const char* bad : {"G54=1,2", "G60=1,2,3", "54=1,2,3", "G54=1,2,x", "G54.1P0=1,2,3"})
    EXPECT_NE(run_camber(folder, command + bad).err.find("a work offset and its machine coordinates were expected"),
              std::string::npos)
        << bad;
}

TEST(CheckFiveAxes, ShowsTheMachineAlongTheProgram) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  for (const char* name : {"dome", "faces"}) {
    const auto run = run_camber(folder, "check '" + kFiveAxis + name + ".nc' --machine '" + kFiveAxis +
                                            "machine.toml' --report r.html --json r.json");
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(tests::open_page("machine", folder / "r.html", folder / "r.json"), "") << name;
  }
}

/// Ends of the feed moves as the words of a text have them.
std::vector<Vec3> programmed_places(const std::string& program) {
  std::vector<Vec3> out;
  Vec3 at = Vec3::Zero();
  std::istringstream lines(program);
  const std::regex word("([XYZ])(-?[0-9.]+)");
  for (std::string line; std::getline(lines, line);) {
    for (std::sregex_iterator w(line.begin(), line.end(), word), end; w != end; ++w)
      at[(*w)[1].str()[0] - 'X'] = std::stod((*w)[2]);
    if (line.starts_with("X") || line.starts_with("G1 ")) out.push_back(at);
  }
  return out;
}

/// Under tool-centre-point control X, Y and Z are the tip on the part. Posted, they are the linear axes.
TEST(CheckFiveAxes, WritesThePathOfTheTipOnThePart) {
  const TempFolder folder;
  const std::string machine = " --machine '" + kFiveAxis + "machine.toml'", dome = kFiveAxis + "dome.nc";
  ASSERT_EQ(run_camber(folder, "post '" + dome + "' -o joints.nc" + machine).status, 0);
  const auto farthest_from_path = [&](const std::vector<Vec3>& places, const std::string& program) {
    EXPECT_EQ(run_camber(folder, "check '" + program + "' --path p.bin" + machine).status, 0);
    const std::string text = tests::file_text(folder / "p.bin");
    const std::size_t end = text.find('\n');
    const auto head = nlohmann::json::parse(text.substr(0, end));
    EXPECT_EQ(head["in_part"], true);
    const auto n = head["points"].get<std::size_t>();
    double most = 0;
    for (const Vec3& place : places) {
      double least = 1e9;
      for (std::size_t i = 0; i < n; ++i) {
        Vec3 p;
        for (std::size_t a = 0; a < 3; ++a) {
          float v = 0;
          std::memcpy(&v, text.data() + end + 1 + 4 * (n * a + i), sizeof v);
          p[static_cast<Eigen::Index>(a)] = v + head["origin_mm"][a].get<double>();
        }
        least = std::min(least, (p - place).norm());
      }
      most = std::max(most, least);
    }
    return most;
  };
  const auto tips = programmed_places(tests::file_text(dome)),
             linear_axes = programmed_places(tests::file_text(folder / "joints.nc"));
  ASSERT_GT(tips.size(), 300U);
  EXPECT_LT(farthest_from_path(tips, dome), 1e-4);
  EXPECT_LT(farthest_from_path(tips, "joints.nc"), 0.01);  // the tolerance of post, and rounding of the words
  EXPECT_GT(farthest_from_path(linear_axes, "joints.nc"), 1);
}

TEST(CheckFiveAxes, ThePageShowsWhatLeavesItsTravel) {
  const TempFolder folder;
  copy_machine(folder, "table_bc");
  folder.write("p.nc", kProgram);
  const auto run = run_camber(folder, "check p.nc --machine m.toml --tool-length 1=100 --report r.html");
  EXPECT_EQ(run.status, 1);
  const std::string page = tests::file_text(folder / "r.html");
  EXPECT_NE(page.find("Y goes to -445 mm in machine coordinates"), std::string::npos);
  EXPECT_NE(page.find("<td>6</td>"), std::string::npos);  // the first line beyond the travel of Y
}

}  // namespace
}  // namespace camber
