// camber copy from the command line: what it says of jobs that cannot be copied, by the whole message.
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/copymill/small_copy.h"
#include "tests/support/block_part.h"
#include "tests/support/open_page.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::CamberRun;
using tests::SmallCopy;
using tests::TempFolder;

const std::string kOperation =
    "[[copy]]\ntool = 1\nmode = \"contour-line\"\nspindle_rpm = 8000\nfeed_mm_per_min = 3000\n"
    "radial_depth_mm = 4\naxial_depth_mm = 4\n";

/// What goes to standard error, without the folders of the sample.
std::string refused(const TempFolder& folder, const SmallCopy& c, const std::string& part = {}) {
  const std::string job = tests::write_copy_job(folder, c);
  const std::string sample = CAMBER_SOURCE_DIR "/samples/14-copy-milling/";
  if (!part.empty()) folder.write("job.toml", tests::replaced(tests::file_text(job), sample + c.part + ".stl", part));
  const CamberRun run = tests::run_camber(folder, "copy job.toml -o out.nc");
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.out, "");
  EXPECT_FALSE(std::filesystem::exists(folder / "out.nc"));
  return tests::replaced(run.err, sample, "");
}

TEST(CopyCommand, RefusesAPartOutsideTheStock) {
  const TempFolder folder;
  EXPECT_EQ(
      refused(folder, {.stock = "box_mm = [[10, 0, -15], [60, 45, 0]]", .operations = kOperation}),
      "island.stl: error: the part, X0 Y0 Z-15 to X60 Y45 Z0, is not inside the stock, X10 Y0 Z-15 to X60 Y45 Z0; "
      "a part that the stock holds was expected [part-outside-stock]\n");
}

TEST(CopyCommand, RefusesAToolLargerThanEveryPocket) {
  const TempFolder folder;
  const std::string operation = kOperation + "allowance_mm = 2.5\n";
  EXPECT_EQ(refused(folder, {.part = "slot", .stock = "box_mm = [[0, 0, -12], [60, 30, 0]]", .operations = operation}),
            "job.toml:28:1: error: T1 with a diameter of 8 mm and an allowance of 2.5 mm has no place in the region; a "
            "tool that fits between the part's walls was expected [tool-too-large]\n    [[copy]]\n    ^\n");
}

TEST(CopyCommand, RefusesAnOpenMesh) {
  const TempFolder folder;
  TriangleMesh mesh = tests::BlockPart{{{0, 0, -15}, {60, 45, 0}}, {}, {}}.mesh();
  mesh.triangles.pop_back();
  tests::write_stl(mesh, folder / "open.stl");
  EXPECT_EQ(
      refused(folder, {.operations = kOperation}, "open.stl"),
      "open.stl: error: the mesh is not closed: 3 of its edges have no second triangle, and the cutter could fall "
      "through; a closed one was expected [stl-open]\n");
}

TEST(CopyCommand, RefusesADepthOfZero) {
  const TempFolder folder;
  EXPECT_EQ(refused(folder, {.operations = tests::replaced(kOperation, "axial_depth_mm = 4", "axial_depth_mm = 0")}),
            "job.toml:34:18: error: axial_depth_mm is 0; a number greater than zero was expected [value-range]\n"
            "    axial_depth_mm = 0\n                     ^\n");
}

TEST(CopyCommand, ReamsInAndOutAtTheFeed) {
  const TempFolder folder;
  tests::write_copy_job(
      folder, {.operations = "[[copy]]\ntool = 3\nmode = \"drilling\"\nspindle_rpm = 2000\nfeed_mm_per_min = 200\n"
                             "axial_depth_mm = 3\nholes_mm = [[15, 15]]\nregion = { z_mm = [-8, 0] }\n"
                             "[[copy]]\ntool = 3\nmode = \"drilling\"\nspindle_rpm = 1000\nfeed_mm_per_min = 100\n"
                             "cycle = \"ream\"\nholes_mm = [[15, 15]]\nregion = { z_mm = [-8, 0] }\n"});
  const CamberRun run = tests::run_camber(folder, "copy job.toml -o out.nc --report out.html");
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string text = tests::file_text(folder / "out.nc");
  const std::size_t ream = text.rfind("M6");
  ASSERT_NE(ream, text.npos);
  const std::string after = text.substr(text.find("S1000"));
  // Down and up again in G1, with no rapid between.
  const std::size_t down = after.find("G1 Z-8."), up = after.find("Z1.", down);
  ASSERT_NE(down, after.npos) << after;
  ASSERT_NE(up, after.npos) << after;
  EXPECT_EQ(after.substr(down, up - down).find("G0"), std::string::npos) << after;
  EXPECT_NE(run.out.find("drilling"), std::string::npos);
  if (tests::has_browser()) {
    EXPECT_EQ(tests::open_page("copy", folder / "out.html"), "");
  }
}

}  // namespace
}  // namespace camber
