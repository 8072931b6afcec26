#include "calib/fit_stretches.h"

#include <gtest/gtest.h>

#include <cmath>

#include "feedmodel/motion_plan.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"
#include "tests/support/test_data.h"
#include "tests/support/test_program.h"

namespace camber::calib {
namespace {

constexpr double kExtrapolation = 0.025;  // of a time, at feeds of two to ten times those that were fitted

std::string nist(const std::string& file) { return tests::data_path("nist/" + file); }

nc::Interpretation nist_program() {
  Diagnostics diagnostics;
  return nc::interpret(nc::read_program(SourceText::read(nist("box_op5.nc")), diagnostics), {}, diagnostics);
}

StretchLaw stop_law() { return {"stop", machine::CornerLaw::angle, 0.6, false}; }

machine::Machine known_machine() {
  machine::Machine m;
  m.control.corner.law = machine::CornerLaw::angle;
  m.control.corner.time_s = 0.009;
  m.control.corner.stop_angle_rad = 0.6;
  m.control.corner.stop_time_s = 0.035;
  m.control.path_acceleration_mm_per_s2 = 520;
  m.control.arc_normal_fraction = 1.5;
  m.control.rapid_change_s = 0.09;
  return m;
}

/// A dozen figures of three tools: zigzags of many angles, facets, arcs.
nc::Interpretation figures() {
  tests::TestProgram p;
  int tool = 0;
  for (double feed : {1000.0, 2500.0, 4500.0}) {
    p.new_state().tool = ++tool;
    for (double turn : {0.09, 0.2, 0.35, 0.8, 1.57}) {
      p.rapid(0, 0, 0);
      double x = 0, y = 0, heading = 0;
      for (int i = 0; i < 14; ++i) {
        x += (2 + turn + i % 3) * std::cos(heading);
        y += (2 + turn + i % 3) * std::sin(heading);
        heading += turn;
        p.line(x, y, 0, feed);
      }
    }
    for (double r : {0.3, 1.0, 3.0}) {
      p.rapid(0, 0, 5).rapid(0, 0, 0);
      for (int i = 0; i < 6; ++i) p.arc_xy(0, 0, r, 0, 2 * kPi, feed);
    }
    p.rapid(0, 0, 10);
  }
  return p.program;
}

/// Times as the planner itself has them, a program's rapids and clock included.
std::vector<TimedStretch> planned(const nc::Interpretation& program, const machine::Machine& machine) {
  std::vector<TimedStretch> timed;
  const auto segments = feedmodel::plan_motion(program, machine).times;
  for (const FeedStretch& s : feed_stretches(program)) {
    double first = -1, end = 0;
    for (const auto& segment : segments) {
      if (segment.move < s.move_first || segment.move >= s.move_end) continue;
      if (first < 0) first = segment.start_s;
      end = segment.start_s + segment.duration_s;
    }
    timed.push_back({s, end - first, 0.01});
  }
  return timed;
}

TEST(FitStretches, GivesAKnownMachineBackFromTheTimesAlone) {
  const machine::Machine known = known_machine();
  StretchRun run{"figures", figures(), {}};
  run.timed = planned(run.program, known);
  const StretchFit fit = fit_stretches({run}, {}, {.laws = {stop_law()}});
  EXPECT_TRUE(fit.converged) << fit.message;
  EXPECT_EQ(fit.folds, 3);
  const machine::Control &is = fit.machine.control, &was = known.control;
  EXPECT_NEAR(is.path_acceleration_mm_per_s2 / was.path_acceleration_mm_per_s2, 1, 0.03);
  EXPECT_NEAR(is.corner.time_s / was.corner.time_s, 1, 0.05);
  EXPECT_NEAR(is.corner.stop_time_s / was.corner.stop_time_s, 1, 0.05);
  EXPECT_NEAR(is.arc_normal_fraction / was.arc_normal_fraction, 1, 0.05);
  EXPECT_LT(fit.held_out.mean, 0.2);
  EXPECT_GT(fit.constant_feed.mean, 5);
}

TEST(FitStretches, PrefersTheLawThatTheTimesWereMadeWith) {
  machine::Machine known = known_machine();
  known.control.corner.stop_angle_rad = machine::kNoLimit;
  StretchRun run{"figures", figures(), {}};
  run.timed = planned(run.program, known);
  StretchLaw without = stop_law();
  without.name = "no stop";
  without.stop_angle_rad = machine::kNoLimit;
  const StretchFit fit = fit_stretches({run}, {}, {.laws = {stop_law(), without}});
  EXPECT_EQ(fit.laws[fit.chosen].law.name, "no stop");
}

TEST(FitStretches, CountsCopiesOnceAndKeepsThemInOneFold) {
  const nc::Interpretation program = nist_program();
  const auto table = read_stretch_table(nist("op5_feed_runs.csv"), program);
  ASSERT_EQ(table.size(), 82u);
  EXPECT_EQ(table[0].stretch.line_first, 21u);
  EXPECT_EQ(table[0].stretch.geometry, table[4].stretch.geometry);  // 21-43 again at 91-113
  EXPECT_NE(table[0].stretch.geometry, table[1].stretch.geometry);
  const auto once = one_for_each_geometry(table, program);
  EXPECT_LT(once.size(), 30u);
  EXPECT_NEAR(programmed_time_s(table[0].stretch, program), 17.24, 0.001);
}

/// Tables of logs without rapids have pieces: from the end of one line to the end of another.
TEST(FitStretches, TakesPiecesOfARunWithMovingEnds) {
  const machine::Machine known = known_machine();
  StretchRun run{"figures", figures(), {}};
  const auto whole = planned(run.program, known);
  const auto segments = feedmodel::plan_motion(run.program, known).times;
  for (const TimedStretch& t : whole) {
    const std::size_t first = t.stretch.move_first, end = t.stretch.move_end;
    if (end - first < 6) continue;
    const FeedStretch piece = piece_of(t.stretch, run.program, first + 1, end - 1);
    EXPECT_TRUE(piece.begins_in_motion() && piece.ends_in_motion());
    double from_s = -1, to_s = 0;
    for (const feedmodel::SegmentTime& s : segments) {
      if (s.move < piece.move_first || s.move >= piece.move_end) continue;
      if (from_s < 0) from_s = s.start_s;
      to_s = s.start_s + s.duration_s;
    }
    run.timed.push_back({piece, to_s - from_s, 0.01});
  }
  ASSERT_GT(run.timed.size(), 8u);
  const StretchFit fit = fit_stretches({run}, {}, {.laws = {stop_law()}});
  EXPECT_LT(fit.held_out.mean, 1.0);
}

TEST(FitStretches, PredictsToolsOfTheNistBoxThatItHasNotSeen) {
  StretchRun run{"box_op5", nist_program(), {}};
  run.timed = read_stretch_table(nist("op5_feed_runs.csv"), run.program);
  StretchLaw law = stop_law();
  const StretchFit fit = fit_stretches({run}, {}, {.laws = {law}});
  EXPECT_TRUE(fit.converged) << fit.message;
  EXPECT_EQ(fit.folds, 9);
  EXPECT_LT(fit.held_out.mean, 0.5);
  EXPECT_LT(fit.held_out.p90, 1.0);
  EXPECT_LT(fit.held_out.worst, 1.5);
  EXPECT_LT(std::abs(fit.held_out.total), 0.3);
  EXPECT_GT(fit.constant_feed.worst, 20);
  // Each kind of motion (arcs, facets, lines) predicted by a fit on the others.
  EXPECT_LT(fit.laws[fit.chosen].kind_held_out.mean, 0.6);
  EXPECT_LT(fit.laws[fit.chosen].kind_held_out.worst, 3.0);
  EXPECT_GT(fit.machine.fitted_range.corner_rad[1], 0.5 * kPi);
}

TEST(FitStretches, LeavesWhatNoStretchTellsAsItWas) {
  const machine::Machine known = known_machine();
  StretchRun run{"figures", figures(), {}};
  run.timed = planned(run.program, known);
  std::erase_if(run.timed, [&](const TimedStretch& t) {
    return kind_of(t.stretch, run.program) == MotionKind::arcs;  // no circle was logged
  });
  machine::Machine start;
  start.control.arc_normal_fraction = 0.9;
  const StretchFit fit = fit_stretches({run}, start, {.laws = {stop_law()}});
  EXPECT_DOUBLE_EQ(fit.machine.control.arc_normal_fraction, 0.9);
  const auto p = std::ranges::find(fit.parameters, "control.arc_normal_share", &FitParameter::name);
  EXPECT_FALSE(p->written);
  EXPECT_EQ(p->note, "not determined by the stretches; start value kept (run what camber protocol writes)");
}

/// Corners are laws of speed: times at two feeds tell those at others (the slightest corners hardly slow the slow
/// ones).
TEST(FitStretchesSlow, CornersOfSlowFeedsPredictThoseOfFastOnes) {
  machine::Machine known = known_machine();
  known.control.corner = {.law = machine::CornerLaw::speed_difference, .speed_difference_mm_per_s = 6};
  const auto at_feeds = [](std::initializer_list<double> feeds) {
    tests::TestProgram p;
    int tool = 0;
    for (const double feed : feeds)
      for (const double turn : {0.15, 0.35, 0.8, 1.3, 2.0}) {
        p.new_state().tool = ++tool;
        p.rapid(0, 0, 0);
        Vec3 at = Vec3::Zero();
        for (int i = 0; i < 40; ++i) {
          at += (2 + turn) * Vec3(std::cos(i * turn), std::sin(i * turn), 0);
          p.line(at.x(), at.y(), 0, feed);
        }
      }
    p.rapid(0, 0, 10);
    return p.program;
  };
  StretchRun slow{"slow", at_feeds({800.0, 1500.0}), {}};
  slow.timed = planned(slow.program, known);
  const StretchFit fit = fit_stretches({slow}, {}, {});
  const nc::Interpretation fast = at_feeds({4000.0, 8000.0});
  const auto is = planned(fast, fit.machine), was = planned(fast, known);
  for (std::size_t i = 0; i < was.size(); ++i)
    EXPECT_NEAR(is[i].time_s / was[i].time_s, 1, kExtrapolation) << i << " under " << fit.laws[fit.chosen].law.name;
}

/// Times of facets tell the block time; it and the accelerations predict what no stretch held: helices in short blocks
/// and circles that are slower than any of them.
TEST(FitStretchesSlow, BlockTimeAndAccelerationPredictHelicesAndSlowCircles) {
  machine::Machine known = known_machine();
  known.control.corner.stop_angle_rad = machine::kNoLimit;
  known.control.block_time_s = 0.009;
  StretchRun run{"figures", {}, {}};
  tests::TestProgram p;
  int tool = 0;
  const auto zigzag = [&](double length, double turn, int count, double feed) {
    Vec3 at = Vec3::Zero();
    p.rapid(0, 0, 0);
    for (int i = 0; i < count; ++i) {
      at += length * Vec3(std::cos(turn * i), std::sin(turn * i), 0);
      p.line(at.x(), at.y(), 0, feed);
    }
  };
  for (const double feed : {1000.0, 2500.0, 4500.0}) {
    p.new_state().tool = ++tool;
    for (const double turn : {0.05, 0.3, 0.9}) zigzag(3, turn, 30, feed);
    for (const double length : {0.1, 0.2, 0.5}) zigzag(length, 0.01, 120, feed);
    for (const double r : {1.0, 3.0}) {
      p.rapid(r, 0, 5).rapid(r, 0, 0);
      for (int i = 0; i < 9; ++i) p.arc_xy(r, 0, 0, 0, 2 * kPi, feed);
    }
  }
  p.rapid(0, 0, 10);
  run.program = p.program;
  run.timed = planned(run.program, known);
  const StretchFit fit = fit_stretches({run}, {}, {});
  EXPECT_NEAR(fit.machine.control.block_time_s, 0.009, 0.0003) << fit.laws[fit.chosen].law.name;
  tests::TestProgram other;
  other.rapid(2, 0, 0);
  for (int i = 0; i < 360; ++i) {  // a helix in blocks of 0.2 mm
    other.arc_xy(2 * std::cos((i + 1) * 0.1), 2 * std::sin((i + 1) * 0.1), 0, 0, 0.1, 3000);
    nc::Move& move = other.program.moves.back();
    other.program.arcs.back().center_mm.z() = move.start_mm.z() = -0.005 * i;
    move.end_mm.z() = -0.005 * (i + 1);
  }
  other.rapid(0.4, 0, 0);
  for (int i = 0; i < 12; ++i) other.arc_xy(0.4, 0, 0, 0, 2 * kPi, 3000);
  other.rapid(0, 0, 10);
  const auto is = planned(other.program, fit.machine), was = planned(other.program, known);
  ASSERT_EQ(was.size(), 2u);
  EXPECT_GT(was[0].time_s, 2 * programmed_time_s(was[0].stretch, other.program));  // by the block time
  EXPECT_GT(was[1].time_s, 1.5 * programmed_time_s(was[1].stretch, other.program));
  for (std::size_t i = 0; i < was.size(); ++i) EXPECT_NEAR(is[i].time_s / was[i].time_s, 1, kExtrapolation) << i;
}

TEST(FitStretches, SaysThatTooFewTimesTellNothing) {
  StretchRun run{"figures", figures(), {}};
  run.timed = planned(run.program, known_machine());
  run.timed.resize(3);
  const StretchFit fit = fit_stretches({run}, {}, {.laws = {stop_law()}});
  EXPECT_FALSE(fit.converged);
  EXPECT_EQ(fit.message, "3 geometries are too few for 5 numbers; nothing was fitted");
}

TEST(StretchErrors, MeanPercentileWorstAndTotal) {
  const StretchErrors e = stretch_errors({10, 10, 20}, {10.1, 9.8, 20});
  EXPECT_NEAR(e.mean, 1.0, 1e-9);
  EXPECT_NEAR(e.p90, 2.0, 1e-9);
  EXPECT_NEAR(e.worst, 2.0, 1e-9);
  EXPECT_NEAR(e.total, -0.25, 1e-9);
}

}  // namespace
}  // namespace camber::calib
