// Sharp edges of a blank, which its trilinear field rounds.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/tool_pose.h"
#include "removal/field/blank_edges.h"
#include "removal/field/tile.h"
#include "removal/stock.h"

namespace camber::removal {
namespace {

constexpr double kEdgeVoxel_mm = 0.1, kEdgeBand_mm = 0.5;

/// A tile around the origin, and its edges.
struct EdgeTile {
  Stock stock;
  std::vector<float> distance = std::vector<float>(Tile::kVolume);
  BlankEdges edges{};

  explicit EdgeTile(const std::function<double(const Vec3&)>& distance_mm)
      : stock(distance_mm, Vec3::Constant(-4), Vec3::Constant(4), kEdgeVoxel_mm, kEdgeBand_mm / kEdgeVoxel_mm) {
    stock.read({0, 0, 0}, Tile::kSide, distance.data(), nullptr);
    edges.find(distance.data(), kEdgeVoxel_mm, kEdgeBand_mm, [&](const Index3& cell, float* out) {
      stock.read({cell[0] - 1, cell[1] - 1, cell[2] - 1}, BlankEdges::kAround, out, nullptr);
    });
  }
  BlankCell at(const Vec3& p) const {
    Index3 cell;
    CellShare share;
    for (std::size_t a = 0; a < 3; ++a) {
      const double v = p[static_cast<int>(a)] / kEdgeVoxel_mm;
      cell[a] = static_cast<int>(std::floor(v));
      share[a] = static_cast<float>(v - cell[a]);
    }
    const int offset = Tile::offset(cell[0], cell[1], cell[2]);
    return {distance.data() + offset, edges.faces(offset), share, kEdgeVoxel_mm};
  }
};

/// A place anywhere in the tile.
Vec3 place_in_tile(std::mt19937& random) {
  std::uniform_real_distribution<double> within(0, Tile::kCore * kEdgeVoxel_mm * 0.9999);
  return {within(random), within(random), within(random)};
}

Mat3 any_turn(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

}  // namespace

TEST(BlankEdges, FacesOfATurnedWedgeAreThoseOfItsClosedForm) {
  std::mt19937 random(5);
  for (const double between : {0.5, 1.0, kPi / 2, 2.2}) {  // from one outward normal to the other
    for (int i = 0; i < 10; ++i) {
      const Mat3 turn = any_turn(random);
      const Vec3 middle = place_in_tile(random), a = turn.col(0),
                 b = std::cos(between) * turn.col(0) + std::sin(between) * turn.col(1);
      const EdgeTile tile([&](const Vec3& p) {  // as a cut leaves it: the larger of both
        return std::max(a.dot(p - middle), b.dot(p - middle));
      });
      double worst_mm = 0, worst_trilinear_mm = 0, worst_cosine = 1;
      std::size_t on_edge = 0;
      for (int n = 0; n < 20000; ++n) {
        const Vec3 p = place_in_tile(random);
        const double in_a = a.dot(p - middle), in_b = b.dot(p - middle), is = std::max(in_a, in_b);
        if (is > 0 || is < -kEdgeVoxel_mm) continue;
        const BlankCell cell = tile.at(p);
        worst_mm = std::max(worst_mm, std::abs(cell.distance_mm(0, a) - is));
        worst_trilinear_mm =
            std::max(worst_trilinear_mm, std::abs(static_cast<double>(trilinear(cell.lowest, cell.share)) - is));
        on_edge += !cell.faces.empty();
        for (const EdgeFace& f : cell.faces)
          worst_cosine = std::min(worst_cosine, std::max(f.outwards.dot(a), f.outwards.dot(b)));
      }
      if (on_edge < 50) continue;  // the edge passes by
      EXPECT_LT(worst_mm, 0.05 * kEdgeVoxel_mm) << between << ' ' << i;
      EXPECT_GT(worst_trilinear_mm, 0.05 * kEdgeVoxel_mm);
      EXPECT_GT(worst_cosine, 0.999) << between << ' ' << i;
    }
  }
}

TEST(BlankEdges, ThreeFacesMeetInACornerOfATurnedBox) {
  std::mt19937 random(6);
  const Mat3 turn = any_turn(random);
  const Vec3 corner = Vec3::Constant(0.83);
  const EdgeTile tile([&](const Vec3& p) { return (turn.transpose() * (p - corner)).maxCoeff(); });
  const BlankCell cell = tile.at(corner - 0.01 * turn * Vec3(1, 1.5, 2));
  ASSERT_EQ(cell.faces.size(), 3u);
  EXPECT_NEAR(cell.distance_mm(0, Vec3::UnitZ()), -0.01, 1e-4);
  // Up along one face's normal by 0.015 mm: 0.005 mm out of the material.
  EXPECT_NEAR(cell.distance_mm(0.015, turn.col(0)), 0.005, 1e-4);
}

TEST(BlankEdges, SmoothAndHollowBlanksHaveNone) {
  const Vec3 middle(0.4, 0.3, -2.1);
  const EdgeTile ball([&](const Vec3& p) { return (p - middle).norm() - 3; });
  const EdgeTile groove([&](const Vec3& p) { return std::min(p.x() - 0.77, 0.6 * p.x() + 0.8 * p.y() - 1.1); });
  for (int cell = 0; cell < Tile::kVolume; ++cell) {
    EXPECT_TRUE(ball.edges.faces(cell).empty());
    EXPECT_TRUE(groove.edges.faces(cell).empty());
  }
}

}  // namespace camber::removal
