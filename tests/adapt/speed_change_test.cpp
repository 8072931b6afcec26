// Spindle speeds that keep the limit on chatter: S and F of the emitted program, margins, advice.
#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "adapt/adaptation.h"
#include "tests/support/temp_folder.h"

namespace camber::adapt {
namespace {

using tests::replaced;
using tests::TempFolder;

/// A shoulder 4 mm wide and 2 mm deep, up-milling: 1.4 times the critical depth at S9000.
const std::string kShoulder =
    "G21 G90 G54\nT1 M6\nS9000 M3\nG0 X-8. Y-2. Z5.\nG0 Z-2.\nG1 X20. F2160 (sings)\nG0 Z5.\nM30\n";
const std::string kKlartextShoulder =
    "0 BEGIN PGM P MM\n1 TOOL CALL 1 Z S9000 F2160\n2 L X-8 Y-2 Z+5 R0 FMAX M3\n3 L Z-2 R0 FMAX\n4 L X+20\n"
    "5 L Z+5 R0 FMAX\n6 END PGM P MM\n";
const std::string kSpeedLever = "limits = { chatter_margin = 0.8 }\nlevers = [\"speed\"]\n";

struct ChatterJob {
  std::string program = kShoulder;
  std::string adapt = kSpeedLever;
  std::string file = "p.nc";
};

machine::Job chatter_job(const TempFolder& folder, const ChatterJob& j) {
  folder.write(j.file, j.program);
  folder.write("machine.toml",
               "[axis.x]\nacceleration_mm_per_s2 = 3000\n[axis.y]\nacceleration_mm_per_s2 = 3000\n[axis.z]\n"
               "acceleration_mm_per_s2 = 3000\n[spindle]\nmax_rpm = 12000\n");
  std::string job = fmt::format(
      "program = \"{}\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"flat\"\ndiameter_mm = 12.0\nflutes = 3\n"
      "overhang_mm = 50.0\n",
      j.file);
  for (const auto& [direction, hz] : {std::pair{"x", 1180.0}, {"y", 1235.0}})
    job += fmt::format(
        "[[tool.1.mode]]\ndirection = \"{}\"\nfrequency_Hz = {}\ndamping_percent = 2.9\nstiffness_N_per_um = 9.3\n",
        direction, hz);
  job +=
      "[material]\nktc_MPa = 800.0\nkrc_MPa = 250.0\nkte_N_per_mm = 10.0\nkre_N_per_mm = 10.0\n[stock]\n"
      "box_mm = [[0, 0, -5], [12, 20, 0]]\n[simulation]\nvoxel_mm = 0.4\ncoupling = \"rigid\"\n[adapt]\n" +
      j.adapt;
  folder.write("job.toml", job);
  Diagnostics diagnostics;
  return machine::read_job(folder / "job.toml", diagnostics);
}

AdaptResult adapted(const ChatterJob& j) {
  const TempFolder folder;
  Diagnostics diagnostics;
  return adapt(chatter_job(folder, j), diagnostics, {});
}

TEST(SpeedChange, KeepsTheMarginAndTheChip) {
  const AdaptResult r = adapted({});
  ASSERT_EQ(r.speeds.size(), 1u);
  const SpeedChange& c = r.speeds[0];
  EXPECT_EQ(c.tool, 1);
  EXPECT_EQ(c.before_rpm, 9000);
  EXPECT_EQ(c.line, 6u);
  EXPECT_GT(c.margin_before, 1.2);
  EXPECT_LT(c.margin_after, 0.8 * kOverLimit);
  EXPECT_TRUE(c.kept);
  EXPECT_EQ(c.reason, "");
  EXPECT_NE(c.after_rpm, 9000);
  EXPECT_NEAR(c.kept_depth_mm, 0.8 * 2 / c.margin_before, 0.02);
  // S, and F with it; nothing else.
  const auto at = r.text.find(" F");
  const double feed = std::stod(r.text.substr(at + 2));
  EXPECT_NEAR(feed, 2160 * c.after_rpm / 9000, 1e-3 * feed);
  std::string expected = replaced(kShoulder, "S9000", fmt::format("S{:.0f}", c.after_rpm));
  expected = replaced(expected, "F2160", r.text.substr(at + 1, r.text.find(" (") - at - 1));
  EXPECT_EQ(r.text, expected);
  EXPECT_EQ(r.blocks_changed, 2u);
  EXPECT_TRUE(r.good);
}

TEST(SpeedChange, WritesKlartext) {
  const AdaptResult r = adapted({.program = kKlartextShoulder, .file = "p.h"});
  ASSERT_EQ(r.speeds.size(), 1u);
  EXPECT_TRUE(r.speeds[0].kept);
  EXPECT_NE(r.text.find(fmt::format("1 TOOL CALL 1 Z S{:.0f} F2160\n", r.speeds[0].after_rpm)), std::string::npos)
      << r.text;
  EXPECT_NE(r.text.find("4 L X+20 F"), std::string::npos) << r.text;
}

TEST(SpeedChange, IsOnlyAdvisedWhereTheJobDoesNotNameTheLever) {
  const AdaptResult r = adapted({.adapt = "limits = { chatter_margin = 0.8 }\n"});
  EXPECT_EQ(r.text, kShoulder);
  ASSERT_EQ(r.speeds.size(), 1u);
  const SpeedChange& c = r.speeds[0];
  EXPECT_FALSE(c.kept);
  EXPECT_GT(c.advised_rpm, 0);
  EXPECT_EQ(c.after_rpm, 9000);
  EXPECT_EQ(c.reason, "levers does not name \"speed\"");
}

TEST(SpeedChange, TellsTheDepthWhereNoSpeedIsStable) {
  const AdaptResult r = adapted({.adapt = kSpeedLever + "spindle_rpm = [8950, 9050]\n"});
  EXPECT_EQ(r.text, kShoulder);
  const SpeedChange& c = r.speeds[0];
  EXPECT_FALSE(c.kept);
  EXPECT_EQ(c.advised_rpm, 0);
  EXPECT_GE(c.best_rpm, 8950);
  EXPECT_LE(c.best_rpm, 9050);
  EXPECT_LT(c.kept_depth_mm, 1.4);
  EXPECT_GT(c.kept_depth_mm, 0.8);
  EXPECT_LT(c.best_depth_mm, 1.5);
}

TEST(SpeedChange, StaysWithinTheFeedsOfTheJob) {
  const AdaptResult r = adapted({.adapt = kSpeedLever + "feed_mm_per_min = [2100, 2200]\n"});
  EXPECT_EQ(r.text, kShoulder);
  EXPECT_FALSE(r.speeds[0].kept);
}

TEST(SpeedChange, SaysWhereTheTextDoesNotAllowIt) {
  std::string program = replaced(kShoulder, "S9000 M3", "#1=9000\nS#1 M3");
  const AdaptResult r = adapted({.program = program});
  EXPECT_EQ(r.text, program);
  EXPECT_FALSE(r.speeds[0].kept);
  EXPECT_EQ(r.speeds[0].reason, "its S word is no plain number of the program (line 4)");
}

TEST(SpeedChange, ComesBeforeFeedsByLoad) {
  const AdaptResult r = adapted({.adapt = "limits = { force_N = 120.0, chatter_margin = 0.8 }\nlevers = [\"feed\", "
                                          "\"speed\"]\nfeed_mm_per_min = [100, 4000]\n"});
  EXPECT_TRUE(r.good);
  EXPECT_TRUE(r.speeds[0].kept);
  EXPECT_NE(r.speeds[0].after_rpm, 9000);
  ASSERT_EQ(r.loads.size(), 1u);
  EXPECT_LT(r.loads[0].max_after, kOverLimit * 120);
  EXPECT_NE(r.text.find(fmt::format("S{:.0f} M3", r.speeds[0].after_rpm)), std::string::npos);
}

/// A stable cut is left alone.
TEST(SpeedChange, LeavesAStableProgramAsItIs) {
  const std::string shallow = replaced(kShoulder, "Z-2.", "Z-0.5");
  const AdaptResult r = adapted({.program = shallow});
  EXPECT_EQ(r.text, shallow);
  EXPECT_TRUE(r.speeds[0].kept);
  EXPECT_EQ(r.speeds[0].after_rpm, 9000);
}

TEST(SpeedChange, SettingsAreWrittenAsTheyAreRead) {
  const TempFolder folder;
  const machine::Job job =
      chatter_job(folder, {.adapt = kSpeedLever + "spindle_rpm = [4000, 11000]\nfeed_mm_per_min = [100, 3000]\n"});
  const std::string text = machine::to_toml(job);
  EXPECT_NE(text.find("[adapt]\nlimits = { chatter_margin = 0.8 }\nlevers = [\"speed\"]\nfeed_mm_per_min = [100, "
                      "3000]\nspindle_rpm = [4000, 11000]\nstep_percent = 5\n"),
            std::string::npos)
      << text;
}

}  // namespace
}  // namespace camber::adapt
