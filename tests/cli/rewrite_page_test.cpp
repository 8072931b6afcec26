// The pages of compress and resegment: their numbers are those of the JSON, and a browser shows them.
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/geometry.h"
#include "test_paths.h"
#include "tests/support/open_page.h"
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
[axis.x]
acceleration_mm_per_s2 = 2000
[axis.y]
acceleration_mm_per_s2 = 2000
[axis.z]
acceleration_mm_per_s2 = 2000
)";

/// Rows of lines with an edge in the middle of each, or half circles.
std::string rows(bool arcs, int count = 20, int blocks = 120) {
  std::string text = "G21 G90 G17 G94\nG0 X0. Y0. Z5.\nG1 Z0. F6000\n";
  for (int row = 0; row < count; ++row)
    for (int k = 0; k <= blocks; ++k) {
      const int i = row % 2 ? blocks - k : k;
      const double u = static_cast<double>(i) / blocks, bow = arcs ? 8 * std::sin(kPi * u) : std::abs(u - 0.5) * 6;
      text += fmt::format("X{:.3f} Y{:.3f}\n", 40 * u + (arcs ? 0 : 0.0007 * (i % 3)), row * 1.5 + bow);
    }
  return text + "G0 Z5.\nM30\n";
}

void copy_raster_sample(const TempFolder& folder) {
  for (const char* name : {"job.toml", "machine.toml", "part.stl"})
    folder.write(name, file_text(std::string(CAMBER_SOURCE_DIR "/samples/10-raster/") + name));
}

constexpr char kRaster[] =
    "resegment --job job.toml --scallop-mm 0.02 --tolerance-mm 0.003 --feed-mm-per-min 1200 --spindle-rpm 12000 "
    "-o out.nc ";

TEST(RewritePage, OfCompressShowsLinesAndArcsAndTheNumbersOfTheJson) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  folder.write("m.toml", kMachine);
  folder.write("p.nc", rows(true));
  const auto run = run_camber(
      folder, "compress p.nc --tolerance-mm 0.01 -o out.nc --machine m.toml --json r.json --report report.html");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(tests::open_page("path", folder / "report.html", folder / "r.json"), "");
  const json r = json::parse(file_text(folder / "r.json"));
  // Points laid on both paths find what the fit says, and no more.
  EXPECT_LE(r["measured_deviation_mm"], r["max_deviation_mm"].get<double>() + 0.0001);
  EXPECT_GE(r["measured_deviation_mm"], 0.8 * r["max_deviation_mm"].get<double>());
}

TEST(RewritePage, OfResegmentShowsLinesAndTheNumbersOfTheJson) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  folder.write("m.toml", kMachine);
  folder.write("p.nc", rows(false));
  const auto run =
      run_camber(folder, "resegment p.nc --machine m.toml --tolerance-mm 0.01 -o out.nc --json r.json --report r.html");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(tests::open_page("path", folder / "r.html", folder / "r.json"), "");
  EXPECT_NE(file_text(folder / "r.html").find("Lengths tried"), std::string::npos);
}

TEST(RewritePage, OfARasterShowsRowsOnThePartAndTheNumbersOfTheJson) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  copy_raster_sample(folder);
  const auto run = run_camber(folder, std::string(kRaster) + "--json r.json --report r.html");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(tests::open_page("raster", folder / "r.html", folder / "r.json"), "");
  EXPECT_NE(file_text(folder / "r.html").find("Lengths tried"), std::string::npos);
}

TEST(RewritePage, OfALargeProgramIsThinnedAndStaysSmall) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  // 400 000 blocks of noise that nothing can leave out.
  std::string text = "G21 G90 G17 G94\nG0 X0. Y0. Z0.\nG1 F1000\n";
  unsigned noise = 1;
  const auto random = [&noise] { return (noise = noise * 1664525u + 1013904223u) / 4294967296.0; };
  for (int i = 0; i < 400000; ++i)
    text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", 0.1 * (i % 2000) + 0.05 * random(), 0.5 * (i / 2000), random());
  folder.write("p.nc", text + "M30\n");
  const auto run = run_camber(folder, "compress p.nc --tolerance-mm 0.001 -o out.nc --report report.html");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_LT(std::filesystem::file_size(folder / "report.html"), 3'000'000u);
  EXPECT_EQ(tests::open_page("large_path", folder / "report.html"), "");
}

TEST(RewritePage, IsNotWrittenOverWhatIsRead) {
  const TempFolder folder;
  folder.write("p.nc", rows(true));
  const auto run = run_camber(folder, "compress p.nc --tolerance-mm 0.01 -o out.nc --report p.nc");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "p.nc: error: would be overwritten, but it is an input; another name was expected [output-is-input]\n");
  copy_raster_sample(folder);
  const auto raster = run_camber(folder, std::string(kRaster) + "--report part.stl");
  EXPECT_EQ(raster.status, 1);
  EXPECT_EQ(raster.err,
            "part.stl: error: would be overwritten, but it is an input; another name was expected [output-is-input]\n");
}

}  // namespace
}  // namespace camber
