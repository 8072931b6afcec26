// Plain figures of what is in reach, and the verdict on them.
#include "compensate/verdict.h"

#include <gtest/gtest.h>

namespace camber::compensate {
namespace {

/// Points of 1 mm2 each: error and contour, um.
struct Surface {
  std::vector<removal::SurfacePoint> points;
  Observed observed;

  void add(double error_um, double contour_um, bool in_reach) {
    removal::SurfacePoint p;
    p.error_mm = error_um / 1000;
    p.contour_mm = contour_um / 1000;
    p.area_mm2 = 1;
    points.push_back(p);
    Observation o;
    o.error_mm = p.error_mm;
    o.area_mm2 = 1;
    observed.points.push_back(o);
    observed.compensated.push_back(true);
    observed.reach.push_back(in_reach);
  }
  PlainFigures figures(const machine::CompensationSettings& asked) const {
    return plain_figures(points, {}, observed, asked);
  }
};

TEST(PlainFigures, CountEverythingInReachAndNothingElse) {
  Surface s;
  s.add(3, 1, true);
  s.add(-4, 2, true);
  s.add(100, 0, false);
  const PlainFigures f = s.figures({});
  EXPECT_DOUBLE_EQ(f.error_um.area_mm2, 2);
  EXPECT_NEAR(f.error_um.rms, std::sqrt((9.0 + 16) / 2), 1e-9);
  EXPECT_NEAR(f.deflection_um.rms, std::sqrt((4.0 + 36) / 2), 1e-9);
  EXPECT_NEAR(f.contour_um.rms, std::sqrt((1.0 + 4) / 2), 1e-9);
  EXPECT_NEAR(f.error_um.max, 3, 1e-9);
  EXPECT_NEAR(f.error_um.min, -4, 1e-9);
  EXPECT_FALSE(f.total_um);
}

TEST(Verdict, IsOnThePlain95thPercentile) {
  Surface s;
  for (int i = 0; i < 100; ++i) s.add(i < 94 ? 1 : 9, 0, true);
  machine::CompensationSettings asked;
  asked.tolerance_um = 5;
  EXPECT_FALSE(within_tolerance(s.figures(asked), asked)) << "6 % are over";
  s.points[94].error_mm = s.points[95].error_mm = 0.001;
  EXPECT_TRUE(within_tolerance(s.figures(asked), asked)) << "4 % are over";
}

TEST(Verdict, WithABandIsOnTheAreaInIt) {
  Surface s;
  for (int i = 0; i < 100; ++i) s.add(i < 6 ? -4 : 9, 0, true);
  machine::CompensationSettings asked;
  asked.profile_um = {-5, 10};
  EXPECT_TRUE(within_tolerance(s.figures(asked), asked));
  asked.profile_um = {-3, 10};
  EXPECT_DOUBLE_EQ(s.figures(asked).in_band_fraction, 0.94);
  EXPECT_FALSE(within_tolerance(s.figures(asked), asked));
}

TEST(Verdict, LeavesTheContourOutWhereTheReferenceIsTheMachine) {
  Surface s;
  for (int i = 0; i < 10; ++i) s.add(12, 11, true);
  machine::CompensationSettings asked;
  asked.tolerance_um = 5;
  EXPECT_FALSE(within_tolerance(s.figures(asked), asked));
  asked.reference = machine::Reference::machine;
  EXPECT_TRUE(within_tolerance(s.figures(asked), asked));
}

TEST(Causes, NameTheWorstLinesOfTheLargestParts) {
  Surface s;
  std::vector<PointCause> points;
  std::vector<std::size_t> lines;
  for (int i = 0; i < 5; ++i) {
    s.add(8, 0, true);
    points.push_back({Cause::bow, 0.001 * (i + 1)});
    lines.push_back(static_cast<std::size_t>(10 * (5 - i)));
  }
  s.add(1, 0, true);
  points.push_back({Cause::tip, 0.001});
  lines.push_back(7);
  const ErrorSplit split{.tip_um = 1, .bow_um = 8};
  const auto causes = causes_of(split, points, s.observed, lines);
  ASSERT_EQ(causes.size(), 1u) << "the tip's part is less than a tenth of the mean square";
  EXPECT_EQ(causes[0].cause, Cause::bow);
  EXPECT_EQ(causes[0].lines, (std::vector<std::size_t>{10, 20, 30})) << "the worst three, in the program's order";
  EXPECT_EQ(sentence(causes[0]),
            "8.00 um rms differs along the cutter (helix bow), most in lines 10, 20, 30; a second cut (lever "
            "\"passes\"), a shorter tool or a lower feed would remove it");
  CauseFigure twice = causes[0];
  twice.cut_twice = true;
  EXPECT_EQ(
      sentence(twice),
      "8.00 um rms differs along the cutter (helix bow), most in lines 10, 20, 30; a shorter tool or a lower feed "
      "would remove it");
}

}  // namespace
}  // namespace camber::compensate
