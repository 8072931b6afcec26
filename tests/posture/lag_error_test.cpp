// What axes that follow late leave on the surface, against closed forms and against the machine moved back by its lag.
#include "posture/choose.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/units.h"
#include "posture/path_cost.h"
#include "test_paths.h"

namespace camber::posture {
namespace {

constexpr double kLength = 140, kBall = 3;

machine::Machine late_machine() {
  Diagnostics diagnostics;
  return machine::read_machine(CAMBER_SOURCE_DIR "/samples/machines/linuxcnc_five_axis.toml", diagnostics);
}

PathPoint on_part(const Vec3& centre, const Vec3& normal, double time_s) {
  PathPoint p;
  p.centre_mm = centre;
  p.normal = normal.normalized();
  p.corner_mm = kBall;
  p.contact = true;
  p.time_s = time_s;
  p.way_mm = 1;
  return p;
}

/// Down a slope at v: x is behind by v cos / Kx, z by v sin / Kz.
TEST(LagError, OfThreeAxesOnASlopeIsTheClosedForm) {
  const machine::Machine machine = late_machine();
  const LagError lag(machine, {10, 20, 30}, kLength, kBall);
  ASSERT_TRUE(lag.any());
  const double slope = rad_from_deg(60), v = 25, dt = 0.04;
  const Vec3 along(std::cos(slope), 0, -std::sin(slope)), normal(std::sin(slope), 0, std::cos(slope));
  std::vector<PathPoint> points;
  for (int i = 0; i < 5; ++i) points.push_back(on_part(v * dt * i * along, normal, dt));
  const double expected = v * std::sin(slope) * std::cos(slope) *
                          (1 / machine.axis[0].position_gain_per_s - 1 / machine.axis[2].position_gain_per_s);
  const auto steps = axis_steps(points, std::vector<Vec3>(5, Vec3::UnitZ()), lag, machine);
  const auto errors = lag.along(points, Vec3::UnitZ(), Vec3::Zero());
  EXPECT_NEAR(std::abs(expected), 0.0516, 0.0001);
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_NEAR(steps[i].lag_error_mm, expected, 1e-6);
    EXPECT_NEAR(errors[i], expected, 1e-9);
  }
}

TEST(LagError, IsTheDisplacementOfTheMachineMovedBackByItsLag) {
  const machine::Machine machine = late_machine();
  const kinematics::Chain chain(machine);
  const Vec3 origin(5, -7, 11);
  const LagError lag(machine, origin, kLength, kBall);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> one(-1, 1);
  const auto any = [&] { return Vec3(one(random), one(random), one(random)); };
  for (int i = 0; i < 50; ++i) {
    const Vec3 normal = (Vec3::UnitZ() + 0.4 * any()).normalized();
    // Off the pole, near which the table turns far.
    const Vec3 axis_a = (Vec3(0.7, -0.4, 1) + 0.2 * any()).normalized();
    const Vec3 axis_b = (axis_a + 0.005 * any()).normalized();
    const Vec3 centre = 20 * any();
    const double dt = 0.05;
    const PathPoint a = on_part(centre, normal, dt), b = on_part(centre + 0.8 * any(), normal, dt);
    const auto first = chain.solve_tool_axis(axis_a, {}).joints;
    const auto place_a = lag.place(a, axis_a, first.rotary_rad);
    const auto place_b = lag.place(b, axis_b, chain.solve_tool_axis(axis_b, first).joints.rotary_rad);
    kinematics::Joints late = place_b.joints;
    for (Eigen::Index k = 0; k < 3; ++k) {
      const auto n = static_cast<std::size_t>(k);
      late.linear_mm[k] -=
          (place_b.joints.linear_mm[k] - place_a.joints.linear_mm[k]) / dt / machine.axis[n].position_gain_per_s;
      if (!std::isinf(machine.rotary[n].position_gain_per_s))
        late.rotary_rad[k] -=
            (place_b.joints.rotary_rad[k] - place_a.joints.rotary_rad[k]) / dt / machine.rotary[n].position_gain_per_s;
    }
    const Vec3 behind = chain.pose(late, kLength - kBall).tip_mm - (b.centre_mm - origin);
    const double error = LagError::error_mm(place_a, place_b, dt);
    EXPECT_NEAR(error, -normal.dot(behind), 0.03 * behind.norm() + 1e-4) << i;  // to first order
  }
}

TEST(LagError, IsNothingWhereAllAxesAreBehindByTheSameTime) {
  machine::Machine machine = late_machine();
  for (auto& axis : machine.axis) axis.position_gain_per_s = 40, axis.feed_forward_percent = 20;
  for (auto& axis : machine.rotary) axis.position_gain_per_s = 80, axis.exponential_1_s = 0.0075, axis.filter_s = 0;
  for (auto& axis : machine.axis) axis.filter_s = 0;
  EXPECT_FALSE(LagError(machine, Vec3::Zero(), kLength, kBall).any());  // 0.8 / 40 = 1 / 80 + 0.0075
}

}  // namespace
}  // namespace camber::posture
