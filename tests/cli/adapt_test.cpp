// camber adapt from the command line: what it refuses, word for word, and what it writes.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::CamberRun;
using tests::replaced;
using tests::run_camber;
using tests::TempFolder;

const std::string kMachine =
    "[axis.x]\nacceleration_mm_per_s2 = 3000\ntravel_mm = [-50, 50]\n[axis.y]\nacceleration_mm_per_s2 = 3000\n"
    "[axis.z]\nacceleration_mm_per_s2 = 3000\n[spindle]\nmax_rpm = 12000\n";
const std::string kSlot =
    "G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X-6 Y0 Z5\nG0 Z-2\nG1 X14 F300 (slot)\nG0 Z5\nM30\n";
const std::string kAdapt = "[adapt]\nlimits = { force_N = 120.0 }\nfeed_mm_per_min = [50, 2000]\n";
const std::string kJob =
    "program = \"p.nc\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"flat\"\ndiameter_mm = 4.0\nflutes = 2\n"
    "overhang_mm = 15.0\n[material]\nktc_MPa = 800.0\nkrc_MPa = 250.0\nkte_N_per_mm = 5.0\nkre_N_per_mm = 5.0\n"
    "[stock]\nbox_mm = [[0, -5, -5], [8, 5, 0]]\n[simulation]\nvoxel_mm = 0.2\ncoupling = \"rigid\"\n";

struct SetUp {
  std::string program = kSlot, job = kJob + kAdapt, machine = kMachine;
};

CamberRun adapt(const TempFolder& folder, const SetUp& s, const std::string& more = "") {
  folder.write("p.nc", s.program);
  folder.write("job.toml", s.job);
  folder.write("machine.toml", s.machine);
  return run_camber(folder, "adapt job.toml -o out.nc --report out.html --json out.json" + more);
}

/// Nothing is written.
void expect_refused(const SetUp& s, const std::string& message) {
  const TempFolder folder;
  const CamberRun run = adapt(folder, s);
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err, message);
  EXPECT_EQ(run.out, "");
  for (const char* file : {"out.nc", "out.html", "out.json"}) EXPECT_FALSE(std::filesystem::exists(folder / file));
}

TEST(AdaptCommand, WritesProgramPageAndFigures) {
  const TempFolder folder;
  const CamberRun run = adapt(folder, {}, " --sweep");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto json = nlohmann::json::parse(tests::file_text(folder / "out.json"));
  EXPECT_LT(json.at("time_after_s"), json.at("time_before_s"));
  const auto& load = json.at("loads").at(0);
  EXPECT_EQ(load.at("name"), "force_N");
  EXPECT_LT(load.at("max_after").get<double>(), 1.02 * 120);
  EXPECT_GT(load.at("max_after").get<double>(), 0.95 * 120);
  EXPECT_EQ(json.at("over_limit_blocks"), 0);
  EXPECT_EQ(json.at("blocks").at("changed"), 1);
  EXPECT_GE(json.at("sweep").size(), 5u);
  const std::string page = tests::file_text(folder / "out.html");
  EXPECT_NE(page.find("Lateral force along the path"), std::string::npos);
  EXPECT_NE(page.find("Time against the limit"), std::string::npos);
  EXPECT_NE(run.out.find("lateral force, N"), std::string::npos);
  const std::string text = tests::file_text(folder / "out.nc");
  EXPECT_NE(text.find("(slot)"), std::string::npos);
  EXPECT_EQ(text.substr(0, text.find("G1")), kSlot.substr(0, kSlot.find("G1")));
  // In a fresh prediction the new program has the peak that adapt reports.
  folder.write("job.toml", replaced(kJob, "p.nc", "out.nc"));
  const CamberRun predict = run_camber(folder, "-q predict job.toml -o predicted --json predicted.json");
  ASSERT_EQ(predict.status, 0) << predict.err;
  const auto fresh = nlohmann::json::parse(tests::file_text(folder / "predicted.json"));
  EXPECT_NEAR(fresh.at("force_N").at("max").get<double>(), load.at("max_after").get<double>(), 1.2);
}

TEST(AdaptCommand, RefusesAJobWithoutAdapt) {
  expect_refused(
      {.job = kJob},
      "job.toml: error: has no [adapt]; a table with limits = { force_N = 150.0 } and feed_mm_per_min = [300, "
      "3000] was expected [adapt-missing]\n");
}

TEST(AdaptCommand, RefusesLimitsThatTheToolExceedsAtAnyFeed) {
  const TempFolder folder;
  const CamberRun run = adapt(folder, {.job = kJob + replaced(kAdapt, "120.0", "12.0")});
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err.substr(0, run.err.find(" in ")),
            "job.toml:19:10: error: force_N = 12 is exceeded at the lowest feed, 50 mm/min,");
  EXPECT_NE(run.err.find("a higher limit, a lower feed or a smaller cut was expected [limit-unreachable]\n"),
            std::string::npos)
      << run.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "out.nc"));
}

