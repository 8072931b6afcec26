// The path as a picture: the pages of check and time.
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/open_page.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::file_text;
using tests::run_camber;
using tests::TempFolder;

constexpr char kMachine[] = R"([axis.x]
max_velocity_mm_per_min = 20000
acceleration_mm_per_s2 = 2000
[axis.y]
max_velocity_mm_per_min = 20000
acceleration_mm_per_s2 = 2000
[axis.z]
max_velocity_mm_per_min = 20000
acceleration_mm_per_s2 = 2000
[cycle]
rapid_path = "dogleg"
)";

/// Rows of two tools, each at its feed, with rapids between.
std::string two_tools() {
  std::string text = "G21 G90 G17 G94\n";
  for (int tool = 1; tool <= 2; ++tool) {
    text += fmt::format("T{} M6\nS8000 M3\nG0 X0. Y{}. Z5.\nG1 Z0. F{}\n", tool, 20 * tool, 600 * tool);
    for (int row = 0; row < 5; ++row)
      text += fmt::format("G1 X{}. F{}\nG0 Z5.\nG0 X0. Y{}.\nG1 Z0. F300\n", 40 + 5 * row, 1500 * tool,
                          20 * tool + 3 * row + 3);
  }
  return text + "G0 Z50.\nM30\n";
}

TEST(ProgramPage, OfCheckShowsRapidAndCuttingAndProgrammedFeeds) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  folder.write("p.nc", two_tools());
  const auto run = run_camber(folder, "check p.nc --report r.html --json r.json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(tests::open_page("program", folder / "r.html", folder / "r.json"), "");
  EXPECT_EQ(tests::open_page("phone", folder / "r.html"), "");
}

TEST(ProgramPage, OfCheckOnAMachineAndOfTimeShowActualFeedsToo) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  folder.write("p.nc", two_tools());
  folder.write("m.toml", kMachine);
  ASSERT_EQ(run_camber(folder, "check p.nc --machine m.toml --report c.html").status, 0);
  ASSERT_EQ(run_camber(folder, "time p.nc --machine m.toml --report t.html").status, 0);
  for (const char* page : {"c.html", "t.html"}) {
    EXPECT_NE(file_text(folder / page).find("\"speed\""), std::string::npos) << page;
    EXPECT_EQ(tests::open_page("program", folder / page), "") << page;
    EXPECT_EQ(tests::open_page("phone", folder / page), "") << page;
  }
}

TEST(ProgramPage, NamesWarningsAndFilesAsTheyAre) {
  const TempFolder folder;
  folder.write("<b>.nc", "G90\nG0 X0. Y0. Z5.\nG1 X5. F100\nM30\n");
  const auto run = run_camber(folder, "check '<b>.nc' --report r.html --json r.json");
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string page = file_text(folder / "r.html");
  EXPECT_NE(page.find("<h1>Program &lt;b&gt;.nc</h1>"), std::string::npos);
  EXPECT_NE(page.find("<li>&lt;b&gt;.nc:2:1: warning: the program has moves before G20 or G21"), std::string::npos);
}

TEST(ProgramPage, OfAProgramWithoutMotionSaysSo) {
  const TempFolder folder;
  folder.write("p.nc", "G21 G90\nM30\n");
  ASSERT_EQ(run_camber(folder, "check p.nc --report r.html").status, 0);
  EXPECT_NE(file_text(folder / "r.html").find("The program moves nothing."), std::string::npos);
}

TEST(ProgramPage, OfAHundredThousandBlocksIsSmallAndOpensFast) {
  CAMBER_NEEDS_BROWSER();
  const TempFolder folder;
  std::string text = "G21 G90 G17 G94\nG0 X0. Y0. Z0.\nG1 F1000\n";
  unsigned noise = 1;
  const auto random = [&noise] { return (noise = noise * 1664525u + 1013904223u) / 4294967296.0; };
  for (int i = 0; i < 100000; ++i)
    text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f} F{}\n", 0.1 * (i % 1000) + 0.05 * random(), 0.5 * (i / 1000), random(),
                        i % 5000 < 2500 ? 1000 : 3000);
  folder.write("p.nc", text + "M30\n");
  folder.write("m.toml", kMachine);
  ASSERT_EQ(run_camber(folder, "check p.nc --report c.html").status, 0);
  ASSERT_EQ(run_camber(folder, "time p.nc --machine m.toml --report t.html").status, 0);
  for (const char* page : {"c.html", "t.html"}) {
    RecordProperty(page, static_cast<int>(std::filesystem::file_size(folder / page)));
    EXPECT_LT(std::filesystem::file_size(folder / page), 1'500'000u) << page;
    EXPECT_EQ(tests::open_page("large_program", folder / page), "") << page;
  }
}

TEST(ProgramPage, IsTheSameTwiceAndNotWrittenOverTheProgram) {
  const TempFolder folder;
  folder.write("p.nc", two_tools());
  ASSERT_EQ(run_camber(folder, "check p.nc --report a.html").status, 0);
  ASSERT_EQ(run_camber(folder, "check p.nc --report b.html --threads 1").status, 0);
  EXPECT_EQ(file_text(folder / "a.html"), file_text(folder / "b.html"));
  const auto run = run_camber(folder, "check p.nc --report p.nc");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err,
            "p.nc: error: would be overwritten, but it is an input; another name was expected [output-is-input]\n");
  // An error in the program leaves no page.
  folder.write("q.nc", "G21 G90\nG1 X5.\n");
  EXPECT_EQ(run_camber(folder, "check q.nc --report q.html").status, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "q.html"));
}

}  // namespace
}  // namespace camber
