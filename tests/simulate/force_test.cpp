// Mean forces and torque of flat end mills against the closed forms of Altintas, Manufacturing Automation, 2nd ed.,
// ch. 2, with force laws that are written out here.
#include <cmath>

#include <gtest/gtest.h>

#include "simulate/cut.h"
#include "tests/support/accuracy_figure.h"
#include "tests/support/cutting.h"

namespace camber::simulate {
namespace {

using testing::add_row;
using testing::make_box;
using testing::make_tool;

constexpr double kRadius = 5;
constexpr machine::Material kSteel{2000, 700, 300, 15, 12, 5};

machine::Material kienzle_steel() {
  machine::Material m;
  m.law = machine::ForceLaw::kienzle;
  m.kc1_1_MPa = 1500, m.mc = 0.25, m.kr1_1_MPa = 500, m.mr = 0.35, m.ka1_1_MPa = 200, m.ma = 0.2;
  return m;
}

/// Forces of the edge, N per mm of its width: tangential, radial, axial. h: chip thickness, mm.
Vec3 steel_N_per_mm(double h) { return {2000 * h + 15, 700 * h + 12, 300 * h + 5}; }
Vec3 kienzle_N_per_mm(double h) { return {1500 * std::pow(h, 0.75), 500 * std::pow(h, 0.65), 200 * std::pow(h, 0.8)}; }

struct Means {
  double x, y, z, torque_Nmm;
};

/// Feed along +X, cutter centre at y = 0, material at angles from `entry` to `exit` (radians from +Y towards +X,
/// the direction in which an edge turns under M3). Integrals over one turn of N teeth; forces on the tool.
template <class Law>
Means closed_form(Law law, int flutes, double depth, double feed, double entry, double exit) {
  // Edge at phi from +Y clockwise: motion t = (cos, -sin), outward normal n = (sin, cos), h = feed * n.x = feed sin.
  constexpr int kSteps = 20000;
  Vec3 sum = Vec3::Zero();
  double torque = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double p = entry + (i + 0.5) * (exit - entry) / kSteps, s = std::sin(p), c = std::cos(p);
    const Vec3 edge = law(feed * s);
    sum -= Vec3(edge.x() * c + edge.y() * s, -edge.x() * s + edge.y() * c, edge.z());
    torque += edge.x() * kRadius;
  }
  const double each = (exit - entry) / kSteps * flutes * depth / (2 * kPi);
  return {each * sum.x(), each * sum.y(), each * sum.z(), each * torque};
}

Means simulated(const machine::Tool& tool, double y_min, double y_max, double depth, double feed,
                const machine::Material& material = kSteel) {
  auto stock = make_box({0, y_min, -4}, {30, y_max, 0}, 0.1);
  std::vector<removal::Stamp> stamps;
  add_row(stamps, {-8, 0, -depth}, {18, 0, -depth}, feed);
  CutOptions options;
  options.coupling = machine::Coupling::rigid;
  const CutResult r = cut(stock, tool, material, stamps, {}, 0, options);
  Vec3 mean = Vec3::Zero();
  double torque = 0;
  int n = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k)
    if (stamps[k].pose.tip_mm.x() > 10 && stamps[k].pose.tip_mm.x() < 16) {
      mean += r.loads[k].force_mean_N;
      torque += r.loads[k].torque_mean_Nmm;
      ++n;
    }
  mean /= n;
  return {mean.x(), mean.y(), mean.z(), torque / n};
}

void expect_within_one_percent(const Means& got, const Means& want) {
  const double scale = std::hypot(want.x, want.y);
  tests::expect_figure("mean force x", got.x, want.x, 0.01, scale);
  tests::expect_figure("mean force y", got.y, want.y, 0.01, scale);
  tests::expect_figure("mean force z", got.z, want.z, 0.01);
  tests::expect_figure("mean torque", got.torque_Nmm, want.torque_Nmm, 0.01);
}

TEST(FlatEndMill, SlotForcesMatchTheClosedForm) {
  const auto tool = make_tool(machine::ToolType::flat, 2 * kRadius, 2, 30);
  expect_within_one_percent(simulated(tool, -9, 9, 2, 0.05), closed_form(steel_N_per_mm, 2, 2, 0.05, 0, kPi));
}

TEST(FlatEndMill, SlotForcesByKienzlesLawMatchTheIntegral) {
  const auto tool = make_tool(machine::ToolType::flat, 2 * kRadius, 2, 30);
  expect_within_one_percent(simulated(tool, -9, 9, 2, 0.05, kienzle_steel()),
                            closed_form(kienzle_N_per_mm, 2, 2, 0.05, 0, kPi));
}

TEST(FlatEndMill, UpMillingShoulderForcesMatchTheClosedForm) {
  // Material where an edge enters at +Y: radial depth 2 of R5.
  const auto tool = make_tool(machine::ToolType::flat, 2 * kRadius, 4, 30);
  const double entry = 0, exit = std::acos(1 - 2.0 / 5.0);
  expect_within_one_percent(simulated(tool, 3, 12, 2, 0.05), closed_form(steel_N_per_mm, 4, 2, 0.05, entry, exit));
}

TEST(FlatEndMill, DownMillingShoulderForcesMatchTheClosedForm) {
  const auto tool = make_tool(machine::ToolType::flat, 2 * kRadius, 4, 30);
  const double entry = kPi - std::acos(1 - 2.0 / 5.0);
  expect_within_one_percent(simulated(tool, -12, -3, 2, 0.05), closed_form(steel_N_per_mm, 4, 2, 0.05, entry, kPi));
}

TEST(FlatEndMill, MeanForcesDoNotDependOnTheHelix) {
  const Means straight = simulated(make_tool(machine::ToolType::flat, 2 * kRadius, 2, 0), -9, 9, 2, 0.05);
  const Means helical = simulated(make_tool(machine::ToolType::flat, 2 * kRadius, 2, 45), -9, 9, 2, 0.05);
  EXPECT_NEAR(straight.x, helical.x, 0.002 * std::abs(straight.x));
  EXPECT_NEAR(straight.y, helical.y, 0.002 * std::abs(straight.y));
}

}  // namespace
}  // namespace camber::simulate
