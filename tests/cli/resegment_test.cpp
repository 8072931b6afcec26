// camber resegment as a user runs it.
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "nc/interpreter.h"
#include "tests/support/path_distance.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using nlohmann::json;
using tests::file_text;
using tests::run_camber;
using tests::TempFolder;

constexpr char kMachine[] = R"(
[control]
block_time_ms = 2
corner = { law = "speed_difference", speed_difference_mm_per_min = 246 }
[axis.x]
acceleration_mm_per_s2 = 2000
[axis.y]
acceleration_mm_per_s2 = 2000
[axis.z]
acceleration_mm_per_s2 = 2000
)";

/// Rows over a bow with an edge, in blocks of uneven length.
std::string program() {
  std::string text = "G21 G90 G17 G94\nG0 X0. Y0. Z10.\nG1 Z0. F8000\n";
  for (int row = 0; row < 6; ++row)
    for (int i = 0; i <= 300; ++i) {
      const int k = row % 2 ? 300 - i : i;
      const double x = 0.1 * k + 0.04 * std::sin(1.7 * k) * (k % 300 ? 1 : 0);
      text +=
          fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", x, 0.3 * row, x < 20 ? 0.01 * x * (20 - x) * 0.5 : -0.3 * (x - 20));
    }
  return text + "G0 Z10.\nM30\n";
}

nc::Interpretation moves_of(const std::string& text) {
  Diagnostics diagnostics;
  static std::vector<nc::Program> kept;
  kept.push_back(nc::read_program(SourceText("p.nc", text), diagnostics));
  return nc::interpret(kept.back(), {}, diagnostics);
}

TEST(ResegmentCommand, IsFasterWithinTheToleranceAndTellsHow) {
  const TempFolder folder;
  folder.write("p.nc", program());
  folder.write("m.toml", kMachine);
  const auto run = run_camber(folder, "resegment p.nc --machine m.toml --tolerance-mm 0.01 -o out.nc --json r.json");
  ASSERT_EQ(run.status, 0) << run.err;
  const json r = json::parse(file_text(folder / "r.json"));
  EXPECT_LT(r["time_after_s"], 0.6 * r["time_before_s"].get<double>());
  EXPECT_LT(r["blocks_after"], r["blocks_before"]);
  EXPECT_LE(r["max_deviation_mm"], 0.01);
  EXPECT_LE(r["contour_after_um"]["max"], r["contour_limit_um"]);
  EXPECT_LE(r["contour_after_um"]["rms"], r["contour_limit_rms_um"]);
  EXPECT_EQ(r["corners"], 1 + 6 + 10);  // the plunge, the edge in each row, and two at each of five row ends
  // The chosen one is the fastest of those that keep to the limit.
  double fastest = 1e9;
  for (const auto& t : r["tried"])
    if (t["contour_um"]["max"] <= r["contour_limit_um"] && t["contour_um"]["rms"] <= r["contour_limit_rms_um"])
      fastest = std::min(fastest, t["time_s"].get<double>());
  EXPECT_LE(r["time_after_s"], 1.001 * fastest);
  EXPECT_LE(tests::hausdorff_mm(moves_of(program()), moves_of(file_text(folder / "out.nc")), 0.004), 0.0102);
  EXPECT_EQ(run_camber(folder, "check --strict out.nc").status, 0);
}

TEST(ResegmentCommand, ALengthThatIsGivenIsTaken) {
  const TempFolder folder;
  folder.write("p.nc", program());
  folder.write("m.toml", kMachine);
  const auto run = run_camber(
      folder,
      "resegment p.nc --machine m.toml --tolerance-mm 0.01 --length-mm 0.8 --contour-mm 1 -o out.nc --json r.json");
  ASSERT_EQ(run.status, 0) << run.err;
  const json r = json::parse(file_text(folder / "r.json"));
  EXPECT_EQ(r["tried"].size(), 1u);
  EXPECT_NEAR(r["length_after_mm"].get<double>() / r["lines"].get<double>(), 0.8, 0.1);
}

TEST(ResegmentCommand, SaysWhenTheAxesStrayMoreThanAllowed) {
  const TempFolder folder;
  folder.write("p.nc", program());
  folder.write("m.toml", std::string(kMachine) + "position_gain_per_s = 20\n");
  const auto run =
      run_camber(folder, "resegment p.nc --machine m.toml --tolerance-mm 0.01 --contour-mm 0.0001 -o out.nc");
  EXPECT_EQ(run.status, 3);
  EXPECT_EQ(run.err, "resegment: no length keeps the axes within 0.1 um of the path; the closest one was written\n");
  EXPECT_TRUE(std::filesystem::exists(folder / "out.nc"));
}

TEST(ResegmentCommand, TellsWhatIsWrong) {
  const TempFolder folder;
  folder.write("p.nc", program());
  folder.write("m.toml", kMachine);
  EXPECT_EQ(run_camber(folder, "resegment p.nc --tolerance-mm 0.01 -o out.nc").status, 2);
  EXPECT_EQ(run_camber(folder, "resegment p.nc --machine m.toml --tolerance-mm -1 -o out.nc").status, 2);
  const auto over = run_camber(folder, "resegment p.nc --machine m.toml --tolerance-mm 0.01 -o p.nc");
  EXPECT_EQ(over.status, 1);
  EXPECT_EQ(over.err,
            "p.nc: error: would be overwritten, but it is an input; another name was expected [output-is-input]\n");
}

}  // namespace
}  // namespace camber
