#include "feedmodel/feed_csv.h"

#include <gtest/gtest.h>

#include "base/units.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_program.h"

namespace camber::feedmodel {
namespace {

TEST(FeedCsv, HasEveryComponentInItsColumn) {
  const tests::TempFolder folder;
  tests::TestProgram p;
  p.line(10, 0, 0, 600);
  TimedSample sample{.t_s = 0.25, .position_mm = {1, 2, 3}, .velocity_mm_per_s = {4, 5, 6}};
  sample.feed_command_mm_per_s = 10;
  JointSample joints;
  joints.position_rad = {rad_from_deg(7), rad_from_deg(8), rad_from_deg(9)};
  joints.tool = {{11, 12, 13}, {0.36, 0.48, 0.8}};
  joints.feed_mm_per_s = 9;
  FeedCsv csv(p.program, folder / "feed.csv", "ac");
  csv.write({&sample, 1}, {&joints, 1});
  csv.commit();
  const std::string text = tests::file_text(folder / "feed.csv");
  EXPECT_EQ(text.substr(text.find('\n') + 1),
            "0.250000,1,1.00000,2.00000,3.00000,240.000,300.000,360.000,600.000,540.000,7.00000,9.00000,"
            "11.00000,12.00000,13.00000,0.360000000,0.480000000,0.800000000\n");
}

}  // namespace
}  // namespace camber::feedmodel
