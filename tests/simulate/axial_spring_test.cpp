// A tool that yields along its axis, against closed forms: static coupling in a plunge, rigid coupling in a slot.
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "simulate/cut.h"
#include "tests/support/accuracy_figure.h"
#include "tests/support/cutting.h"

namespace camber::simulate {
namespace {

using testing::add_row;
using testing::make_box;
using testing::make_tool;

constexpr double kInf = std::numeric_limits<double>::infinity();

/// Of a flat end mill, stiff across its axis; along it a spring.
machine::Tool sprung(double diameter, int flutes, double stiffness_N_per_mm) {
  auto tool = make_tool(machine::ToolType::flat, diameter, flutes, 0);
  tool.youngs_modulus_MPa = 1e12;
  tool.root_axial_stiffness_N_per_mm = stiffness_N_per_mm;
  return tool;
}

/// Straight down, the bottom's edges take the feed and push the tool up by F = 2 R krc h. Each tooth passing finds what
/// the one before has left: with g = 2 R krc / k, delta_n = g h_n and h_n = f + delta_(n-1) - delta_n, so
/// delta_n = g (f + delta_(n-1)) / (1 + g), from 0 to g f.
TEST(AxialSpring, APlungeFollowsItsRecurrence) {
  constexpr double kRadius = 3, kFeed = 0.04, kKrc = 700, kSpring = 6000;
  const machine::Material material{0, kKrc, 0, 0, 0, 0};
  const double g = 2 * kRadius * kKrc / kSpring;
  tests::LargestFigure deflection("axial deflection", 0.02), force("axial force", 0.02);
  for (const double voxel : {0.1, 0.15}) {
    std::vector<removal::Stamp> stamps;
    // The first tooth passing that cuts takes a whole feed.
    add_row(stamps, {0.02, 0.01, 3 * kFeed}, {0.02, 0.01, -0.6}, kFeed);
    removal::Stock stock = make_box({-4, -4, -2}, {4, 4, 0}, voxel);
    CutOptions options;
    options.settle_um = 0.01;
    options.settle_fraction = 0.001;
    const std::vector<Contact> contacts(stamps.size(), Contact{0, 0});
    const CutResult result = cut(stock, sprung(2 * kRadius, 2, kSpring), material, stamps, contacts, 0, options);
    EXPECT_EQ(result.unsettled, 0u);
    double delta = 0;
    for (std::size_t n = 4; n < stamps.size(); ++n) {
      delta = g * (kFeed + delta) / (1 + g);
      const std::string where = fmt::format("{}, voxel {}", n, voxel);
      deflection.expect(result.loads[n].contact_deflection_mm.z(), delta, where, g * kFeed);
      force.expect(result.loads[n].force_mean_N.z(), kSpring * delta, where, kSpring * g * kFeed);
    }
    EXPECT_NEAR(delta, g * kFeed, 1e-3 * kFeed);
    // The chips hold what the stock has lost, displaced as the cutter was.
    EXPECT_NEAR(result.chip_mm3, result.stock_mm3, 0.02 * result.stock_mm3);
  }
}

/// A straight tooth in a slot: kae alone pulls the tool down by kae ap while it is in the cut.
TEST(AxialSpring, ASlotsForceBendsByItsCompliance) {
  constexpr double kDepth = 1, kKae = 60, kSpring = 8000;
  const machine::Material material{0, 0, 0, 0, 0, kKae};
  for (const auto coupling : {machine::Coupling::rigid, machine::Coupling::static_}) {
    std::vector<removal::Stamp> stamps;
    add_row(stamps, {-6, 0.003, -kDepth}, {3, 0.003, -kDepth}, 0.1);
    removal::Stock stock = make_box({0, -6, -2}, {12, 6, 0}, 0.1);
    const std::vector<Contact> contacts(stamps.size(), Contact{0.1, 0});
    CutOptions options;
    options.coupling = coupling;
    const CutResult result = cut(stock, sprung(10, 1, kSpring), material, stamps, contacts, 0, options);
    EXPECT_EQ(result.unsettled, 0u);
    // What the tool is pulled down by it cuts deeper: delta = -c kae (ap - delta).
    const double g = coupling == machine::Coupling::static_ ? kKae / kSpring : 0;
    const double expected = -kKae * kDepth / kSpring / (1 - g);
    const auto& load = result.loads[stamps.size() - 3];
    EXPECT_NEAR(load.contact_deflection_mm.z(), expected, 0.02 * -expected);
    EXPECT_NEAR(load.force_max_N.z(), kSpring * expected, 0.02 * kSpring * -expected);
  }
}

/// Without a spring along the axis nothing of it is left, whatever the axial force.
TEST(AxialSpring, ARigidAxisStaysWhereItIs) {
  const machine::Material material{800, 300, 200, 5, 5, 5};
  auto tool = make_tool(machine::ToolType::ball, 6, 2, 30);
  tool.axial_stiffness_N_per_mm = kInf;
  std::vector<removal::Stamp> stamps;
  add_row(stamps, {-4, 0.003, -0.4}, {1, 0.003, -0.4}, 0.1);
  removal::Stock stock = make_box({0, -3, -2}, {4, 3, 0}, 0.1);
  const std::vector<Contact> contacts(stamps.size(), Contact{0.1, 0});
  const CutResult result = cut(stock, tool, material, stamps, contacts, 0, {});
  for (const StampLoad& load : result.loads) EXPECT_EQ(load.contact_deflection_mm.z(), 0);
  EXPECT_GT(std::abs(result.loads.back().force_mean_N.z()), 1);
}

}  // namespace
}  // namespace camber::simulate
