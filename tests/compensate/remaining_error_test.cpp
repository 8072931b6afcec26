// Plain figures of what is in reach, and the verdict on them.
#include "compensate/remaining_error.h"

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
  std::vector<ProgramLine> lines;
  for (int i = 0; i < 5; ++i) {
    s.add(8, 0, true);
    points.push_back({Cause::bow, 0.001 * (i + 1)});
    const auto line = static_cast<std::size_t>(10 * (5 - i));
    lines.push_back({line, line + 1});
  }
  s.add(1, 0, true);
  points.push_back({Cause::tip, 0.001});
  lines.push_back({7, 8});
  const ErrorSplit split{.tip_um = 1, .bow_um = 8};
  const auto causes = causes_of(split, points, s.observed, lines);
  ASSERT_EQ(causes.size(), 1u) << "the tip's part is less than a tenth of the mean square";
  EXPECT_EQ(causes[0].cause, Cause::bow);
  EXPECT_EQ(causes[0].lines, (std::vector<ProgramLine>{{10, 11}, {20, 21}, {30, 31}}))
      << "the worst three, in the program's order";
  CauseFigure bow = causes[0];
  bow.remedies = {"a", "b", "c"};
  EXPECT_EQ(sentence(bow),
            "8.00 um rms differs along the cutter (helix bow), most in lines 10 (11 as emitted), 20 (21 as emitted), "
            "30 (31 as emitted); a, b or c would remove it");
  bow.lines = {{10, 10}};
  bow.remedies.clear();
  EXPECT_EQ(sentence(bow),
            "8.00 um rms differs along the cutter (helix bow), most in line 10; what was tried does not remove it");
}

TEST(Causes, HaveNoRemedyThatWasTried) {
  using Words = std::vector<std::string>;
  const auto remedies = [](Cause cause, const Tried& tried, ContourCause contour = ContourCause::none) {
    return remedies_of({.cause = cause, .contour = contour}, tried);
  };
  EXPECT_EQ(remedies(Cause::bow, {}), (Words{"a second cut (lever \"passes\")", "a shorter tool", "a lower feed"}));
  EXPECT_EQ(remedies(Cause::bow, {.feeds = true, .second_cuts = true}), Words{"a shorter tool"});
  EXPECT_EQ(remedies(Cause::bow, {.feeds = true, .second_cuts = true, .pass_before = false}),
            (Words{"less stock left by the pass before (lever \"allowance\")", "a shorter tool"}));
  EXPECT_EQ(remedies(Cause::correctable, {}), Words{"more rounds (max_rounds)"});
  EXPECT_EQ(remedies(Cause::correctable, {.rounds = true}), Words{});
  EXPECT_EQ(remedies(Cause::short_range, {.feeds = true}), Words{});
  EXPECT_EQ(remedies(Cause::short_range, {.feeds = true}, ContourCause::path_tolerance),
            Words{"a smaller path tolerance (G64 P, tolerance_mm of the corner)"});
}

TEST(Causes, NameTheFigureAtWhichALimitNoLongerBinds) {
  const BindingLimit shift{.key = kMaxShiftKey, .value = 0.1, .binds_no_more_at = 0.134},
      depth{.key = kOvercutKey, .value = 4.2, .binds_no_more_at = 6.5, .own = false};
  EXPECT_EQ(sentence(shift), "max_shift_mm = 0.1 binds; from 0.134 on it would not");
  EXPECT_EQ(sentence(depth), "max_overcut_um = 4.2 (default) binds; from 6.5 on it would not");
  BindingLimit placed = shift;
  placed.count = 34;
  placed.line = {12, 15};
  placed.effect = {5.1, 3.2, 10, 14};
  EXPECT_EQ(sentence(placed),
            "max_shift_mm = 0.1 binds at 34 points of the path, most in line 12 (15 as emitted); from 0.134 on it "
            "would not; without it the 95th percentile of lines 10 to 14 would be 3.20 instead of 5.10 um");
  const Tried tried{.feeds = true, .limits = {shift, depth}};
  EXPECT_EQ(remedies_of({.cause = Cause::limited}, tried),
            (std::vector<std::string>{"max_shift_mm = 0.134 (0.1 now)", "a shorter tool"}));
  EXPECT_EQ(remedies_of({.cause = Cause::guard}, tried), std::vector<std::string>{"max_overcut_um = 6.5"});

  // It was tried and brought nothing, or it holds back next to nothing.
  BindingLimit vain = placed, rare = placed;
  vain.effect.without_um = 4.9;
  rare.of_path = 0.002;
  for (const BindingLimit& limit : {vain, rare})
    EXPECT_EQ(remedies_of({.cause = Cause::limited}, {.feeds = true, .limits = {limit}}),
              std::vector<std::string>{"a shorter tool"});
}

TEST(Causes, ServoLagPathToleranceAndCornerLawAreThree) {
  const auto cause = [](double lag_um, double tolerance_um, double rest_um) {
    removal::SurfacePoint p;
    p.area_mm2 = 1;
    p.lag_mm = static_cast<float>(lag_um / 1000);
    p.path_tolerance_mm = static_cast<float>(tolerance_um / 1000);
    p.contour_mm = (lag_um + tolerance_um + rest_um) / 1000;
    return contour_cause_of(Cause::short_range, {{Cause::short_range, 0.010}}, {p});
  };
  EXPECT_EQ(cause(9, 1, 1), ContourCause::lag);
  EXPECT_EQ(cause(1, 9, 1), ContourCause::path_tolerance);
  EXPECT_EQ(cause(1, 1, 9), ContourCause::corner_law);
  EXPECT_EQ(cause(5, 1, 1), ContourCause::none) << "a quarter of the error's mean square";
}

}  // namespace
}  // namespace camber::compensate
