// Static coupling against milling simulated in time (tests/support/time_domain_milling.h), and that simulation against
// closed forms, itself and the rigid second calculation.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/accuracy_figure.h"
#include "tests/support/static_plane.h"
#include "tests/support/static_wall.h"

namespace camber::testing {
namespace {

using tests::expect_figure;
using tests::expect_vector_figure;
using tests::LargestFigure;

/// Half as fine as the benchmark's: seconds instead of a minute. Its figures are within 0.5 % of those.
JudgeSteps coarse() {
  JudgeSteps s;
  s.rotation_deg = 0.5, s.edge_mm = 0.04, s.grid_mm = 0.025, s.length_mm = 4.4, s.bent_rows = 7;
  return s;
}

WallJudgeSteps coarse_wall() {
  WallJudgeSteps s;
  s.rotation_deg = 0.5;
  return s;
}

WallJudgeSteps short_wall() {
  WallJudgeSteps s = coarse_wall();
  s.run_mm = 0.7;
  return s;
}

InclinedPlane plane(double young_GPa) {
  InclinedPlane p;
  p.young_MPa = 1000 * young_GPa;
  p.coupling = machine::Coupling::static_;
  return p;
}

constexpr double kStiff_GPa = 6e4;  ///< bends a hundredth of what carbide does

TEST(TimeDomainMilling, SlotForcesHaveTheirClosedForm) {
  // Mean of one tooth over half a turn: K a f / 4 along and across; of all teeth N times that.
  FinishedWall w;
  w.radial_mm = 12, w.young_MPa = 1000 * kStiff_GPa;
  w.material = {2000, 700, 0, 0, 0, 0};
  const auto f = judged_figures(w, short_wall());
  const double per_MPa = w.flutes * w.height_mm * w.feed_mm / 4;
  EXPECT_NEAR(std::abs(f.mean_N.y()), 2000 * per_MPa, 0.005 * 2000 * per_MPa);
  EXPECT_NEAR(std::abs(f.mean_N.x()), 700 * per_MPa, 0.02 * 700 * per_MPa);
  EXPECT_NEAR(f.chips_of_surface, 1, 0.003);
}

TEST(TimeDomainMilling, AStraightEdgesPeakIsThatOfItsFeed) {
  FinishedWall w;
  w.radial_mm = 12, w.young_MPa = 1000 * kStiff_GPa, w.helix_deg = 0, w.flutes = 1;
  w.material = {2000, 0, 0, 0, 0, 0};
  const auto f = judged_figures(w, short_wall());
  // Peak: the chip is the feed, the force along the edge's motion.
  EXPECT_NEAR(f.lateral_max_N, 2000 * w.height_mm * w.feed_mm, 0.005 * 2000 * w.height_mm * w.feed_mm);
}

TEST(TimeDomainMillingSlow, OfAStiffToolItIsTheRigidCalculationOfAPlane) {
  InclinedPlane p = plane(kStiff_GPa);
  JudgeSteps s = coarse();
  s.ramp_mm = 1e-4;
  const auto f = judged_figures(p, s);
  p.drawn_steps = 720, p.drawn_edge = 0.02;
  const CutFigures want = drawn_figures(p);
  // The edge's way is not a circle: as the tool feeds on, a tooth of two goes 1 % further than the drawn one, or less.
  EXPECT_NEAR(f.lateral_max_N, want.lateral_max_N, 0.02 * want.lateral_max_N);
  EXPECT_LT((f.mean_N - want.mean_N).norm(), 0.02 * want.mean_N.norm());
  EXPECT_NEAR(f.error_mean_um, want.error_mean_um, 0.03 * want.error_mean_um);
  EXPECT_NEAR(f.chips_of_surface, 1, 0.006);
}

TEST(TimeDomainMilling, OfAStiffToolItIsTheRigidCalculationOfAWall) {
  FinishedWall w;
  w.up = false, w.radial_mm = 2, w.young_MPa = 1000 * kStiff_GPa;
  const WallFigures want = drawn_figures(w);
  WallJudgeSteps s = coarse_wall();
  s.ramp_mm = 1e-4;
  const auto f = judged_figures(w, s);
  EXPECT_NEAR(f.lateral_max_N, want.lateral_max_N, 0.015 * want.lateral_max_N);
  EXPECT_LT((f.mean_N - want.mean_N).norm(), 0.01 * want.mean_N.norm());
  ASSERT_EQ(f.error_um.size(), want.error_um.size());
  for (std::size_t i = 0; i < want.error_um.size(); ++i)
    EXPECT_NEAR(f.error_um[i], want.error_um[i], 0.03 * want.error_um.front()) << i;
}

TEST(TimeDomainMillingSlow, ChipsAddUpToWhatTheSurfaceLosesAndStepsHardlyMatter) {
  const InclinedPlane p = plane(210);
  const auto a = judged_figures(p, coarse());
  JudgeSteps finer = coarse();
  finer.rotation_deg = 0.25, finer.grid_mm = 0.015, finer.edge_mm = 0.025;
  const auto b = judged_figures(p, finer);
  EXPECT_NEAR(a.chips_of_surface, 1, 0.01);
  EXPECT_NEAR(b.chips_of_surface, 1, 0.006);
  EXPECT_NEAR(a.lateral_max_N, b.lateral_max_N, 0.01 * b.lateral_max_N);
  EXPECT_LT((a.mean_N - b.mean_N).norm(), 0.01 * b.mean_N.norm());
  EXPECT_NEAR(a.median_um, b.median_um, 0.01 * b.median_um);
}

/// Peak and means are 1 % lower than the judge's in rigid coupling already: Camber's edges turn while the tool stands.
void expect_the_judged_plane(const InclinedPlane& p, double of_p5 = 0.025) {
  const auto want = judged_figures(p, coarse());
  const auto got = camber_figures(p);
  EXPECT_EQ(got.unsettled, 0u);
  expect_figure("peak force", got.lateral_max_N, want.lateral_max_N, 0.03);
  expect_vector_figure("mean force", got.mean_N, want.mean_N, 0.03);
  expect_figure("form error, 5th percentile", got.p5_um, want.p5_um, of_p5);
  expect_figure("form error, median", got.median_um, want.median_um, 0.025);
  expect_figure("form error, 95th percentile", got.p95_um, want.p95_um, 0.025);
  expect_figure("chips against surface", chips_over_surface(p, got), 1, 0.01);
}

TEST(StaticPlane, CarbideIsAsJudged) { expect_the_judged_plane(plane(600)); }

TEST(StaticPlaneSlow, HighSpeedSteelIsAsJudged) { expect_the_judged_plane(plane(210)); }

/// The surface is left where an edge enters with next to no chip, on what the tooth before left in another bend.
TEST(StaticPlaneSlow, UpMillingRowsOfHighSpeedSteelAreAsJudged) {
  InclinedPlane p = plane(210);
  p.along_x = 1;
  expect_the_judged_plane(p, 0.04);  // the judge's own changes by 3 % with its number of rows
}

TEST(StaticPlaneSlow, RunOutIsAsJudged) {
  InclinedPlane p = plane(300);
  p.pitch_deg = {180, 180}, p.run_out_mm = 0.01, p.run_out_deg = 20;
  expect_the_judged_plane(p);
}

void expect_the_judged_wall(FinishedWall w, double within_um = 0.3) {
  w.young_MPa = 300000, w.coupling = machine::Coupling::static_;
  const auto want = judged_figures(w, coarse_wall());
  const auto got = camber_figures(w);
  EXPECT_EQ(got.unsettled, 0u);
  const std::string side = w.up ? ", up" : ", down";
  expect_figure("peak force" + side, got.lateral_max_N, want.lateral_max_N, 0.03);
  expect_vector_figure("mean force" + side, got.mean_N, want.mean_N, 0.03);
  double largest = 0;
  for (const double e : want.error_um) largest = std::max(largest, std::abs(e));
  LargestFigure slices("form error of a slice" + side, std::max(within_um / largest, 0.03));
  for (std::size_t i = 0; i < want.error_um.size(); ++i)
    slices.expect(got.error_um[i], want.error_um[i], std::to_string(i), largest);
}

TEST(StaticWallSlow, ErrorsAreAsJudged) {
  for (const bool up : {true, false}) {
    FinishedWall w;
    w.up = up;
    expect_the_judged_wall(w);
  }
}

/// Of four teeth: which of them stands out tells the sense in which the run-out turns.
TEST(StaticWall, RunOutIsAsJudged) {
  FinishedWall w;
  w.pitch_deg = {90, 90, 90, 90}, w.run_out_mm = 0.01, w.run_out_deg = 20;
  expect_the_judged_wall(w, 0.4);  // 0.32 at the foot
}

TEST(StaticWall, WhereAToolIsPulledInTheJudgeFindsNoEquilibriumEither) {
  FinishedWall w;
  w.diameter_mm = 6, w.flutes = 2, w.radial_mm = 12, w.young_MPa = 210000;
  w.material = {1860, -900, 0, 15, 15, 0};
  w.coupling = machine::Coupling::static_;
  WallJudgeSteps s = coarse_wall();
  s.run_mm = 0.6, s.give_up_after = 100;
  w.height_mm = 3;
  EXPECT_GE(judged_figures(w, s).unsettled_steps, 100);
  EXPECT_GT(camber_figures(w).unsettled, 0u);
}

}  // namespace
}  // namespace camber::testing
