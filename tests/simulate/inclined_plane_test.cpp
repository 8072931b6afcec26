// Ball finishing of a plane at 45 degrees, against two independent calculations (a ray-traced tooth-by-tooth
// simulation and the exact geometry): force, deflection and form error in the steady middle of a row.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "removal/form_error.h"
#include "simulate/cut.h"
#include "tests/support/accuracy_figure.h"
#include "tests/support/cutting.h"

namespace camber::simulate {
namespace {

using testing::add_row;
using tests::expect_figure;

constexpr double kFeed = 0.15, kRows = 0.3, kRadius = 3, kAllowance = 0.2;
constexpr double kLength = 8;
constexpr double kTolerance = 0.02;  // of each figure

/// Rows along X in -X, climbing the plane z = y.
std::vector<removal::Stamp> rows(double width) {
  std::vector<removal::Stamp> stamps;
  const double c = std::sqrt(0.5);
  for (double s = -2.4; s < 1.42 * width + 2.1; s += kRows) {
    const Vec3 centre(0, s * c - kRadius * c, s * c + kRadius * c);
    const Vec3 tip = centre - Vec3(0, 0, kRadius);
    add_row(stamps, tip + Vec3(kLength + 3, 0, 0), tip - Vec3(3, 0, 0), kFeed);
  }
  return stamps;
}

struct Result {
  double lateral_max_N, error_p5_um, error_median_um, error_p95_um, removed_fraction;
  Vec3 force_mean_N;
  Vec2 deflection_um;
};

/// The patch reaches from y = 0 to `width`; the error is read between the rows that lie between y_from and y_to.
Result simulate(machine::Coupling coupling, double width, double y_from, double y_to) {
  constexpr double voxel = 0.1;
  const auto tool = testing::make_tool(machine::ToolType::ball, 6, 2, 30);
  const machine::Material material{2000, 700, 0, 15, 15, 0};
  const auto stamps = rows(width);
  auto stock = testing::make_box({0, 0, -1.5}, {kLength, width, width + 1}, voxel);
  sweep(stock, tool, stamps, 0, kAllowance);
  stock.clear_stamps();
  removal::Stock target(stock);
  sweep(target, tool, stamps, 0, 0);
  CutOptions options;
  options.coupling = coupling;
  options.envelope_step_mm = 0.06;
  const auto contacts = find_contacts(target, tool, stamps);
  removal::CutterPlaces places;
  places.add(0, removal::shape_of(tool), stamps);
  removal::SurfaceMap map(target, places, stock);
  options.surface = &map;
  const CutResult cut_result = cut(stock, tool, material, stamps, contacts, 0, options);
  EXPECT_EQ(cut_result.unsettled, 0u);

  Result r{};
  r.removed_fraction = cut_result.chip_mm3 / cut_result.stock_mm3;
  double n = 0;
  for (std::size_t k = 0; k + 1 < stamps.size(); ++k) {
    const Vec3& tip = stamps[k].pose.tip_mm;
    if (tip.x() < 3 || tip.x() > 5 || tip.y() < y_from - 2.1 || tip.y() > y_to - 2.1) continue;
    r.lateral_max_N += std::max(cut_result.loads[k].lateral_max_N, cut_result.loads[k + 1].lateral_max_N);
    r.force_mean_N += cut_result.loads[k].force_mean_N;
    r.deflection_um += 1000 * cut_result.loads[k].contact_deflection_mm.head<2>();
    ++n;
  }
  r.lateral_max_N /= n;
  r.force_mean_N /= n;
  r.deflection_um /= n;
  std::vector<double> error;
  for (const auto& p : map.take())
    if (p.place_mm.x() > 3 && p.place_mm.x() < 5 && p.place_mm.y() > y_from && p.place_mm.y() < y_to)
      error.push_back(1000 * p.error_mm);
  std::sort(error.begin(), error.end());
  const auto at = [&](double fraction) {
    return error[static_cast<std::size_t>(fraction * static_cast<double>(error.size() - 1))];
  };
  r.error_p5_um = at(0.05);
  r.error_median_um = at(0.5);
  r.error_p95_um = at(0.95);
  return r;
}

TEST(InclinedPlane, RigidCouplingMatchesTheIndependentCalculations) {
  const Result r = simulate(machine::Coupling::rigid, 7, 2.5, 4);
  expect_figure("peak force", r.lateral_max_N, 62.3, kTolerance);
  expect_figure("mean force x", r.force_mean_N.x(), -3.48, kTolerance);
  expect_figure("mean force y", r.force_mean_N.y(), -2.24, kTolerance);
  expect_figure("mean force z", r.force_mean_N.z(), 1.25, kTolerance);
  expect_figure("deflection x", r.deflection_um.x(), -53.8, kTolerance);
  expect_figure("deflection y", r.deflection_um.y(), -32.1, kTolerance);
  expect_figure("deflection across the plane", -r.deflection_um.y() * std::sqrt(0.5), 22.7, kTolerance);
  expect_figure("form error, median", r.error_median_um, 16.6, kTolerance);
  expect_figure("form error, 5th percentile", r.error_p5_um, 15.1, kTolerance);
  expect_figure("form error, 95th percentile", r.error_p95_um, 17.9, kTolerance);
  expect_figure("chips against stock", r.removed_fraction, 1, 0.01);
}

TEST(InclinedPlane, StaticCouplingKeepsTheVolumeBalance) {
  // The bent cutter's chips are as large as what the stock loses: the tilt of the bent envelope is not forgotten.
  const Result r = simulate(machine::Coupling::static_, 3, 1, 2);
  // Two percent: the entry of each row, where the deflection jumps, is not as well balanced as the steady middle.
  expect_figure("chips against stock", r.removed_fraction, 1, 0.02);
  EXPECT_GT(r.error_median_um, 10);
  EXPECT_LT(r.error_median_um, 30);
}

}  // namespace
}  // namespace camber::simulate
