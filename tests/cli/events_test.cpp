// What other programs read: --events, --only-in, check --path.
#include <cstring>
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/run_camber.h"
#include "tests/support/wall_job.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::file_text;
using tests::run_camber;
using tests::TempFolder;
namespace fs = std::filesystem;

std::vector<json> events_of(const std::string& text) {
  std::vector<json> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(json::parse(line));
  return out;
}

TEST(Events, AreLinesOfJsonOnStandardError) {
  const TempFolder folder;
  folder.write("p.nc", "G21 G90\nT1 M6\nS100 M3\nG0 X0 Y0 Z0\nG1 X1 F0\n");
  const auto run = run_camber(folder, "check p.nc --events");
  EXPECT_EQ(run.status, 1);
  const auto events = events_of(run.err);
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.back(), (json{{"event", "diagnostic"},
                                 {"severity", "error"},
                                 {"file", "p.nc"},
                                 {"line", 5},
                                 {"column", 7},
                                 {"message", "F0 on a cutting move (G1); the feed must be greater than zero"},
                                 {"check", events.back()["check"]},
                                 {"source_line", "G1 X1 F0"}}));
}

TEST(Events, TellHowFarARunHasCome) {
  const TempFolder folder;
  tests::write_wall(folder, "", 0.05);
  const auto run = run_camber(folder, "predict job.toml -o out --events");
  EXPECT_EQ(run.status, 0) << run.err;
  int shares = 0;
  for (const json& event : events_of(run.err)) {
    if (event["event"] != "progress") continue;
    EXPECT_EQ(event.size(), 4u) << event;
    if (event["share"].is_number()) ++shares;
  }
  EXPECT_GT(shares, 0) << run.err;
}

TEST(OnlyIn, RefusesFilesOutsideWhereverTheyAreRead) {
  const TempFolder folder;
  fs::create_directories(folder / "in");
  tests::write_wall(folder, "in/");
  folder.write("outside.nc", tests::kWallProgram);
  fs::create_symlink(folder / "outside.nc", folder / "in/link.nc");
  const std::string in = fs::canonical(folder / "in").string();
  const auto said = [&](const std::string& arguments) {
    const auto run = run_camber(folder, arguments + " --only-in in");
    EXPECT_EQ(run.status, 1) << arguments;
    return run.err;
  };
  const std::string why = ": error: lies outside " + in + "; a file in that folder was expected [file-outside]\n";
  EXPECT_EQ(said("check outside.nc"), "outside.nc" + why);
  EXPECT_EQ(said("check in/link.nc"), "in/link.nc" + why);
  EXPECT_EQ(said("check in/p.nc --json figures.json"), "figures.json" + why);
  EXPECT_EQ(said("check in/p.nc --json in/../figures.json"), "in/../figures.json" + why);
  EXPECT_EQ(said("predict in/job.toml -o out"), "out" + why);
  EXPECT_EQ(said("init in/p.nc -o in/new.toml --tools outside.vtdb"), "outside.vtdb" + why);
  EXPECT_EQ(said("init in/p.nc -o in/new.toml --tools outside.tools"), "outside.tools" + why);
  EXPECT_FALSE(fs::exists(folder / "out"));
  EXPECT_FALSE(fs::exists(folder / "figures.json"));
  const auto run = run_camber(folder, "predict in/job.toml -o in/out --only-in in");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(fs::exists(folder / "in/out/report.html"));
}

TEST(CheckPath, WritesThePathAsArrays) {
  const TempFolder folder;
  folder.write("p.nc", "G21 G90 G17 G54\nT2 M6\nS100 M3\nG0 X0 Y0\nG0 Z0\nG1 X10 F600\nG2 X20 Y10 I0 J10\nM30\n");
  ASSERT_EQ(run_camber(folder, "check p.nc --path p.bin").status, 0);
  const std::string text = file_text(folder / "p.bin");
  const std::size_t end = text.find('\n');
  const json head = json::parse(text.substr(0, end));
  EXPECT_EQ((end + 1) % 4, 0u);
  const auto n = head["points"].get<std::size_t>();
  ASSERT_GT(n, 8u);
  const std::size_t bytes = 4 * 5 * n + (2 * n + 3) / 4 * 4 + (n + 3) / 4 * 4;
  ASSERT_EQ(text.size(), end + 1 + bytes);
  const auto value = [&](std::size_t array, std::size_t i, auto zero) {
    auto out = zero;
    std::memcpy(&out, text.data() + end + 1 + 4 * n * array + 4 * i, sizeof out);
    return out;
  };
  EXPECT_FLOAT_EQ(value(0, n - 1, 0.0f) + head["origin_mm"][0].get<float>(), 20);
  EXPECT_FLOAT_EQ(value(1, n - 1, 0.0f) + head["origin_mm"][1].get<float>(), 10);
  EXPECT_EQ(value(3, n - 1, 0u), 7u);
  EXPECT_FLOAT_EQ(value(4, n - 1, 0.0f), 600);
  EXPECT_EQ(static_cast<int>(text[text.size() - (n + 3) / 4 * 4 + n - 1]), 3);
  std::uint16_t tool = 0;
  std::memcpy(&tool, text.data() + end + 1 + 20 * n + 2 * (n - 1), 2);
  EXPECT_EQ(tool, 2);
}

}  // namespace
}  // namespace camber
