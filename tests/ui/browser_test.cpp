// The workbench as a person sees it: in headless Chromium.
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

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

TEST_F(PageSlow, LeadsFromADroppedProgramToTheCompensatedOneOfTheCommandLine) {
  EXPECT_EQ(checked("whole_way", tests::data_path("nc/fusion_parallel_ball_inch.nc")), "");
  const auto by_hand = tests::run_camber(folder_, "compensate served/ball/job.toml -o by_hand.nc --keep-anyway");
  EXPECT_NE(file_text(folder_ / "by_hand.nc"), "") << by_hand.err;
  EXPECT_EQ(file_text(folder_ / "served/downloaded.nc"), file_text(folder_ / "by_hand.nc"));
}

TEST_F(Page, LinksLinesWithMoves) {
  tests::write_wall(folder_, "served/wall/");
  EXPECT_EQ(checked("path"), "");
}

TEST_F(Page, ShowsErrorsOfAProgramAtTheirLines) { EXPECT_EQ(checked("wrong_program"), ""); }

TEST_F(Page, JudgesWhatIsTypedAndWritesItInMillimetres) {
  tests::write_wall(folder_, "served/wall/");
  EXPECT_EQ(checked("typing"), "");
}

TEST_F(Page, RunsAllJobsOfAShopAndShowsResultsSideBySide) {
  for (const char* name : {"served/a/", "served/b/", "served/c/"}) tests::write_wall(folder_, name);
  EXPECT_EQ(checked("shop"), "");
}

}  // namespace
}  // namespace camber
