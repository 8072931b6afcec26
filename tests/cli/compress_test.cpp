// camber compress as a user runs it.
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/run_camber.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::file_text;
using tests::run_camber;
using tests::TempFolder;

std::string program() {
  std::string text = "G21 G90 G17 G94\nG0 X10. Y0. Z0.\nG1 F600\n";
  for (int i = 1; i <= 60; ++i)
    text += fmt::format("X{:.3f} Y{:.3f}\n", 10 * std::cos(i / 30.0), 10 * std::sin(i / 30.0));
  return text + "M30\n";
}

TEST(CompressCommand, WritesTheProgramAndTheFigures) {
  const TempFolder folder;
  folder.write("p.nc", program());
  folder.write("m.toml", "[axis.x]\nacceleration_mm_per_s2 = 1000\n[axis.y]\nacceleration_mm_per_s2 = 1000\n");
  const auto run = run_camber(folder, "compress p.nc --tolerance-mm 0.01 -o out.nc --machine m.toml --json r.json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(file_text(folder / "out.nc"),
            "G21 G90 G17 G94\nG0 X10. Y0. Z0.\nG1 F600\nG3 X-4.161 Y9.093 I-10. J0.\nM30\n");
  const json r = json::parse(file_text(folder / "r.json"));
  EXPECT_EQ(r["blocks_before"], 64);
  EXPECT_EQ(r["blocks_after"], 5);
  EXPECT_EQ(r["lines"], 0);
  EXPECT_EQ(r["arcs"], 1);
  EXPECT_NEAR(r["length_after_mm"], 20, 0.001);
  EXPECT_NEAR(r["length_before_mm"], 20, 0.002);
  EXPECT_GT(r["max_deviation_mm"], 0);
  EXPECT_LE(r["max_deviation_mm"], 0.01);
  EXPECT_GT(r["time_before_s"], 2.0 - 1e-3);
  EXPECT_GT(r["time_after_s"], 2.0 - 1e-3);
  EXPECT_EQ(run_camber(folder, "check --strict out.nc").status, 0);
  // Nothing is left to do.
  ASSERT_EQ(run_camber(folder, "compress out.nc --tolerance-mm 0.01 -o again.nc").status, 0);
  EXPECT_EQ(file_text(folder / "again.nc"), file_text(folder / "out.nc"));
}

TEST(CompressCommand, WithoutAMachineThereAreNoTimes) {
  const TempFolder folder;
  folder.write("p.nc", program());
  ASSERT_EQ(run_camber(folder, "compress p.nc --tolerance-mm 0.01 -o out.nc --json r.json").status, 0);
  EXPECT_TRUE(json::parse(file_text(folder / "r.json"))["time_before_s"].is_null());
}

TEST(CompressCommand, ARampBecomesOneArcThatChecksClean) {
  const TempFolder folder;
  std::string text = "G21 G90 G17 G94\nG0 X10. Y0. Z0.\nG1 F600\n";
  for (int i = 1; i <= 60; ++i)
    text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", 10 * std::cos(i / 30.0), 10 * std::sin(i / 30.0), -i / 30.0);
  folder.write("p.nc", text + "M30\n");
  ASSERT_EQ(run_camber(folder, "compress p.nc --tolerance-mm 0.01 --helices -o out.nc --json r.json").status, 0);
  EXPECT_EQ(file_text(folder / "out.nc"),
            "G21 G90 G17 G94\nG0 X10. Y0. Z0.\nG1 F600\nG3 X-4.161 Y9.093 Z-2. I-10. J0.\nM30\n");
  EXPECT_EQ(run_camber(folder, "check --strict out.nc").status, 0);
  const json r = json::parse(file_text(folder / "r.json"));
  EXPECT_EQ(r["arcs"], 1);
  EXPECT_NEAR(r["length_after_mm"], std::hypot(20, 2), 0.001);
}

