#include "workpiece/elastic.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace camber::workpiece {
namespace {

constexpr double kNu = 0.33;

/// Of what lies below x = `level` in the cell.
Moments below(double level) {
  Moments out{};
  const auto line = [](double to, int power) {
    return (std::pow(to, power + 1) - std::pow(-1, power + 1)) / (power + 1);
  };
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int c = 0; c < 3; ++c) out[moment_index(a, b, c)] = line(level, a) * line(1, b) * line(1, c);
  return out;
}

Eigen::Matrix<double, 24, 1> nodal(const std::function<Vec3(const Vec3&)>& displacement) {
  Eigen::Matrix<double, 24, 1> out;
  for (int n = 0; n < 8; ++n) {
    const Vec3 place((n & 1) * 2 - 1, (n >> 1 & 1) * 2 - 1, (n >> 2) * 2 - 1);
    out.segment<3>(3 * n) = displacement(place);
  }
  return out;
}

TEST(Hexahedron, WholeCellHasTheMomentsOfACube) {
  const Moments whole = moments_of_whole_cell(), filled = below(1);
  for (std::size_t i = 0; i < whole.size(); ++i) EXPECT_NEAR(whole[i], filled[i], 1e-12);
}

TEST(Hexahedron, RigidBodyHasNoForces) {
  const Hexahedron cell(kNu);
  for (const double level : {1.0, 0.2, -0.7}) {
    const CellMatrix k = cell.stiffness(below(level));
    const Vec3 turn(0.3, -0.5, 0.7);
    const auto u = nodal([&](const Vec3& p) { return Vec3(Vec3(1, 2, 3) + turn.cross(p)); });
    EXPECT_LT((k * u).norm(), 1e-10) << level;
  }
}

TEST(Hexahedron, UniformStrainHasTheEnergyOfTheMaterialWhateverTheFilling) {
  const Hexahedron cell(kNu);
  // sigma : epsilon of a strain along z with the others held, and of a shear.
  const double stiff = (1 - kNu) / ((1 + kNu) * (1 - 2 * kNu)), shear = 1 / (2 * (1 + kNu));
  const auto stretch = nodal([](const Vec3& p) { return Vec3(0, 0, p.z()); });
  const auto slide = nodal([](const Vec3& p) { return Vec3(p.z(), 0, 0); });
  for (const double level : {1.0, 0.5, -0.3}) {
    const CellMatrix k = cell.stiffness(below(level));
    const double volume = 4 * (level + 1) + Hexahedron::kVoid * 4 * (1 - level);
    EXPECT_NEAR(stretch.dot(k * stretch), stiff * volume, 1e-9);
    EXPECT_NEAR(slide.dot(k * slide), shear * volume, 1e-9);
  }
}

/// Of a plate's piece of unit width bent to the curvature 1 along y about its own middle: E I / (1 - nu^2), here with
/// the sides free, so that only the ends' turn is given.
TEST(Hexahedron, PartlyFilledCellBendsLikeABeamOfItsMaterial) {
  const Hexahedron cell(0);
  for (const double level : {1.0, 0.0, -0.5}) {
    const CellMatrix k = cell.stiffness(below(level));
    const double middle = (level - 1) / 2, thick = level + 1;
    // u_y = -(x - middle) y bends about the material's middle; the inner displacements give u_x = y^2 / 2.
    const auto bend = nodal([&](const Vec3& p) { return Vec3(0, -(p.x() - middle) * p.y(), 0); });
    const double expected = 2 * 2 * std::pow(thick, 3) / 12;
    EXPECT_NEAR(bend.dot(k * bend), expected, 0.02 * expected) << level;  // the rest of it counts as kVoid
  }
}

TEST(Hexahedron, BedCarriesItsVolume) {
  const auto push = nodal([](const Vec3&) { return Vec3(0, 1, 0); });
  const Moments half = below(0);
  EXPECT_NEAR(push.dot(Hexahedron::bed(half) * push), half[0], 1e-12);
}

}  // namespace
}  // namespace camber::workpiece
