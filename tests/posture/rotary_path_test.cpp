#include "posture/rotary_path.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "base/diagnostics.h"
#include "base/units.h"
#include "machine/machine_model.h"
#include "posture/choose.h"
#include "test_paths.h"

namespace camber::posture {
namespace {

/// B of the table from -35 to 110 degrees, C without end.
machine::Machine tilting_table() {
  Diagnostics diagnostics;
  return machine::read_machine(CAMBER_SOURCE_DIR "/samples/kinematics/table_bc.toml", diagnostics);
}

Vec3 leaning(double deg) { return {std::sin(rad_from_deg(deg)), 0, std::cos(rad_from_deg(deg))}; }

/// A row on the part, a millimetre and a degree apart, behind a rapid far above.
struct Row {
  std::vector<PathPoint> points;
  std::vector<Vec3> axes;

  Row(double from_deg, double to_deg) {
    const int count = static_cast<int>(std::abs(to_deg - from_deg));
    for (int i = 0; i <= count + 1; ++i) {
      PathPoint p;
      p.corner_mm = 3;
      p.rapid = i == 0;
      p.contact = i > 0;
      p.centre_mm = Vec3(i, 0, i == 0 ? 50 : 3);
      p.way_mm = 1;
      points.push_back(p);
      axes.push_back(leaning(from_deg + (to_deg - from_deg) * std::max(0, i - 1) / count));
    }
  }
};

/// Each axis from where it is to the nearest solution: what leads to the end of the travel.
std::vector<Vec3> nearest_path(const machine::Machine& machine, const std::vector<Vec3>& axes) {
  const kinematics::Chain chain(machine);
  kinematics::Joints now;
  std::vector<Vec3> out;
  for (const Vec3& axis : axes) {
    now.rotary_rad = chain.solve_tool_axis(axis, now).joints.rotary_rad;
    out.push_back(now.rotary_rad);
  }
  return out;
}

double greatest_swing_deg(const machine::Machine& machine, const Row& row, const std::vector<Vec3>& rotary_rad) {
  const kinematics::Chain chain(machine);
  double out = 0;
  for (std::size_t i = 2; i < row.points.size(); ++i)
    out = std::max(out,
                   deg_from_rad(swing_rad(chain, {rotary_rad[i - 1], row.axes[i - 1]}, {rotary_rad[i], row.axes[i]})));
  return out;
}

TEST(RotaryPath, KeepsOneSolutionWhereTheNearestOneComesToTheEndOfItsTravel) {
  const machine::Machine machine = tilting_table();
  const kinematics::Chain chain(machine);
  double greatest = 0;
  for (const double side : {-1.0, 1.0}) {
    const Row row(10 * side, 50 * side);
    const std::vector<Vec3> ours = rotary_path(machine, row.points, row.axes);
    greatest = std::max(greatest, greatest_swing_deg(machine, row, nearest_path(machine, row.axes)));
    EXPECT_LT(greatest_swing_deg(machine, row, ours), 1e-6) << side;
    for (std::size_t i = 0; i < row.axes.size(); ++i) {
      kinematics::Joints joints;
      joints.rotary_rad = ours[i];
      EXPECT_LT((chain.pose(joints, 0).axis - row.axes[i]).norm(), 1e-9);
      EXPECT_EQ(chain.outside_travel(joints), 0);
    }
  }
  EXPECT_GT(greatest, 30);  // through the pole and back, within a millimetre
}

TEST(RotaryPath, WhatSwingsBetweenPointsIsReported) {
  const machine::Machine machine = tilting_table();
  const Surroundings nothing = [] {
    Surroundings around;
    around.add_box({500, 500, 0}, {510, 510, 10});
    around.finish();
    return around;
  }();
  ToolShape tool;
  std::vector<std::size_t> reported;
  for (const double side : {-1.0, 1.0}) {
    const Row row(10 * side, 50 * side);
    const auto unclear = [&](const std::vector<Vec3>& rotary_rad) {
      return unclear_points(row.points, row.axes, rotary_rad, nothing, tool, machine);
    };
    EXPECT_TRUE(unclear(rotary_path(machine, row.points, row.axes)).empty()) << side;
    for (const std::size_t i : unclear(nearest_path(machine, row.axes))) reported.push_back(i);
  }
  EXPECT_EQ(reported, std::vector<std::size_t>{27});  // from 35 to 36 degrees
}

TEST(RotaryPath, ObstaclesBetweenTwoPointsAreMetWhereTheAxesTurn) {
  const machine::Machine machine = tilting_table();
  machine::Tool ball;
  ball.type = machine::ToolType::ball;
  ball.diameter_mm = 6;
  ball.overhang_mm = 60;
  ball.flute_length_mm = 10;
  ball.shank_diameter_mm = 6;
  const ToolShape tool = tool_shape(ball, machine, 1);
  // In the air, so that no contact is lost; from B-35 to B35 with half a turn of C the tool stays at 35 degrees at both
  // ends, and goes upright between them, where a post stands.
  std::vector<PathPoint> points(2);
  const std::vector<Vec3> axes(2, leaning(-35));
  const auto unclear = [&](double to_b, double to_c, double post_x) {
    Surroundings around;
    around.add_box({post_x, -5, 30}, {post_x + 4, 5, 50});
    around.finish();
    const std::vector<Vec3> rotary_rad{Vec3(0, rad_from_deg(-35), 0), Vec3(0, rad_from_deg(to_b), rad_from_deg(to_c))};
    return unclear_points(points, axes, rotary_rad, around, tool, machine).size();
  };
  EXPECT_EQ(unclear(-35, 0, -2), 0U);
  EXPECT_EQ(unclear(35, 180, -2), 1U);
  EXPECT_EQ(unclear(35, 180, 40), 0U);
}

TEST(RotaryPath, ChosenDirectionsKeepToOneSolutionWithinACut) {
  machine::Machine machine = tilting_table();
  machine.rotary[2].travel_rad = {-kPi / 2, kPi / 2};
  // Along a cone whose normals lean by 30 degrees, from 40 to 140 degrees about Z: at 90 degrees C comes to its end.
  std::vector<PathPoint> points(1);
  points[0].rapid = true;
  points[0].centre_mm = Vec3(20, 40, 50);
  std::vector<Vec3> normals{Vec3::UnitZ()};
  for (int deg = 40; deg <= 140; ++deg) {
    PathPoint p;
    const double turn = rad_from_deg(deg), lean = rad_from_deg(30);
    p.normal = Vec3(std::sin(lean) * std::cos(turn), std::sin(lean) * std::sin(turn), std::cos(lean));
    p.centre_mm = Vec3(40 * std::cos(turn), 40 * std::sin(turn), 3);
    p.corner_mm = 3;
    p.contact = true;
    p.way_mm = 0.7;
    p.time_s = 10;
    points.push_back(p);
    normals.push_back(p.normal);
  }
  Surroundings around;
  around.add_box({500, 500, 0}, {510, 510, 10});
  around.finish();
  const std::vector<ToolShape> tools(1);
  const LagError lag(machine, Vec3::Zero(), 120, 3);
  const auto unclear = [&](const std::vector<Vec3>& axes) {
    return unclear_points(points, axes, rotary_path(machine, points, axes), around, tools[0], machine).size();
  };
  EXPECT_GT(unclear(normals), 0U);
  PostureOptions options;
  options.degree_cost_mm = 0;  // it would go over the pole; the surface alone is to decide
  const Postures chosen = choose_postures(points, around, tools, machine, lag, options).at(0);
  ASSERT_FALSE(chosen.blocked);
  EXPECT_EQ(unclear(chosen.axes), 0U);
}

}  // namespace
}  // namespace camber::posture
