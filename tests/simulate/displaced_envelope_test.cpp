// Finishing cuts against the drawn ones of tests/support/displaced_envelope.h: rays for the chips, displaced facets for
// the surface. bench/accuracy has more of them.
#include <gtest/gtest.h>

#include "tests/support/accuracy_figure.h"
#include "tests/support/finished_wall.h"
#include "tests/support/inclined_plane.h"

namespace camber::simulate {
namespace {

using testing::CutFigures;
using testing::FinishedWall;
using testing::InclinedPlane;
using testing::WallFigures;
using tests::expect_figure;
using tests::expect_vector_figure;
using tests::LargestFigure;

constexpr double kAgreement = 0.02, kGridAgreement = 0.01;

void expect_near(const CutFigures& got, const CutFigures& want) {
  expect_figure("peak force", got.lateral_max_N, want.lateral_max_N, kAgreement);
  expect_vector_figure("mean force", got.mean_N, want.mean_N, kAgreement);
  expect_figure("form error, median", got.median_um, want.median_um, kAgreement);
  expect_figure("form error, 5th percentile", got.p5_um, want.p5_um, kAgreement, want.p95_um);
  expect_figure("form error, 95th percentile", got.p95_um, want.p95_um, kAgreement);
  expect_figure("form error, mean", got.error_mean_um, want.error_mean_um, kAgreement);
}

TEST(DisplacedEnvelopeSlow, AForceThatRisesWithinAStepLeavesItsMark) {
  // At 60 degrees the edge enters the cut almost along its whole length: a sixth of the peak in a degree. A straight
  // line between the degrees left the least errors 8 % too large.
  InclinedPlane p;
  p.slope_deg = 60;
  p.drawn_steps = 1440, p.drawn_edge = 0.01;
  const CutFigures want = drawn_figures(p), got = camber_figures(p);
  expect_near(got, want);
  EXPECT_NEAR(got.p5_um, want.p5_um, kAgreement * want.p5_um);
}

TEST(DisplacedEnvelope, StraightFlutesMarkTheWallAsTheyEnter) {
  // All of the edge enters at once, between two rotation steps: drawn over the step the mark was 0.7 um off.
  constexpr double kAgreement_um = 0.15;
  for (const bool up : {true, false}) {
    FinishedWall w;
    w.helix_deg = 0;
    w.up = up;
    const WallFigures want = drawn_figures(w), got = camber_figures(w);
    for (std::size_t i = 0; i < want.error_um.size(); ++i)
      EXPECT_NEAR(got.error_um[i], want.error_um[i], kAgreement_um);
  }
}

TEST(DisplacedEnvelopeSlow, InclinedPlaneAgreesWhereverTheGridLies) {
  InclinedPlane p;
  const CutFigures want = drawn_figures(p);
  std::vector<CutFigures> all;
  for (const Vec3& voxels : {Vec3(0, 0, 0), Vec3(0.33, 0.67, 0.21), Vec3(0.71, 0.13, 0.41)}) {
    p.offset_mm = p.voxel_mm * voxels;
    all.push_back(camber_figures(p));
    expect_near(all.back(), want);
  }
  CutFigures mean;
  for (const auto& f : all) {
    const double fraction = 1.0 / static_cast<double>(all.size());
    mean.lateral_max_N += fraction * f.lateral_max_N;
    mean.mean_N += fraction * f.mean_N;
    mean.error_mean_um += fraction * f.error_mean_um;
    mean.p95_um += fraction * f.p95_um;
  }
  for (const auto& f : all) {
    EXPECT_NEAR(f.lateral_max_N, mean.lateral_max_N, kGridAgreement * mean.lateral_max_N);
    EXPECT_LT((f.mean_N - mean.mean_N).norm(), kGridAgreement * mean.mean_N.norm());
    EXPECT_NEAR(f.error_mean_um, mean.error_mean_um, kGridAgreement * mean.error_mean_um);
    EXPECT_NEAR(f.p95_um, mean.p95_um, kGridAgreement * mean.p95_um);
  }
}

TEST(DisplacedEnvelopeSlow, FlatterPlaneWithRowsDownwardsAgrees) {
  InclinedPlane p;
  p.slope_deg = 30, p.feed_mm = 0.1, p.upwards = false, p.along_x = 1;
  expect_near(camber_figures(p), drawn_figures(p));
}

void expect_wall(const FinishedWall& w, double agreement = kAgreement) {
  const WallFigures want = drawn_figures(w), got = camber_figures(w);
  const std::string side = w.up ? ", up" : ", down";
  expect_figure("peak force" + side, got.lateral_max_N, want.lateral_max_N, kAgreement);
  expect_vector_figure("mean force" + side, got.mean_N, want.mean_N, kAgreement);
  double largest = 0;
  for (const double e : want.error_um) largest = std::max(largest, std::abs(e));
  ASSERT_GT(largest, 1);
  ASSERT_EQ(got.error_um.size(), want.error_um.size());
  LargestFigure slices("form error of a slice" + side, agreement);
  for (std::size_t i = 0; i < want.error_um.size(); ++i)
    slices.expect(got.error_um[i], want.error_um[i], std::to_string(i), largest);
}

TEST(DisplacedEnvelope, HelicalMillAlongAWallAgreesUpMilling) { expect_wall({.up = true}); }

TEST(DisplacedEnvelope, SteepHelixAlongAWallAgrees) {
  // Errors of 1 to 3 um: what the map of the surface itself loses shows.
  expect_wall({.helix_deg = 45, .up = true});
}

TEST(DisplacedEnvelope, VerySteepHelixAlongAWallAgrees) {
  // Rings 0.1 mm wide lag by two degrees each: the peak was 2.5 % too high.
  for (const bool up : {true, false}) {
    const FinishedWall w{.helix_deg = 60, .up = up};
    const double want = drawn_figures(w).lateral_max_N;
    expect_figure(up ? "peak force, up" : "peak force, down", camber_figures(w).lateral_max_N, want, 0.01);
  }
}

TEST(DisplacedEnvelopeSlow, TeethOfUnequalPitchMarkTheWallAtTheirOwnInstants) {
  // At the instants of even teeth the wall was 3.8 um of 16 off.
  for (const bool up : {true, false}) {
    FinishedWall w{.up = up, .drawn_steps = 720};
    w.pitch_deg = {85, 97, 83, 95};
    expect_wall(w);
  }
}

TEST(DisplacedEnvelopeSlow, RunOutMarksTheWall) {
  // The tooth that stands out takes more, marks alone, and deeper by its throw, which the helix turns over the height.
  for (const bool up : {true, false}) {
    FinishedWall w{.up = up, .drawn_steps = 720};
    w.pitch_deg = {90, 90, 90, 90};
    w.run_out_mm = 0.01, w.run_out_deg = 20;
    expect_wall(w);
  }
}

TEST(DisplacedEnvelope, HalfImmersionDownMillingAgrees) {
  // 77 um of bending at 50 um of feed: far stamps mark the wall, and the cut reaches a radius ahead of it.
  expect_wall({.radial_mm = 5, .up = false}, 0.01);
}

TEST(DisplacedEnvelope, HelicalMillAlongAWallAgreesDownMilling) {
  expect_wall({.up = false, .offset_mm = Vec3(0.037, 0.051, 0.023)});
}

}  // namespace
}  // namespace camber::simulate
