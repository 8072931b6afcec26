// Points of a target's surface against shapes that are known: which part of it they stand for must not depend on where
// the grid lies.
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "removal/engagement.h"
#include "removal/form_error.h"
#include "tests/support/cutting.h"

namespace camber::removal {
namespace {

using testing::add_row;
using testing::make_box;
using testing::make_tool;

constexpr double kFace_mm = 0.15, kEdge_mm = 0.05;  // left out along the stock's faces and along edges between two cuts

struct Piece {
  double area_mm2 = 0, mean_mm = 0;  ///< mean place across
  void add(const SurfacePoint& p, double at) { area_mm2 += p.area_mm2, mean_mm += p.area_mm2 * at; }
};

/// A step cut into a box by a flat end mill along X: a wall at y = 0, a floor at z = -1.5.
std::vector<SurfacePoint> step_points(double voxel_mm, bool to_the_edges, double turn_rad = 0) {
  const auto tool = make_tool(machine::ToolType::flat, 6, 3, 30);
  const EnvelopeGrid envelope = make_envelope(tool, 3, 0.1, kPi / 90);
  const Vec3 along(std::cos(turn_rad), std::sin(turn_rad), 0), across(-along.y(), along.x(), 0);
  std::vector<Stamp> stamps;
  for (const double y : {-4.0, -3.0})
    add_row(stamps, y * across - 9 * along - 1.5 * Vec3::UnitZ(), y * across + 9 * along - 1.5 * Vec3::UnitZ(), 0.02);
  Stock target = make_box({-4, -5, -3}, {4, 3, 0}, voxel_mm);
  const Stock solid(target);
  sweep(target, envelope.shape, stamps, {});
  CutterPlaces places;
  places.add(0, envelope.shape, stamps);
  std::vector<SurfacePoint> out;
  for (const auto& part : surface_points(target, places, to_the_edges ? &solid : nullptr))
    out.insert(out.end(), part.begin(), part.end());
  return out;
}

TEST(SurfacePoints, AWallAndAFloorAreCoveredAlikeOnEveryGrid) {
  double wall_sum = 0, floor_sum = 0;
  const std::vector<double> voxels{0.15, 0.13, 0.1, 0.087, 0.0713};
  for (const double voxel : voxels) {
    Piece wall, floor;
    for (const SurfacePoint& p : step_points(voxel, true)) {
      EXPECT_NEAR(p.normal.cwiseAbs().maxCoeff(), 1, 1e-3) << "no normal leans between wall and floor";
      if (std::abs(p.place_mm.x()) > 3) continue;
      if (p.normal.y() < -0.9) wall.add(p, p.place_mm.z());
      if (p.normal.z() > 0.9) floor.add(p, p.place_mm.y());
    }
    const double high = 1.5 - kFace_mm - kEdge_mm, wide = 5 - kFace_mm - kEdge_mm, length = 6;
    EXPECT_NEAR(wall.area_mm2 / (length * high), 1, 0.02) << voxel;
    EXPECT_NEAR(wall.mean_mm / wall.area_mm2, -(kFace_mm + high / 2), 0.01) << voxel;
    EXPECT_NEAR(floor.area_mm2 / (length * wide), 1, 0.02) << voxel;
    EXPECT_NEAR(floor.mean_mm / floor.area_mm2, -(kEdge_mm + wide / 2), 0.01) << voxel;
    wall_sum += wall.area_mm2 / (length * high);
    floor_sum += floor.area_mm2 / (length * wide);
  }
  const auto grids = static_cast<double>(voxels.size());
  EXPECT_NEAR(wall_sum / grids, 1, 0.005);
  EXPECT_NEAR(floor_sum / grids, 1, 0.005);
}

TEST(SurfacePoints, AStepAcrossTheGridIsCoveredAlikeToo) {
  for (const double voxel : {0.13, 0.1, 0.087}) {
    const double turn = 0.37;
    const Vec3 along(std::cos(turn), std::sin(turn), 0), across(-along.y(), along.x(), 0);
    Piece wall;
    for (const SurfacePoint& p : step_points(voxel, true, turn))
      if (std::abs(p.place_mm.dot(along)) < 2 && p.normal.dot(across) < -0.9) wall.add(p, p.place_mm.z());
    const double high = 1.5 - kFace_mm - kEdge_mm;
    EXPECT_NEAR(wall.area_mm2 / (4 * high), 1, 0.03) << voxel;
    EXPECT_NEAR(wall.mean_mm / wall.area_mm2, -(kFace_mm + high / 2), 0.015) << voxel;
  }
}

TEST(SurfacePoints, WithoutTheSolidStockAVoxelAlongItsFacesIsLeftOut) {
  double highest = -std::numeric_limits<double>::infinity();
  for (const SurfacePoint& p : step_points(0.1, false))
    if (p.normal.y() < -0.9) highest = std::max(highest, p.place_mm.z());
  EXPECT_LT(highest, -0.05);
}

}  // namespace
}  // namespace camber::removal
