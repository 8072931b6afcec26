// Joints against the traces of a real control with five axes (tests/data/linuxcnc5).
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "base/diagnostics.h"
#include "base/units.h"
#include "kinematics/chain.h"
#include "tests/kinematics/machines.h"
#include "tests/support/csv_columns.h"
#include "tests/support/test_data.h"

namespace camber::kinematics {
namespace {

using Columns = std::map<std::string, std::vector<double>>;
constexpr double kLengthMm = 80;  ///< of T1

Columns trace_of(const std::string& name) {
  return camber::tests::columns_of(
      SourceText::read(camber::tests::unpacked_data("linuxcnc5/" + name + "_t.csv")).text());
}

/// Largest distance between the joints of the trace and those that belong to the planner's tip and angles, over the
/// cycles under tool-centre-point control. The control's interpolator gives x[n] = (q[n-3] + 4 q[n-2] + q[n-1]) / 6.
struct Compared {
  std::size_t cycles = 0;
  double worst_mm = 0;
};

Compared compare(const Columns& t, const std::vector<double>& a_deg, const std::vector<double>& c_deg) {
  const Chain chain(tests::sample("table_ac_linuxcnc"));
  const std::size_t count = t.at("t_s").size();
  std::vector<Vec3> q(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 tip(t.at("x_world_mm")[i], t.at("y_world_mm")[i], t.at("z_world_mm")[i] - kLengthMm);
    q[i] = *chain.linear_mm(tip, {rad_from_deg(a_deg[i]), 0, rad_from_deg(c_deg[i])}, kLengthMm);
  }
  Compared out;
  const auto& tcp = t.at("tcp");
  for (std::size_t n = 6; n + 3 < count; ++n) {
    if (tcp[n - 6] != 1 || tcp[n + 3] != 1) continue;
    const Vec3 joints(t.at("x_cmd_mm")[n], t.at("y_cmd_mm")[n], t.at("z_cmd_mm")[n]);
    const Vec3 expected = (q[n - 3] + 4 * q[n - 2] + q[n - 1]) / 6;
    out.worst_mm = std::max(out.worst_mm, (joints - expected).lpNorm<Eigen::Infinity>());
    ++out.cycles;
  }
  testing::Test::RecordProperty("worst_nm", static_cast<int>(1e6 * out.worst_mm));
  return out;
}

TEST(LinuxCncTrace, JointsFollowFromThePosesOfThePlanner) {
  const Columns t = trace_of("tcp_singular_g64");
  ASSERT_FALSE(t.empty());
  const Compared c = compare(t, t.at("a_world_deg"), t.at("c_world_deg"));
  EXPECT_GT(c.cycles, 10000U);
  EXPECT_LE(c.worst_mm, 1e-5);
}

/// The planner's angle two cycles before: the interpolator is x + (second difference of x) / 6.
std::vector<double> before_interpolation(const std::vector<double>& joint) {
  std::vector<double> out(joint.size());
  std::vector<double> sharp = joint;
  for (int round = 0; round < 4; ++round)
    for (std::size_t i = 1; i + 1 < joint.size(); ++i)
      sharp[i] = joint[i] - (sharp[i - 1] - 2 * sharp[i] + sharp[i + 1]) / 6;
  for (std::size_t i = 0; i + 2 < joint.size(); ++i) out[i] = sharp[i + 2];
  return out;
}

class RoundedTrace : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, RoundedTrace,
                         testing::Values("tcp_fixed_g61", "tcp_fan_g64", "tcp_sphere_normal_g64", "tcp_dome_g64",
                                         "tcp_dome_g61"),
                         [](const auto& info) { return std::string(info.param); });

/// Positions have four decimals there, and so have the angles, of which the planner's must be reckoned back.
TEST_P(RoundedTrace, JointsFollowFromThePosesWithinTheRounding) {
  const Columns t = trace_of(GetParam());
  ASSERT_FALSE(t.empty());
  const Compared c = compare(t, before_interpolation(t.at("a_cmd_deg")), before_interpolation(t.at("c_cmd_deg")));
  EXPECT_GT(c.cycles, 1000U);
  // 0.5e-4 mm in joints and tip, 0.5e-4 degrees (thrice, for reckoning back) at up to 150 mm from the axes
  EXPECT_LE(c.worst_mm, 5e-4);
}

}  // namespace
}  // namespace camber::kinematics
