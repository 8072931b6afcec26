#include "workpiece/elastic.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "removal/stock.h"
#include "tests/support/accuracy_figure.h"

namespace camber::workpiece {
namespace {

using removal::Stock;

constexpr double kE_MPa = 68900, kNu = 0.33;
constexpr double kPerHundredNewtons_um = 1e5;

Stock box(const Vec3& low, const Vec3& high, double voxel_mm) {
  return Stock([&](const Vec3& p) { return removal::box_distance_mm(p, low, high); }, low, high, voxel_mm, 4);
}

SolidOptions aluminium(double cell_mm) {
  SolidOptions out;
  out.cell_mm = cell_mm;
  out.youngs_modulus_MPa = kE_MPa;
  out.poisson_ratio = kNu;
  return out;
}

/// Evenly over a rectangle from `low` to `high`, flat along one axis.
NodeWeights over(const Solid& solid, const Vec3& low, const Vec3& high) {
  constexpr int kPoints = 8;
  NodeWeights out;
  for (int i = 0; i < kPoints; ++i)
    for (int j = 0; j < kPoints; ++j)
      for (int k = 0; k < kPoints; ++k) {
        const Vec3 share = (Vec3(i, j, k) + Vec3::Constant(0.5)) / kPoints;
        out.add(solid.at(low + share.cwiseProduct(high - low)), std::pow(kPoints, -3));
      }
  return out;
}

/// The wall of 2 x 30 x 60 mm, its foot held, `aside` from the grid's zero along x and y.
struct Wall {
  explicit Wall(double cell_mm, double voxel_mm = 0.2, double aside = 0.1)
      : first(aside, aside, 0),
        stock(box(first, first + Vec3(60, 2, 30), voxel_mm)),
        solid(stock, aluminium(cell_mm)),
        elastic(solid) {}

  Load load(double from_mm, double to_mm) const {
    return {over(solid, first + Vec3(from_mm, 0, 28), first + Vec3(to_mm, 0, 30)), Vec3::UnitY()};
  }
  double um(const Displacements& u, double x, double y, double z) const {
    return kPerHundredNewtons_um * displacement_mm(solid.at(first + Vec3(x, y, z)), u).y();
  }