TEST(CompressCommand, TheLeastTimeWhereArcsAreFaster) {
  const TempFolder folder;
  std::string text = "G21 G90 G17 G94\nG0 X0. Y0. Z0.\nG1 F600\n";
  for (int i = 1; i <= 30; ++i) text += fmt::format("X{:.3f} Y{:.3f}\n", 1.5 * i, 4 * std::sin(1.5 * i / 10));
  folder.write("p.nc", text + "M30\n");
  const std::string feeds = " --line-feed-mm-per-min 270 --arc-feed-mm-per-min 1000";
  const auto figures = [&](const std::string& more) {
    const auto run = run_camber(folder, "compress p.nc --tolerance-mm 0.03 -o out.nc --json r.json" + more);
    EXPECT_EQ(run.status, 0) << run.err;
    return std::pair(json::parse(file_text(folder / "r.json")), run.out);
  };
  EXPECT_FALSE(figures("").first.contains("time_at_feeds_after_s"));
  const auto [r, out] = figures(feeds + " --block-s 0");
  EXPECT_NEAR(r["time_at_feeds_before_s"], r["length_before_mm"].get<double>() / 4.5, 1e-6);
  EXPECT_LT(r["time_at_feeds_after_s"], 0.6 * r["time_at_feeds_before_s"].get<double>());
  EXPECT_NE(out.find("at the given feeds"), std::string::npos) << out;
  for (const auto& [wrong, message] : std::vector<std::pair<std::string, std::string>>{
           {" --line-feed-mm-per-min 270", "--line-feed-mm-per-min requires --arc-feed-mm-per-min"},
           {" --block-s 1", "--block-s requires --line-feed-mm-per-min"},
           {feeds + " --lines-only", "--lines-only excludes --line-feed-mm-per-min"},
           {" --line-feed-mm-per-min 270 --arc-feed-mm-per-min 200",
            "--arc-feed-mm-per-min: 200: more than --line-feed-mm-per-min 270 was expected"}}) {
    const auto run = run_camber(folder, "compress p.nc --tolerance-mm 0.01 -o no.nc" + wrong);
    EXPECT_EQ(run.status, 2) << wrong;
    EXPECT_NE(run.err.find(message), std::string::npos) << run.err;
  }
}

TEST(CompressCommand, KinksAreBoundedUnlessAskedOtherwise) {
  const TempFolder folder;
  std::string text = "G21 G90 G17 G94\nG0 X0. Y0. Z0.\nG1 F600\n";
  for (int i = 1; i <= 1400; ++i) text += fmt::format("X{:.3f} Y{:.3f}\n", 0.05 * i, 3 * std::sin(0.05 * i / 4));
  folder.write("p.nc", text + "M30\n");
  const auto figures = [&](const std::string& more) {
    EXPECT_EQ(run_camber(folder, "compress p.nc --tolerance-mm 0.01 -o out.nc --json r.json" + more).status, 0);
    return json::parse(file_text(folder / "r.json"));
  };
  const json any = figures(" --tangent-deg 180"), usual = figures(""), fine = figures(" --tangent-deg 0.2");
  EXPECT_GT(any["max_kink_deg"], 1.5);
  EXPECT_LE(usual["max_kink_deg"], 1);
  EXPECT_LE(fine["max_kink_deg"], 0.2);
  EXPECT_LT(usual["rms_kink_deg"], any["rms_kink_deg"]);
  EXPECT_LT(fine["rms_kink_deg"], usual["rms_kink_deg"]);
}

TEST(CompressCommand, TellsWhatIsWrong) {
  const TempFolder folder;
  folder.write("p.nc", program());
  EXPECT_EQ(run_camber(folder, "compress p.nc -o out.nc").status, 2);
  EXPECT_EQ(run_camber(folder, "compress p.nc --tolerance-mm 0 -o out.nc").status, 2);
  EXPECT_EQ(run_camber(folder, "compress p.nc --tolerance-mm nan -o out.nc").status, 2);
  EXPECT_EQ(run_camber(folder, "compress p.nc --tolerance-mm 0.01 --lines-only --helices -o out.nc").status, 2);
  const auto angle = run_camber(folder, "compress p.nc --tolerance-mm 0.01 --tangent-deg 0 -o out.nc");
  EXPECT_EQ(angle.status, 2);
  EXPECT_EQ(angle.err,
            "--tangent-deg: 0: a number from 0.05 to 180 was expected\nRun with --help for more information.\n");
  const auto over = run_camber(folder, "compress p.nc --tolerance-mm 0.01 -o p.nc");
  EXPECT_EQ(over.status, 1);
  EXPECT_EQ(over.err,
            "p.nc: error: would be overwritten, but it is an input; another name was expected [output-is-input]\n");
  folder.write("bad.nc", "G21\nG1 X1. F0\nM30\n");
  EXPECT_EQ(run_camber(folder, "compress bad.nc --tolerance-mm 0.01 -o out.nc").status, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "out.nc"));
}

}  // namespace
}  // namespace camber
