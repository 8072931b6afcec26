// camber check on machines with rotary axes.
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/ball_job.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::run_camber;
using tests::TempFolder;

const std::string kSamples = CAMBER_SOURCE_DIR "/samples/kinematics/";

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

TEST(CheckFiveAxes, SaysWhatItCannotCheck) {
  const TempFolder folder;
  copy_machine(folder, "table_bc");
  folder.write("p.nc", kProgram);
  const auto run = run_camber(folder, "check p.nc --machine m.toml");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("the travel of X, Y and Z is not checked, as the tool length (--tool-length) is not known "
                         "[travel-unchecked]"),
            std::string::npos)
      << run.err;
}

TEST(CheckFiveAxes, OtherCommandsRefuseTheProgramByName) {
  const TempFolder folder;
  copy_machine(folder, "table_bc");
  folder.write("p.nc", kProgram);
  for (const char* command : {"feed p.nc --machine m.toml", "time p.nc --machine m.toml", "check p.nc"}) {
    const auto run = run_camber(folder, command);
    EXPECT_EQ(run.status, 1) << command;
    EXPECT_NE(
        run.err.find("p.nc:4:1: error: G234 (tool centre point control of five axes) is not supported [not-read]"),
        std::string::npos)
        << run.err;
    EXPECT_NE(run.err.find("p.nc:5:9: error: rotary axis B is read by camber check --machine alone, on a machine with "
                           "[kinematics]; X, Y and Z were expected [rotary-axis]"),
              std::string::npos)
        << run.err;
  }
}

}  // namespace
}  // namespace camber
