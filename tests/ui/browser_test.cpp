// The workbench as a person sees it: in headless Chromium.
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/triangle_mesh.h"
#include "tests/support/csv_columns.h"
#include "tests/support/open_page.h"
#include "tests/support/run_camber.h"
#include "tests/support/test_data.h"
#include "tests/support/wall_job.h"
#include "tests/support/workbench.h"

namespace camber {
namespace {

using tests::file_text;
using tests::TempFolder;
using tests::Workbench;
namespace fs = std::filesystem;

class Page : public ::testing::Test {
 protected:
  void SetUp() override {
    CAMBER_NEEDS_BROWSER();
    fs::create_directory(folder_ / "served");
  }
  /// What the check found wrong, a line each; empty: nothing.
  std::string checked(const std::string& check, const std::string& file = "") {
    const Workbench bench(folder_, "", "served");
    return tests::run_page_script("ui", fmt::format("{} '{}' '{}' '{}'", check, bench.url(), folder_ / "served", file));
  }
  TempFolder folder_;
};
class PageSlow : public Page {};

/// A block from `low` to `high`.
std::string block_stl(const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
  TriangleMesh out;
  for (int i = 0; i < 8; ++i)
    out.points.emplace_back((i & 1 ? high : low).x(), (i & 2 ? high : low).y(), (i & 4 ? high : low).z());
  out.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return stl_text(out);
}

TEST_F(PageSlow, LeadsFromADroppedProgramToTheCompensatedOneOfTheCommandLine) {
  EXPECT_EQ(checked("whole_way", tests::data_path("nc/fusion_parallel_ball_inch.nc")), "");
  const auto by_hand = tests::run_camber(folder_, "compensate served/ball/job.toml -o by_hand.nc --keep-anyway");
  const std::string expected = file_text(folder_ / "by_hand.nc");
  EXPECT_NE(expected, "") << by_hand.err;
  // The programs would be hundreds of kilobytes in the log.
  EXPECT_TRUE(file_text(folder_ / "served/downloaded.nc") == expected);
}

TEST_F(Page, LinksLinesWithMoves) {
  tests::write_wall(folder_, "served/wall/");
  EXPECT_EQ(checked("path"), "");
}

TEST_F(Page, ShowsErrorsOfAProgramAtTheirLinesAndNothingOfTheJobBefore) {
  tests::write_wall(folder_, "served/wall/");
  EXPECT_EQ(checked("wrong_program"), "");
}

TEST_F(Page, LeadsFromAMessageToItsSetting) {
  tests::write_wall(folder_, "served/wall/");
  folder_.write("served/wall/job.toml", tests::replaced(tests::wall_job(), "flutes = 2", "flutes = 0"));
  EXPECT_EQ(checked("wrong_job"), "");
}

TEST_F(Page, DrawsWhatOnlyTheJobKnowsInLettersOfWindows) { EXPECT_EQ(checked("pocket"), ""); }

TEST_F(Page, HasEveryTextInGerman) {
  tests::write_wall(folder_, "served/wall/");
  folder_.write("served/wall/part.stl", block_stl({0, 0, -2}, {8, 2, 0}));
  const std::string way = "S3000 M3\nG0 X-4. Y-2.\nG0 Z-1.\nG1 X2. F600\nG0 Z5.\n", job = tests::wall_job();
  folder_.write("served/wall/p.nc", tests::replaced(tests::kWallProgram, "M30", "T2 M6\n" + way + "M30"));
  const auto from = job.find("[tool.1]"), to = job.find("[material]");
  folder_.write("served/wall/job.toml", job + tests::replaced(job.substr(from, to - from), "tool.1", "tool.2") +
                                            "[part]\nmesh = \"part.stl\"\n");
  EXPECT_EQ(checked("german"), "");
}

TEST_F(Page, JudgesWhatIsTypedAndWritesItInMillimetres) {
  tests::write_wall(folder_, "served/wall/");
  EXPECT_EQ(checked("typing"), "");
}

TEST_F(Page, MovesThePartIntoItsPlaceByEye) {
  tests::write_wall(folder_, "served/wall/");
  folder_.write("served/wall/part.stl", block_stl({20, 0, -2}, {28, 2, 0}));
  folder_.write("served/wall/job.toml", tests::wall_job() + "[part]\nmesh = \"part.stl\"\n");
  EXPECT_EQ(checked("part"), "");
}

TEST_F(Page, DrawsBlanksOfEveryKind) {
  const std::string box = "box_mm = [[0, -0.5, -2], [8, 2, 0]]", job = tests::wall_job();
  for (const auto& [name, stock] :
       {std::pair{"left", "vdb = \"r/stock.vdb\""},
        {"mesh", "mesh = \"blank.stl\""},
        {"round", "cylinder = { base_mm = [4, 3, -2], diameter_mm = 12, height_mm = 2 }"}}) {
    const std::string at = fmt::format("served/{}/", name);
    tests::write_wall(folder_, at);
    folder_.write(at + "blank.stl", block_stl({0, -0.5F, -2}, {8, 2, 0}));
    tests::run_camber(folder_, fmt::format("predict {}job.toml -o {}r", at, at));
    folder_.write(at + "job.toml", tests::replaced(job, box, stock));
  }
  EXPECT_EQ(checked("blanks"), "");
}

TEST_F(Page, DrawsTheTipOnThePartWhereRotaryAxesTurn) {
  const std::string sample = CAMBER_SOURCE_DIR "/samples/12-five-axis/";
  fs::create_directory(folder_ / "served/dome");
  fs::copy_file(sample + "machine.toml", folder_ / "served/dome/machine.toml");
  const auto posted =
      tests::run_camber(folder_, "post '" + sample + "dome.nc' -o served/dome/p.nc --machine served/dome/machine.toml");
  ASSERT_EQ(posted.status, 0) << posted.err;
  folder_.write(
      "served/dome/job.toml",
      "program = \"p.nc\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"ball\"\ndiameter_mm = 6.0\nflutes = "
      "2\noverhang_mm = 30.0\n[material]\nktc_MPa = 800.0\nkrc_MPa = 300.0\n[stock]\nbox_mm = [[-12, -12, "
      "-15], [12, 12, 0]]\n[simulation]\nvoxel_mm = 0.5\n");
  EXPECT_EQ(checked("rotary", sample + "dome.nc"), "");
}

TEST_F(PageSlow, LaysMeasuredPointsOverTheErrorMap) {
  tests::write_wall(folder_, "served/wall/");
  ASSERT_EQ(tests::run_camber(folder_, "predict served/wall/job.toml -o predicted").status, 0);
  const auto columns = tests::columns_of(file_text(folder_ / "predicted/form_error.csv"));
  std::string points = "x_mm,y_mm,z_mm,nx,ny,nz,error_um\n";
  for (std::size_t i = 0; i < columns.at("x_mm").size(); i += 9) {
    const auto of = [&](const char* name) { return columns.at(name)[i]; };
    if (of("ny") < -0.9)  // the wall, where the tool bends along the normal
      points += fmt::format("{},{},{},{},{},{},{:.3f}\n", of("x_mm"), of("y_mm"), of("z_mm"), of("nx"), of("ny"),
                            of("nz"), 1.2 * of("error_um"));
  }
  folder_.write("served/wall/points.csv", points);
  EXPECT_EQ(checked("measured"), "");
}

TEST_F(Page, RunsAllJobsOfAShopAndShowsResultsSideBySide) {
  for (const char* name : {"served/a/", "served/b/", "served/c/"}) tests::write_wall(folder_, name);
  EXPECT_EQ(checked("shop"), "");
}

}  // namespace
}  // namespace camber