TEST(AdaptCommand, RefusesALowestFeedOverTheHighest) {
  expect_refused(
      {.job = kJob + replaced(kAdapt, "[50, 2000]", "[2000, 50]")},
      "job.toml:20:19: error: feed_mm_per_min = [2000, 50]: the lowest feed is not below the highest; "
      "[lowest, highest] was expected [value-range]\n    feed_mm_per_min = [2000, 50]\n                      "
      "^\n");
}

TEST(AdaptCommand, RefusesLimitsThatBoundNothing) {
  expect_refused({.job = kJob + replaced(kAdapt, "force_N = 120.0", "chip_min_mm = 0.01")},
                 "job.toml:19:10: error: limits has no load that bounds the feed from above; at least one of force_N, "
                 "torque_Nm, deflection_um, form_error_um, chip_mm and power_W was expected, or chatter_margin alone "
                 "[limits-missing]\n    limits "
                 "= { chip_min_mm = 0.01 }\n             ^\n");
}

TEST(AdaptCommand, RefusesAMarginThatIsUnstable) {
  expect_refused({.job = kJob + replaced(kAdapt, "force_N = 120.0", "chatter_margin = 1.2")},
                 "job.toml:19:29: error: chatter_margin is 1.2; a number greater than zero and at most 1 was expected "
                 "[value-range]\n    limits = { chatter_margin = 1.2 }\n                                ^\n");
}

TEST(AdaptCommand, RefusesLeversThatAreNone) {
  expect_refused({.job = kJob + kAdapt + "levers = [\"feed\", \"depth\"]\n"},
                 "job.toml:21:10: error: levers names \"depth\"; a list of \"feed\" and \"speed\" was expected "
                 "[value-choice]\n    levers = [\"feed\", \"depth\"]\n             ^\n");
  expect_refused({.job = kJob + kAdapt + "levers = [\"feed\", \"speed\"]\n"},
                 "job.toml:21:10: error: levers names \"speed\", but limits has no chatter_margin, by which speeds are "
                 "chosen; limits = { chatter_margin = 0.8 } was expected [value-choice]\n    levers = [\"feed\", "
                 "\"speed\"]\n             ^\n");
  expect_refused({.job = kJob + replaced(kAdapt, "120.0", "120.0, chatter_margin = 0.8") + "levers = [\"speed\"]\n"},
                 "job.toml:21:10: error: levers does not name \"feed\", by which alone a load is kept within limits; "
                 "[\"feed\", \"speed\"] or chatter_margin as the only limit was expected [value-choice]\n    levers = "
                 "[\"speed\"]\n             ^\n");
}

TEST(AdaptCommand, RefusesSpindleSpeedsWithoutTheirLever) {
  expect_refused(
      {.job = kJob + kAdapt + "spindle_rpm = [2000, 6000]\n"},
      "job.toml:21:1: error: [adapt] has spindle_rpm, but levers does not name \"speed\"; levers = [\"feed\", "
      "\"speed\"] was expected [value-choice]\n    spindle_rpm = [2000, 6000]\n    ^\n");
}

TEST(AdaptCommand, RefusesAKeyThatIsNone) {
  expect_refused(
      {.job = kJob + replaced(kAdapt, "force_N = 120.0", "force_N = 120.0, forse_N = 3.0")},
      "job.toml:19:29: error: unknown key forse_N in [adapt.limits]; did you mean force_N? [key-unknown]\n    "
      "limits = { force_N = 120.0, forse_N = 3.0 }\n                                ^\n");
}

TEST(AdaptCommand, RefusesAMaterialWithoutCoefficients) {
  const TempFolder folder;
  const std::string job =
      replaced(kJob, "ktc_MPa = 800.0\nkrc_MPa = 250.0\nkte_N_per_mm = 5.0\nkre_N_per_mm = 5.0\n", "");
  const CamberRun run = adapt(folder, {.job = job + kAdapt});
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("job.toml:8:1: error: "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("ktc_MPa"), std::string::npos) << run.err;
}

TEST(AdaptCommand, RefusesTravelAndCollisionsAsCompensateDoes) {
  expect_refused({.program = replaced(kSlot, "G0 X-6 Y0 Z5\n", "G0 X-60 Y0 Z5\nG0 X60\nG0 X-6\n")},
                 "p.nc:5:1: error: the program needs 120.0000 mm of X up to here; the axis has 100 mm of travel "
                 "[travel]\n    G0 X60\n    ^\n");
  const TempFolder folder;
  const CamberRun run = adapt(folder, {.program = replaced(kSlot, "G0 Z-2\n", "G0 Z-2\nG0 X3\n")});
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("[collision-rapid]"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "out.nc"));
}

TEST(AdaptCommand, ATimeThatCannotBeReachedIsExitStatusThree) {
  const TempFolder folder;
  const CamberRun run = adapt(folder, {}, " --time-limit 0.01");
  EXPECT_EQ(run.status, 3);
  EXPECT_EQ(run.err,
            "camber: error: no limits are high enough for the time limit: the control or the highest feed takes the "
            "time\ncamber: error: out.nc was not written; --keep-anyway writes it all the same\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "out.nc"));
}

}  // namespace
}  // namespace camber