  Vec3 first;
  Stock stock;
  Solid solid;
  Elastic elastic;
};

/// The reference: three-dimensional elasticity by 20-node hexahedra, graded, right within 0.1 %.
void expect_reference(const Wall& wall, double share) {
  const auto u = wall.elastic.solve(std::vector<Load>{wall.load(28, 32), wall.load(56, 60)}, {});
  tests::LargestFigure displacements("displacement of a wall in three dimensions", share);
  const auto near = [&](double is, double reference) {
    displacements.expect(is, reference, fmt::format("{} um", reference));
  };
  near(wall.um(u[0], 30, 2, 29), 337.44);
  near(wall.um(u[0], 30, 2, 30), 356.66);
  near(wall.um(u[0], 60, 2, 30), 211.13);
  near(wall.um(u[0], 30, 2, 15), 109.27);
  near(wall.um(u[1], 58, 2, 29), 620.44);
  near(wall.um(u[1], 60, 2, 30), 685.39);
  near(wall.um(u[1], 30, 2, 30), 218.50);
}

TEST(Elastic, OneCellThroughAWallBendsItRight) { expect_reference(Wall(2), 0.01); }
TEST(Elastic, TwoCellsThroughAWallBendItRight) { expect_reference(Wall(1), 0.01); }
TEST(Elastic, CellsThickerThanTheWallBendItRight) { expect_reference(Wall(3), 0.03); }
TEST(Elastic, WallMayStandAnywhereInTheGrid) {
  for (const double aside : {0.0, 0.37, 0.9, 1.33}) expect_reference(Wall(2, 0.2, aside), 0.02);
}

TEST(Elastic, WorkOfTheLoadIsTheEnergy) {
  const Wall wall(2);
  const Load load = wall.load(28, 32);
  const Displacements u = wall.elastic.solve(std::vector<Load>{load}, {}).front();
  const double work = displacement_mm(load.where, u).y() / 2;
  EXPECT_NEAR(wall.elastic.energy_Nmm(u), work, 1e-6 * work);
}

TEST(Elastic, WhatOneLoadMovesAtTheOtherIsTheSameTheOtherWayRound) {
  const Wall wall(2);
  const std::vector<Load> loads{wall.load(28, 32), wall.load(56, 60)};
  const auto u = wall.elastic.solve(loads, {});
  EXPECT_NEAR(displacement_mm(loads[1].where, u[0]).y(), displacement_mm(loads[0].where, u[1]).y(), 1e-8);
}

TEST(Elastic, LoadsSideBySideGiveWhatEachGivesAlone) {
  const Wall wall(3);
  std::vector<Load> loads;
  for (int i = 0; i < 10; ++i) loads.push_back(wall.load(4 * i, 4 * i + 4));
  const auto together = wall.elastic.solve(loads, {.tolerance = 1e-9});
  for (const std::size_t i : {0, 3, 9}) {
    const auto alone = wall.elastic.solve(std::span(loads).subspan(i, 1), {.tolerance = 1e-9});
    EXPECT_NEAR(displacement_mm(loads[i].where, together[i]).y(), displacement_mm(loads[i].where, alone[0]).y(), 1e-9);
  }
}

TEST(Elastic, ResultDoesNotDependOnTheNumberOfThreads) {
  const Wall wall(2);
  const std::vector<Load> loads{wall.load(28, 32)};
  const Displacements many = wall.elastic.solve(loads, {}).front();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(wall.elastic.solve(loads, {}).front(), many);
}

/// A cantilever along z of a square section: w = P L^3 / 3 E I + P L / kappa G A, kappa = 5/6 (Timoshenko).
TEST(Elastic, BeamBendsByTimoshenko) {
  constexpr double kLength = 40, kSide = 4;
  const Stock stock = box({0.1, 0.1, 0}, {kSide + 0.1, kSide + 0.1, kLength}, 0.2);
  const Solid solid(stock, aluminium(2));
  const Elastic elastic(solid);
  const Load end{over(solid, {0.1, 0.1, kLength}, {kSide + 0.1, kSide + 0.1, kLength}), Vec3::UnitX()};
  const double moved = displacement_mm(end.where, elastic.solve(std::vector<Load>{end}, {}).front()).x();
  const double inertia = std::pow(kSide, 4) / 12, shear = kE_MPa / (2 * (1 + kNu));
  const double expected = std::pow(kLength, 3) / (3 * kE_MPa * inertia) + kLength / (5.0 / 6 * shear * kSide * kSide);
  tests::expect_figure("displacement", moved, expected, 0.015);  // the foot cannot contract, either
}

/// A line load along the free edge of a wide cantilever plate bends it like a beam but for the anticlastic curvature:
/// by between (1 - nu^2) and 1 of a beam's deflection, at a wide plate's middle by the former.
TEST(Elastic, WidePlateUnderALineLoadBendsByItsPlateStiffness) {
  constexpr double kHeight = 15, kWidth = 90, kThick = 1;
  const Stock stock = box({0.1, 0.1, 0}, {kWidth + 0.1, kThick + 0.1, kHeight}, 0.2);
  const Solid solid(stock, aluminium(1));
  const Elastic elastic(solid);
  const Load edge{over(solid, {0.1, 0.1, kHeight}, {kWidth + 0.1, kThick + 0.1, kHeight}), Vec3::UnitY()};
  const Displacements u = elastic.solve(std::vector<Load>{edge}, {.tolerance = 1e-5}).front();
  const double middle = displacement_mm(solid.at({kWidth / 2, 0.6, kHeight}), u).y();
  const double stiffness = kE_MPa * std::pow(kThick, 3) / (12 * (1 - kNu * kNu));
  const double expected = std::pow(kHeight, 3) / (3 * kWidth * stiffness);
  tests::expect_figure("displacement", middle, expected, 0.02);
}

/// w D / (P c^2) of a square cantilever plate, nu = 0.33, by Kirchhoff's theory (Ritz, converged): the load at a
/// corner, and in the middle of the free edge read at its corner.
TEST(Elastic, SquareCantileverPlateBendsByKirchhoff) {
  tests::LargestFigure displacements("displacement", 0.02);
  constexpr double kSide = 40, kThick = 1;
  const Stock stock = box({0.1, 0.1, 0}, {kSide + 0.1, kThick + 0.1, kSide}, 0.2);
  const Solid solid(stock, aluminium(1));
  const Elastic elastic(solid);
  const auto at = [&](double x, double z) { return solid.at({0.1 + x, 0.6, z}); };
  const std::vector<Load> loads{{at(kSide / 2, kSide), Vec3::UnitY()}, {at(kSide, kSide), Vec3::UnitY()}};
  const auto u = elastic.solve(loads, {.tolerance = 1e-5});
  const double unit = kSide * kSide * 12 * (1 - kNu * kNu) / (kE_MPa * std::pow(kThick, 3));
  const auto expect = [&](const Displacements& of, double x, double z, double coefficient) {
    displacements.expect(displacement_mm(at(x, z), of).y(), coefficient * unit, fmt::format("{}, {}", x, z));
  };
  expect(u[0], kSide, kSide, 0.331346);
  expect(u[0], kSide / 2, kSide, 0.365270);
  expect(u[0], kSide / 2, kSide / 2, 0.112534);
  expect(u[1], kSide, kSide, 0.498325);
  expect(u[1], 0, kSide, 0.217219);
}

/// w D / (P a^2) = 0.005612 in the middle of a clamped square plate (Timoshenko & Woinowsky-Krieger).
TEST(Elastic, ClampedSquarePlateBendsByKirchhoff) {
  constexpr double kSide = 48, kThick = 1, kRim = 3;
  const double all = kSide + 2 * kRim;
  const Stock stock = box({0.1, 0.1, 0.1}, {all + 0.1, all + 0.1, kThick + 0.1}, 0.2);
  SolidOptions options = aluminium(1);
  options.bottom = false;
  options.held = [&](const Vec3& p) {
    return (p.head<2>() - Vec2::Constant(all / 2 + 0.1)).lpNorm<Eigen::Infinity>() > kSide / 2;
  };
  const Solid solid(stock, options);
  const Elastic elastic(solid);
  const Vec3 middle(all / 2 + 0.1, all / 2 + 0.1, kThick / 2 + 0.1);
  const Displacements u =
      elastic.solve(std::vector<Load>{{solid.at(middle), Vec3::UnitZ()}}, {.tolerance = 1e-5}).front();
  const double expected = 0.005612 * kSide * kSide * 12 * (1 - kNu * kNu) / (kE_MPa * std::pow(kThick, 3));
  tests::expect_figure("displacement", displacement_mm(solid.at(middle), u).z(), expected, 0.03);
}

/// Pressure on a square of a half space: the middle sinks twice as far as the corners, 4 p a (1 - nu^2) asinh(1) / (pi
/// E) with the side a (Love). The block's own compression is the same at both.
TEST(Elastic, ThickBlockUnderAPatchSinksByLove) {
  constexpr double kBlock = 20, kPatch = 4;
  const Stock stock = box({0.5, 0.5, 0.5}, Vec3::Constant(kBlock + 0.5), 1);
  const Solid solid(stock, aluminium(1));
  const Elastic elastic(solid);
  const Vec3 middle(kBlock / 2 + 0.5, kBlock / 2 + 0.5, kBlock + 0.5),
      corner = middle + Vec3(kPatch / 2, kPatch / 2, 0);
  const Load load{over(solid, middle - Vec3(kPatch / 2, kPatch / 2, 0), corner), Vec3::UnitZ()};
  const Displacements u = elastic.solve(std::vector<Load>{load}, {.tolerance = 1e-5}).front();
  const double sinks = displacement_mm(solid.at(middle), u).z() - displacement_mm(solid.at(corner), u).z();
  const double expected = 2 * (1 - kNu * kNu) * std::asinh(1) / (kPi * kE_MPa * kPatch);
  tests::expect_figure("sinking", sinks, expected, 0.03);
}

/// A stiff block on a soft fixture moves as a whole.
TEST(Elastic, FixtureMovesByItsStiffness) {
  const Stock stock = box({0.5, 0.5, 0.5}, {8.5, 8.5, 4.5}, 1);
  SolidOptions options = aluminium(2);
  options.youngs_modulus_MPa = 1e9;
  options.fixture_stiffness_N_per_mm = 5000;
  const Solid solid(stock, options);
  const Elastic elastic(solid);
  const Load down{over(solid, {0.5, 0.5, 4.5}, {8.5, 8.5, 4.5}), -Vec3::UnitZ()};
  const Displacements u = elastic.solve(std::vector<Load>{down}, {}).front();
  for (const Vec3& corner : {Vec3(0.5, 0.5, 0.5), Vec3(8.5, 8.5, 4.5)})
    EXPECT_NEAR(displacement_mm(solid.at(corner), u).z(), -1.0 / 5000, 1e-3 / 5000);
}

TEST(Elastic, WhatHangsOnNothingIsLeftOut) {
  const Stock stock(
      [](const Vec3& p) {
        return std::min(removal::box_distance_mm(p, {0.5, 0.5, 0.5}, {8.5, 8.5, 4.5}),
                        removal::box_distance_mm(p, {0.5, 0.5, 12.5}, {8.5, 8.5, 14.5}));
      },
      {0.5, 0.5, 0.5}, {8.5, 8.5, 14.5}, 1, 4);
  const Solid solid(stock, aluminium(2));
  for (const Solid::Cell& cell : solid.cells()) EXPECT_LE(cell.at[2], 2);
  EXPECT_TRUE(solid.at({4, 4, 13.5}).nodes.empty());
}

TEST(Elastic, NothingHeldIsSaid) {
  const Stock stock = box({0.5, 0.5, 0.5}, {8.5, 8.5, 4.5}, 1);
  SolidOptions options = aluminium(2);
  options.bottom = false;
  options.held = [](const Vec3& p) { return p.z() > 100; };
  EXPECT_EQ(Solid(stock, options).held_mm3(), 0);
}

/// Bending stiffness of a cantilever held by a box up to a level within a cell: of the free length.
TEST(Elastic, HeldUpToALevelWithinACell) {
  const Stock stock = box({0.1, 0.1, 0.1}, {4.1, 4.1, 40.1}, 0.2);
  SolidOptions options = aluminium(2);
  options.bottom = false;
  const auto moved = [&](double level) {
    options.held = [level](const Vec3& p) { return p.z() < level; };
    const Solid solid(stock, options);
    const Elastic elastic(solid);
    const Load end{over(solid, {0.1, 0.1, 40.1}, {4.1, 4.1, 40.1}), Vec3::UnitX()};
    return displacement_mm(end.where, elastic.solve(std::vector<Load>{end}, {}).front()).x();
  };
  const auto expected = [](double length) {
    const double shear = kE_MPa / (2 * (1 + kNu));
    return std::pow(length, 3) / (3 * kE_MPa * std::pow(4, 4) / 12) + length / (5.0 / 6 * shear * 16);
  };
  for (const double level : {8.1, 8.9, 9.5})
    EXPECT_NEAR(moved(level), expected(40.1 - level), 0.03 * expected(40.1 - level));
}

}  // namespace
}  // namespace camber::workpiece
