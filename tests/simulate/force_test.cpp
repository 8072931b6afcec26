// Mean forces of flat end mills against the closed forms of Altintas, Manufacturing Automation, 2nd ed., ch. 2.
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

constexpr machine::Material kSteel{2000, 700, 300, 15, 12, 5};

struct MeanForces {
  double x, y, z;
};

/// Feed along +X, cutter centre at y = 0, material at angles from `entry` to `exit` (radians from +Y towards +X,
/// the direction in which an edge turns under M3). Integrals over one turn of N teeth; forces on the tool.
MeanForces closed_form(const machine::Material& m, int flutes, double depth, double feed, double entry, double exit) {
  // Edge at phi from +Y clockwise: motion t = (cos, -sin), outward normal n = (sin, cos), h = feed * n.x = feed sin.
  const auto integral = [&](auto f) {
    constexpr int kSteps = 20000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) sum += f(entry + (i + 0.5) * (exit - entry) / kSteps);
    return sum * (exit - entry) / kSteps * flutes * depth / (2 * kPi);
  };
  const auto h = [&](double p) { return feed * std::sin(p); };
  return {
      -integral([&](double p) {
        return (m.ktc_MPa * h(p) + m.kte_N_per_mm) * std::cos(p) + (m.krc_MPa * h(p) + m.kre_N_per_mm) * std::sin(p);
      }),
      -integral([&](double p) {
        return -(m.ktc_MPa * h(p) + m.kte_N_per_mm) * std::sin(p) + (m.krc_MPa * h(p) + m.kre_N_per_mm) * std::cos(p);
      }),
      -integral([&](double p) { return m.kac_MPa * h(p) + m.kae_N_per_mm; })};
}

MeanForces simulated(const machine::Tool& tool, double y_min, double y_max, double depth, double feed) {
  auto stock = make_box({0, y_min, -4}, {30, y_max, 0}, 0.1);
  std::vector<removal::Stamp> stamps;
  add_row(stamps, {-8, 0, -depth}, {18, 0, -depth}, feed);
  CutOptions options;
  options.coupling = machine::Coupling::rigid;
  const CutResult r = cut(stock, tool, kSteel, stamps, {}, 0, options);
  Vec3 mean = Vec3::Zero();
  int n = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k)
    if (stamps[k].pose.tip_mm.x() > 10 && stamps[k].pose.tip_mm.x() < 16) {
      mean += r.loads[k].force_mean_N;
      ++n;
    }
  mean /= n;
  return {mean.x(), mean.y(), mean.z()};
}

void expect_within_one_percent(const MeanForces& got, const MeanForces& want) {
  const double scale = std::hypot(want.x, want.y);
  tests::expect_figure("mean force x", got.x, want.x, 0.01, scale);
  tests::expect_figure("mean force y", got.y, want.y, 0.01, scale);
  tests::expect_figure("mean force z", got.z, want.z, 0.01);
}

TEST(FlatEndMill, SlotForcesMatchTheClosedForm) {
  const auto tool = make_tool(machine::ToolType::flat, 10, 2, 30);
  expect_within_one_percent(simulated(tool, -9, 9, 2, 0.05), closed_form(kSteel, 2, 2, 0.05, 0, kPi));
}

TEST(FlatEndMill, UpMillingShoulderForcesMatchTheClosedForm) {
  // Material where an edge enters at +Y: radial depth 2 of R5.
  const auto tool = make_tool(machine::ToolType::flat, 10, 4, 30);
  const double entry = 0, exit = std::acos(1 - 2.0 / 5.0);
  expect_within_one_percent(simulated(tool, 3, 12, 2, 0.05), closed_form(kSteel, 4, 2, 0.05, entry, exit));
}

TEST(FlatEndMill, DownMillingShoulderForcesMatchTheClosedForm) {
  const auto tool = make_tool(machine::ToolType::flat, 10, 4, 30);
  const double entry = kPi - std::acos(1 - 2.0 / 5.0);
  expect_within_one_percent(simulated(tool, -12, -3, 2, 0.05), closed_form(kSteel, 4, 2, 0.05, entry, kPi));
}

TEST(FlatEndMill, MeanForcesDoNotDependOnTheHelix) {
  const MeanForces straight = simulated(make_tool(machine::ToolType::flat, 10, 2, 0), -9, 9, 2, 0.05);
  const MeanForces helical = simulated(make_tool(machine::ToolType::flat, 10, 2, 45), -9, 9, 2, 0.05);
  EXPECT_NEAR(straight.x, helical.x, 0.002 * std::abs(straight.x));
  EXPECT_NEAR(straight.y, helical.y, 0.002 * std::abs(straight.y));
}

}  // namespace
}  // namespace camber::simulate
