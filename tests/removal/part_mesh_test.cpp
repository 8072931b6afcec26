#include "removal/form_error.h"

#include <random>

#include <gtest/gtest.h>

#include "removal/stock.h"
#include "test_paths.h"

namespace camber::removal {
namespace {

/// The surface of a prism over a polygon (counterclockwise, triangulated by `tops`) from z 0 to `height`.
TriangleMesh prism(const std::vector<Eigen::Vector2f>& outline, const std::vector<std::array<std::uint32_t, 3>>& tops,
                   float height) {
  TriangleMesh out;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const float z : {0.0f, height})
    for (const auto& p : outline) out.points.emplace_back(p.x(), p.y(), z);
  for (const auto& t : tops) {
    out.triangles.push_back({t[0], t[2], t[1]});
    out.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    out.triangles.push_back({i, j, j + n});
    out.triangles.push_back({i, j + n, i + n});
  }
  return out;
}

TriangleMesh box() { return prism({{0, 0}, {4, 0}, {4, 3}, {0, 3}}, {{0, 1, 2}, {0, 2, 3}}, 2); }

/// An L: corners and edges that are concave.
TriangleMesh angle_piece() {
  return prism({{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}, 2);
}

double angle_piece_distance_mm(const Vec3& p) {
  // Exact outside both boxes; inside, what is deepest in either is a bound, and exact where it is asked below.
  return std::min(box_distance_mm(p, {0, 0, 0}, {4, 1, 2}), box_distance_mm(p, {0, 0, 0}, {1, 3, 2}));
}

std::vector<Vec3> random_points(int count, double from, double to) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(from, to);
  std::vector<Vec3> out;
  for (int i = 0; i < count; ++i) out.emplace_back(at(random), at(random), at(random));
  return out;
}

TEST(PartMesh, OfABoxHasItsClosedForm) {
  const PartMesh mesh(box());
  for (const Vec3& p : random_points(20000, -2, 6))
    ASSERT_NEAR(mesh.distance_mm(p), box_distance_mm(p, {0, 0, 0}, {4, 3, 2}), 1e-6) << p.transpose();
  EXPECT_EQ(mesh.min_mm(), Vec3(0, 0, 0));
  EXPECT_EQ(mesh.max_mm(), Vec3(4, 3, 2));
}

TEST(PartMesh, KnowsItsInsideAtConcaveEdges) {
  const PartMesh mesh(angle_piece());
  int outside = 0, inside = 0;
  for (const Vec3& p : random_points(20000, -1, 5)) {
    const double exact = angle_piece_distance_mm(p), got = mesh.distance_mm(p);
    if (exact > 0) {
      ASSERT_NEAR(got, exact, 1e-6) << p.transpose();
      ++outside;
    } else {
      ASSERT_LE(got, exact + 1e-6) << p.transpose();
      ASSERT_LT(got, 1e-6) << p.transpose();
      ++inside;
    }
  }
  EXPECT_GT(outside, 1000);
  EXPECT_GT(inside, 500);
}

TEST(PartMesh, ThatIsInsideOutHasTheSameInside) {
  TriangleMesh turned = box();
  for (auto& t : turned.triangles) std::swap(t[1], t[2]);
  const PartMesh mesh(turned);
  EXPECT_NEAR(mesh.distance_mm({2, 1.5, 1}), -1, 1e-6);
  EXPECT_NEAR(mesh.distance_mm({2, 1.5, 5}), 3, 1e-6);
}

/// OpenVDB's distances to the same mesh, on voxels.
TEST(PartMesh, AgreesWithADistanceFieldOfASamplesPart) {
  const std::string path = CAMBER_SOURCE_DIR "/samples/10-raster/part.stl";
  const PartMesh mesh(closed_mesh(read_mesh(path), path));
  const MeshDistance field(path, 0.1, 0.5);
  std::mt19937 random(3);
  int near = 0;
  for (int i = 0; i < 20000; ++i) {
    Vec3 p;
    for (int a = 0; a < 3; ++a)
      p[a] = std::uniform_real_distribution<double>(mesh.min_mm()[a] - 0.3, mesh.max_mm()[a] + 0.3)(random);
    const double on_voxels = field.distance_mm(p);
    if (std::abs(on_voxels) > 0.35) continue;
    ASSERT_NEAR(mesh.distance_mm(p), on_voxels, 0.05) << p.transpose();  // half a voxel: they round ridges off
    ++near;
  }
  EXPECT_GT(near, 1000);
}

}  // namespace
}  // namespace camber::removal
