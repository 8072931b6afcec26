// Paths for pictures: what is left out, and what never.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "feedmodel/cycle_time.h"
#include "nc/interpreter.h"
#include "report/path_picture.h"
#include "report/planned_picture.h"

namespace camber::report {
namespace {

nc::Interpretation moves_of(const std::string& text) {
  Diagnostics diagnostics;
  const nc::Program program = nc::read_program(SourceText("p.nc", text), diagnostics);
  return nc::interpret(program, {}, diagnostics);
}

const std::string kHead = "G21 G90 G17\nG0 X0. Y0. Z0.\nG1 F500\n";

TEST(PathPicture, TellsRapidsLinesAndArcsAndWhatWasRewritten) {
  const auto moves = moves_of(kHead + "X10.\nG3 X20. Y10. I0. J10.\nG1 X0.\nG0 Z5.\nM30\n");
  const PathPicture p = path_picture(moves, {{3, 4}}, 1000);
  EXPECT_FALSE(p.thinned);
  ASSERT_GT(p.points.size(), 10u);
  EXPECT_EQ(p.kind.front(), PathKind::start);
  EXPECT_EQ(p.kind.back(), PathKind::rapid);
  EXPECT_EQ(p.kind[p.kind.size() - 2], PathKind::kept_line);
  EXPECT_EQ(p.kind[1], PathKind::line);
  EXPECT_EQ(std::count(p.ends.begin(), p.ends.end(), 1), 5);
  int arcs = 0;
  for (std::size_t k = 0; k < p.points.size(); ++k)
    if (p.kind[k] == PathKind::arc) {
      ++arcs;
      EXPECT_NEAR((p.points[k] - Vec3(10, 10, 0)).norm(), 10, 1e-9);
      EXPECT_EQ(p.block[k], 4u);
    }
  EXPECT_GT(arcs, 20);
}

TEST(PathPicture, ThinningKeepsCornersAndExtremes) {
  std::string text = kHead;
  for (int row = 0; row < 25; ++row)
    for (int i = 0; i <= 400; ++i) {
      const int k = row % 2 ? 400 - i : i;
      // A peak of one point in one row; everything else is straight.
      text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", 0.25 * k, 1.0 * row, row == 12 && k == 137 ? 3.0 : 0.0);
    }
  const auto moves = moves_of(text + "M30\n");
  const PathPicture p = path_picture(moves, {}, 1250);
  EXPECT_TRUE(p.thinned);
  EXPECT_LE(p.points.size(), 1250u);
  const auto has = [&](const Vec3& place) {
    return std::any_of(p.points.begin(), p.points.end(),
                       [&](const Vec3& q) { return (p.chord_mm + 1e-9) > (q - place).norm(); });
  };
  EXPECT_TRUE(has(Vec3(0.25 * 137, 12, 3)));
  for (int row = 0; row < 25; ++row) {
    EXPECT_TRUE(has(Vec3(0, row, 0)));
    EXPECT_TRUE(has(Vec3(100, row, 0)));
  }
  // No point of the path is farther from the picture than it says.
  for (const nc::Move& m : moves.moves) {
    double nearest = 1e9;
    for (std::size_t k = 1; k < p.points.size(); ++k) {
      const Vec3 ab = p.points[k] - p.points[k - 1];
      const double t = std::clamp((m.end_mm - p.points[k - 1]).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (m.end_mm - p.points[k - 1] - t * ab).norm());
    }
    ASSERT_LE(nearest, p.chord_mm + 1e-9);
  }
}

TEST(PathPicture, OfAProgramTellsFeedsAndTools) {
  const auto moves = moves_of("G21 G90 G17\nT1 M6\nG0 X0. Y0. Z0.\nG1 X10. F500\nG0 Z9.\nT2 M6\nG1 Z0. F700\nM30\n");
  const PathPicture p = program_picture(moves, 1000);
  ASSERT_EQ(p.points.size(), p.tool.size());
  ASSERT_EQ(p.points.size(), p.feed_mm_per_min.size());
  EXPECT_TRUE(p.speed_mm_per_min.empty());
  for (std::size_t k = 1; k < p.points.size(); ++k) {
    const bool rapid = p.kind[k] == PathKind::rapid;
    EXPECT_EQ(std::isnan(p.feed_mm_per_min[k]), rapid) << k;
    if (!rapid) {
      EXPECT_NEAR(p.feed_mm_per_min[k], p.block[k] == 3 ? 500 : 700, 1e-3);
    }
    EXPECT_EQ(p.tool[k], p.block[k] < 5 ? 1u : 2u) << k;
  }
  EXPECT_TRUE(path_picture(moves, {}, 1000).feed_mm_per_min.empty());
}

TEST(PathPicture, ThinningKeepsChangesOfFeedOnAStraightLine) {
  std::string text = kHead;
  for (int i = 1; i <= 4000; ++i) text += fmt::format("X{:.3f} F{}\n", 0.01 * i, i >= 1700 && i < 1720 ? 200 : 1000);
  const PathPicture p = program_picture(moves_of(text + "M30\n"), 500);
  EXPECT_TRUE(p.thinned);
  EXPECT_LE(p.points.size(), 500u);
  double slow_mm = 0;
  for (std::size_t k = 1; k < p.points.size(); ++k) {
    EXPECT_LE(p.points[k].norm(), 40 + 1e-9);
    if (p.feed_mm_per_min[k] < 300) slow_mm += (p.points[k] - p.points[k - 1]).norm();
  }
  EXPECT_NEAR(slow_mm, 0.2, 1e-9);
}

machine::Machine machine_with(machine::AccelerationLaw law) {
  machine::Machine m;
  for (machine::Axis& axis : m.axis) {
    axis.max_velocity_mm_per_s = 500;
    axis.acceleration_mm_per_s2 = 800;
  }
  m.control.in_position_mm = std::numeric_limits<double>::infinity();
  m.control.period_s = 1e-6;  // no waiting for the next one
  m.control.corner.law = machine::CornerLaw::speed_difference;
  m.control.corner.speed_difference_mm_per_s = 20;
  m.cycle.acceleration_law = law;
  m.cycle.time_constant_1_s = 0.02;
  m.cycle.time_constant_2_s = 0.03;
  m.cycle.jerk_filter_s = 0.01;
  return m;
}

/// Length / speed over all that is cut.
double time_in_picture_s(const PathPicture& p, double radius_mm) {
  double time_s = 0;
  for (std::size_t k = 1; k < p.points.size(); ++k) {
    if (std::isnan(p.speed_mm_per_min[k])) continue;
    double way = (p.points[k] - p.points[k - 1]).norm();
    if (p.kind[k] == PathKind::arc) way = 2 * radius_mm * std::asin(way / 2 / radius_mm);
    time_s += way / p.speed_mm_per_min[k] * 60;
  }
  return time_s;
}

TEST(PathPicture, SpeedsOfThePlanTakeTheCuttingTimeThatCamberTimeReports) {
  const auto moves =
      moves_of(kHead + "X100. F12000\nY30. F6000\nG3 X80. Y50. I-20. J0.\nG1 X0.\nG0 Z20.\nG0 X70. Y90. Z40.\nM30\n");
  for (const auto law : {machine::AccelerationLaw::linear, machine::AccelerationLaw::exponential}) {
    const machine::Machine machine = machine_with(law);
    const PathPicture p = planned_picture(moves, machine, 100000);
    const double cutting_s = feedmodel::cycle_time(moves, machine).all.time.cutting_s;
    EXPECT_GT(cutting_s, 1.5);
    EXPECT_NEAR(time_in_picture_s(p, 20), cutting_s, 0.002 * cutting_s);
    for (std::size_t k = 1; k < p.points.size(); ++k)
      if (law == machine::AccelerationLaw::linear && p.kind[k] > PathKind::rapid) {
        EXPECT_LE(p.speed_mm_per_min[k], 1.0001 * p.feed_mm_per_min[k]) << k;
      }
  }
}

TEST(PathPicture, DrawsRapidsAsTheAxesGo) {
  const auto moves = moves_of(kHead + "G0 X100. Y20.\nM30\n");
  machine::Machine machine = machine_with(machine::AccelerationLaw::linear);
  machine.cycle.rapid_path = machine::RapidPath::dogleg;
  const PathPicture bent = planned_picture(moves, machine, 1000);
  // From rest with 800 mm/s2 each; Y brakes from 10 mm on, and y - x/5 is greatest where its speed is a fifth of X's:
  // t = 2/1.2 sqrt(20/800) s, 18.889 - 27.778/5 mm.
  double farthest = 0;
  for (const Vec3& p : bent.points) farthest = std::max(farthest, p.y() - 0.2 * p.x());
  EXPECT_NEAR(farthest, 40.0 / 3, 0.02);
  machine.cycle.rapid_path = machine::RapidPath::linear;
  for (const Vec3& p : planned_picture(moves, machine, 1000).points) EXPECT_NEAR(p.y(), 0.2 * p.x(), 1e-9);
}

TEST(PathPicture, OfManyBlocksKeepsTheCuttingTimeAndNoSpeedBeyondTheFeed) {
  std::string text = kHead;
  for (int i = 0; i < 20000; ++i)
    text += fmt::format("X{} Y{:.3f} Z{}\n", 0.1 * (i % 500), i / 500 * 0.5, i % 3 * 0.01);
  const auto moves = moves_of(text + "M30\n");
  const machine::Machine machine = machine_with(machine::AccelerationLaw::linear);
  const PathPicture all = planned_picture(moves, machine, 1000000), few = planned_picture(moves, machine, 2000);
  EXPECT_LE(few.points.size(), 2000u);
  EXPECT_FALSE(all.thinned);
  const double cutting_s = feedmodel::cycle_time(moves, machine).all.time.cutting_s;
  EXPECT_NEAR(time_in_picture_s(all, 1), cutting_s, 1e-3 * cutting_s);
  for (const PathPicture* p : {&all, &few})
    for (const float speed : p->speed_mm_per_min) EXPECT_FALSE(speed > 501);
}

}  // namespace
}  // namespace camber::report
