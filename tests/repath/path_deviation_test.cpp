// The deviation that is measured, against paths whose distance is known.
#include <numeric>

#include <gtest/gtest.h>

#include "repath/path_deviation.h"
#include "tests/nc/nc_text.h"

namespace camber::repath {
namespace {

const std::string kHead = "G21 G90 G17\nG0 X0. Y0. Z0.\nG1 F500\n";

DeviationFigures measured(const std::string& before, const std::string& after, const std::vector<RewrittenRun>& runs) {
  const auto a = nc::read_clean(kHead + before + "M30\n"), b = nc::read_clean(kHead + after + "M30\n");
  return measure_deviation(a.moves, b.moves, runs, 0.01);
}

RewrittenRun run(std::uint32_t first, std::uint32_t last, std::uint32_t first_after, std::uint32_t last_after) {
  RewrittenRun r;
  r.first_block = first, r.last_block = last, r.first_block_after = first_after, r.last_block_after = last_after;
  return r;
}

TEST(MeasuredDeviation, IsThatOfTheSkippedPeak) {
  const auto figures = measured("X5. Y0.006\nX10. Y0.\n", "X10. Y0.\n", {run(3, 4, 3, 3)});
  EXPECT_NEAR(figures.max_mm, 0.006, 1e-9);
  EXPECT_NEAR((figures.worst_place_mm - Vec3(5, 0.006, 0)).norm(), 0, 0.01);
  EXPECT_NEAR(figures.length_mm, 10, 1e-9);
  const auto& bins = figures.length_by_deviation_mm;
  EXPECT_NEAR(std::accumulate(bins.begin(), bins.end(), 0.0), 10, 1e-9);
}

TEST(MeasuredDeviation, OfAnArcThatStandsForItsChordIsTheSagitta) {
  // A quarter of a circle of 10 mm in four chords: 10 (1 - cos(pi / 16)) = 0.192 mm, far beyond the tolerance.
  const auto figures = measured("X3.827 Y0.761\nX7.071 Y2.929\nX9.239 Y6.173\nX10. Y10.\n", "G3 X10. Y10. I0. J10.\n",
                                {run(3, 6, 3, 3)});
  EXPECT_NEAR(figures.max_mm, 10 * (1 - std::cos(kPi / 16)), 0.0005);
  EXPECT_NEAR(figures.length_by_deviation_mm.back(), figures.length_mm, 0.15 * figures.length_mm);
}

TEST(MeasuredDeviation, FindsALoopThatIsLeftOutAndWhatTurnsBack) {
  EXPECT_NEAR(measured("X5.\nY3.\nY0.\nX10.\n", "X10.\n", {run(3, 6, 3, 3)}).max_mm, 3, 1e-9);
  // The new path goes on to X12 and back: no point of the old one is there.
  EXPECT_NEAR(measured("X5.\nX10.\n", "X12.\nX10.\n", {run(3, 4, 3, 4)}).max_mm, 2, 1e-9);
}

TEST(MeasuredDeviation, OutsideOfRunsNothingIsMeasured) {
  const auto figures = measured("X5.\nX10.\nF300\nX20. Y5.\n", "X10.\nF300\nX20. Y0.\n", {run(3, 4, 3, 3)});
  EXPECT_EQ(figures.max_mm, 0);
}

}  // namespace
}  // namespace camber::repath
